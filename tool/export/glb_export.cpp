#include "tool/export/glb_export.h"

#include <bit>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/check.h"
#include "core/base/error.h"
#include "tool/export/export_colors.h"
#include "tool/export/float_values.h"
#include "tool/export/gltf_look.h"
#include "tool/export/scratch_file.h"
#include "tool/export/seam_split.h"

namespace softreel {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

using Json = nlohmann::ordered_json;

// Constants of the glTF 2.0 specification.
constexpr std::uint32_t kGlbMagic = 0x46546C67, kVersion = 2, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr int kFloat = 5126, kUnsignedInt = 5125, kVertexData = 34962, kVertexIndices = 34963;

template <typename T>
std::span<const std::uint8_t> bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}

/// The binary chunk with what the header says of it.
class Buffer {
 public:
  explicit Buffer(const std::string& folder) : bytes_(folder) {}

  /// Adds an accessor with a buffer view of its own; returns its index.
  template <typename T>
  int add(const std::vector<T>& values, const char* type, std::size_t components, int target) {
    Json view{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (target == kVertexData) view["byteStride"] = components * sizeof(T);
    if (target != 0) view["target"] = target;
    views_.push_back(std::move(view));
    accessors_.push_back({{"bufferView", views_.size() - 1},
                          {"componentType", std::is_same_v<T, float> ? kFloat : kUnsignedInt},
                          {"count", values.size() / components},
                          {"type", type}});
    bytes_.write(bytes_of(values));
    return static_cast<int>(accessors_.size()) - 1;
  }

  /// Adds a buffer view that no accessor reads; returns its index.
  int add_picture(std::vector<std::uint8_t> bytes) {
    views_.push_back({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}});
    bytes.resize((bytes.size() + 3) / 4 * 4);
    bytes_.write(bytes_of(bytes));
    return static_cast<int>(views_.size()) - 1;
  }

  /// The last accessor's smallest and largest values.
  void add_bounds(const std::vector<float>& values, std::size_t components) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    std::vector<float> low(components, kInfinity), high(components, -kInfinity);
    for (std::size_t i = 0; i < values.size(); ++i) {
      low[i % components] = std::min(low[i % components], values[i]);
      high[i % components] = std::max(high[i % components], values[i]);
    }
    accessors_.back()["min"] = low;
    accessors_.back()["max"] = high;
  }

  /// An accessor whose values are written by `write`, row by row.
  template <typename Write>
  int add_rows(std::uint64_t count, const Write& write) {
    views_.push_back({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", 4 * count}});
    accessors_.push_back(
        {{"bufferView", views_.size() - 1}, {"componentType", kFloat}, {"count", count}, {"type", "SCALAR"}});
    write(bytes_);
    return static_cast<int>(accessors_.size()) - 1;
  }

  void describe(Json& header) {
    header["accessors"] = std::move(accessors_);
    header["bufferViews"] = std::move(views_);
    header["buffers"] = Json::array({Json{{"byteLength", bytes_.size()}}});
  }
  const ScratchFile& bytes() const { return bytes_; }

 private:
  ScratchFile bytes_;
  Json accessors_ = Json::array(), views_ = Json::array();
};

/// The difference that gives `position` when it is added to `rest` in float32; the nearest if none does.
float difference(float rest, float position) {
  const float nearest = static_cast<float>(static_cast<double>(position) - static_cast<double>(rest));
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  if (rest + nearest == position) return nearest;  // most do, and neighbours take a call into libm each
  for (const float candidate : {std::nextafter(nearest, -kInfinity), std::nextafter(nearest, kInfinity)})
    if (rest + candidate == position) return candidate;
  return nearest;
}

class GlbFile : public ExportWriter {
 public:
  explicit GlbFile(ExportTarget target)
      : target_(std::move(target)),
        split_(split_at_seams(*body().mesh)),
        look_(body(), !split_.textures.empty()),
        buffer_(target_.folder) {
    require_float_times("glb", clip_times(), target_.settings.fps);
    require_texture_coordinates(fmt::format("{}.{}.glb", target_.shot, body().name), *body().mesh,
                                std::numeric_limits<float>::max());
    require_size();
    write_rest();
  }

  void append(const ExportSample& sample) override {
    CHECK(sample.positions.size() == body().mesh->positions.size());
    Json one;
    one["POSITION"] = add_target(sample, sample.positions, rest_positions_);
    buffer_.add_bounds(deltas_, 3);
    if (target_.settings.normals) one["NORMAL"] = add_target(sample, sample.normals, rest_normals_);
    targets_.push_back(std::move(one));
    target_names_.push_back(fmt::format("frame {}", sample.frame));
  }

  void finish() override {
    CHECK(static_cast<int>(targets_.size()) == target_.times.count);
    Json animation = write_animation();
    Json header{{"asset", {{"version", "2.0"}, {"generator", "softreel"}}}, {"scene", 0}};
    header["scenes"] = Json::array({Json{{"name", target_.shot}, {"nodes", Json::array({0})}}});
    header["nodes"] = Json::array({node()});
    header["meshes"] = Json::array({mesh()});
    look_.describe(picture_views_, header);
    header["animations"] = Json::array({std::move(animation)});
    buffer_.describe(header);
    write_chunks(header.dump(-1, ' ', false, Json::error_handler_t::replace));  // names of files may be of any bytes
  }

 private:
  const ExportBody& body() const { return target_.bodies[0]; }
  std::size_t vertices() const { return split_.sources.size(); }

  /// A clip begins at second 0: a player would show its first key from there to frame 1001, say, in every turn.
  SampleTimes clip_times() const { return {0, target_.times.per_frame, target_.times.count}; }

  /// What the file needs at least; the header is at most as large as what its samples may leave.
  void require_size() const {
    const double samples = target_.times.count, corners = 12.0 * static_cast<double>(split_.triangles.size());
    const double vertex_bytes = 12.0 * (target_.settings.normals ? 2 : 1) * static_cast<double>(vertices());
    double pictures = 0;
    for (const GltfLook::Picture& picture : look_.pictures()) pictures += static_cast<double>(picture.bytes.size());
    const double color_bytes = shows_vertex_colors(body()) ? 12.0 * static_cast<double>(vertices()) : 0;
    const double bytes = pictures + corners + color_bytes + 8.0 * static_cast<double>(split_.textures.size()) +
                         vertex_bytes * (samples + 1) + 4 * samples * (samples + 1) + 1024 * samples + 65536;
    if (bytes <= std::numeric_limits<std::uint32_t>::max()) return;
    throw input_error(
        fmt::format("glb: {} samples of {} vertices need {:.1f} GiB, and a GLB file ends at 4 GiB.\n"
                    "  Accepted: fewer samples. Export a range with --frames, leave out --subframes or --normals, or "
                    "export usda, pc2 or mdd.",
                    target_.times.count, vertices(), bytes / (1 << 30)));
  }

  void write_rest() {
    std::vector<std::uint32_t> indices;
    for (const Triangle& triangle : split_.triangles)
      for (const Index vertex : triangle) indices.push_back(static_cast<std::uint32_t>(vertex));
    indices_ = buffer_.add(indices, "SCALAR", 1, kVertexIndices);
    const std::vector<Vec3>& file = body().mesh->positions;
    std::vector<Vec3> rest(file.size());
    for (std::size_t v = 0; v < file.size(); ++v) rest[v] = body().file_to_space(file[v]);
    rest_positions_ = to_vertices("the mesh at rest", rest);
    attributes_["POSITION"] = buffer_.add(rest_positions_, "VEC3", 3, kVertexData);
    buffer_.add_bounds(rest_positions_, 3);
    if (target_.settings.normals) {
      rest_normals_ = to_vertices("the mesh at rest", vertex_normals(*body().mesh, rest));
      attributes_["NORMAL"] = buffer_.add(rest_normals_, "VEC3", 3, kVertexData);
    }
    if (shows_vertex_colors(body())) write_colors();
    for (const GltfLook::Picture& picture : look_.pictures())
      picture_views_.push_back(buffer_.add_picture(picture.bytes));
    if (split_.textures.empty()) return;
    std::vector<float> textures;
    for (const Vec2f& at : split_.textures) textures.insert(textures.end(), {at.x(), 1 - at.y()});
    attributes_["TEXCOORD_0"] = buffer_.add(textures, "VEC2", 2, kVertexData);
  }

  /// Linear, white with the share of glass as the base colour would be: glTF multiplies the two.
  void write_colors() {
    const std::vector<Vec3f> colors = linear_colors(*body().mesh);
    const float glass = glass_share(body().appearance);
    std::vector<float> values;
    values.reserve(3 * vertices());
    for (const Index vertex : split_.sources)
      for (const float value : colors[static_cast<std::size_t>(vertex)]) values.push_back((1 - glass) * value + glass);
    attributes_["COLOR_0"] = buffer_.add(values, "VEC3", 3, kVertexData);
  }

  /// Values of the file's vertices, with those of the duplicates behind.
  std::vector<float> to_vertices(const std::string& when, std::span<const Vec3> values) const {
    std::vector<float> floats;
    floats.reserve(3 * vertices());
    append_floats(fmt::format("{}.{}.glb, {}", target_.shot, body().name, when), values, floats);
    for (std::size_t v = values.size(); v < vertices(); ++v)
      for (std::size_t k = 0; k < 3; ++k) floats.push_back(floats[3 * static_cast<std::size_t>(split_.sources[v]) + k]);
    return floats;
  }

  int add_target(const ExportSample& sample, std::span<const Vec3> values, const std::vector<float>& rest) {
    deltas_ = to_vertices(fmt::format("frame {}", sample.frame), values);
    for (std::size_t i = 0; i < deltas_.size(); ++i) deltas_[i] = difference(rest[i], deltas_[i]);
    return buffer_.add(deltas_, "VEC3", 3, kVertexData);
  }

  Json write_animation() {
    const auto samples = static_cast<std::size_t>(target_.times.count);
    std::vector<float> times;
    for (int k = 0; k < target_.times.count; ++k) times.push_back(seconds_of(clip_times(), k, target_.settings.fps));
    const int input = buffer_.add(times, "SCALAR", 1, 0);
    buffer_.add_bounds(times, 1);
    const int output = buffer_.add_rows(samples * samples, [&](ScratchFile& bytes) {
      std::vector<float> row(samples, 0.0F);
      for (std::size_t k = 0; k < samples; ++k) {
        row[k] = 1;
        bytes.write(bytes_of(row));
        row[k] = 0;
      }
    });
    Json channel{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}};
    Json sampler{{"input", input}, {"interpolation", "LINEAR"}, {"output", output}};
    return {{"name", target_.shot},
            {"channels", Json::array({std::move(channel)})},
            {"samplers", Json::array({std::move(sampler)})},
            {"extras", {{"first_frame", target_.times.first}, {"frames_per_second", target_.settings.fps}}}};
  }

  /// An animated node may have no matrix; a placement is a turn, one scale and a translation.
  Json node() const {
    Json node{{"name", body().name}, {"mesh", 0}};
    const Placement& place = body().transform;
    const double scale = std::cbrt(place.linear.determinant());
    const Quaternion turn(Mat3(place.linear / scale));
    if (!place.offset.isZero(0)) node["translation"] = {place.offset.x(), place.offset.y(), place.offset.z()};
    if (!turn.vec().isZero(0)) node["rotation"] = {turn.x(), turn.y(), turn.z(), turn.w()};
    if (scale != 1) node["scale"] = {scale, scale, scale};
    return node;
  }

  Json mesh() {
    Json primitive{{"attributes", std::move(attributes_)},
                   {"indices", indices_},
                   {"material", 0},
                   {"targets", std::move(targets_)}};
    return {{"name", body().name},
            {"primitives", Json::array({std::move(primitive)})},
            {"extras", {{"targetNames", std::move(target_names_)}}}};
  }

  void write_chunks(std::string header) {
    header.append((4 - header.size() % 4) % 4, ' ');
    const std::uint64_t binary = buffer_.bytes().size();
    CHECK(binary % 4 == 0U);
    const std::uint64_t length = 12 + 8 + header.size() + 8 + binary;
    CHECK(length <= std::numeric_limits<std::uint32_t>::max());
    const auto size = [](std::uint64_t value) { return static_cast<std::uint32_t>(value); };
    target_.sink(bytes_of(std::vector{kGlbMagic, kVersion, size(length), size(header.size()), kJsonChunk}));
    target_.sink({reinterpret_cast<const std::uint8_t*>(header.data()), header.size()});
    target_.sink(bytes_of(std::vector{size(binary), kBinaryChunk}));
    buffer_.bytes().copy_to(target_.sink);
  }

  ExportTarget target_;
  SeamSplit split_;
  GltfLook look_;
  Buffer buffer_;
  int indices_ = 0;
  std::vector<int> picture_views_;
  std::vector<float> rest_positions_, rest_normals_;
  std::vector<float> deltas_;  ///< of one target
  Json attributes_, targets_ = Json::array(), target_names_ = Json::array();
};

}  // namespace

ExportFormat glb_format() {
  ExportFormat format;
  format.name = "glb";
  format.about = "binary glTF, a file a body: samples as morph targets with their animation; material, textures";
  format.file_per = FilePer::Body;
  format.version = 4;
  format.has_normals = true;
  format.has_seconds = true;
  format.has_transform = true;
  format.has_units = false;
  format.needs_look = true;
  format.make = [](ExportTarget target) { return std::make_unique<GlbFile>(std::move(target)); };
  return format;
}

}  // namespace softreel
