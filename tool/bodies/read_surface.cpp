#include "tool/bodies/read_surface.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <mutex>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/mesh/mesh_check.h"
#include "core/mesh/mesh_repair.h"
#include "core/mesh/readers/mesh_import.h"
#include "tool/cache/atomic_file.h"
#include "tool/cache/bytes.h"
#include "tool/cache/stage_names.h"

namespace softreel {
namespace fs = std::filesystem;
namespace {

/// Raised whenever the same file would give another surface, or the bytes are laid out differently.
constexpr const char* kReadVersion = "read surface 4";

constexpr std::uintmax_t kLeastBytes = 1 << 20;

struct Message {
  bool is_warning = false;
  std::string line;
};

/// Passes messages on and keeps them.
class Listener {
 public:
  explicit Listener(const Log& to)
      : log_{[this, &to](const std::string& line) {
               keep(false, line);
               to.info(line);
             },
             [this, &to](const std::string& line) {
               keep(true, line);
               to.warn(line);
             }} {}
  const Log& log() const { return log_; }
  const std::vector<Message>& messages() const { return messages_; }

 private:
  void keep(bool is_warning, const std::string& line) {
    const std::lock_guard lock(mutex_);
    messages_.push_back({is_warning, line});
  }

  std::mutex mutex_;
  std::vector<Message> messages_;
  Log log_;
};

ReadSurface read_anew(const std::string& path, const Log& log) {
  ReadSurface surface;
  surface.mesh = import_mesh(path, log);
  surface.facts = describe(check_mesh(surface.mesh));
  for (std::string& line : repair_mesh(surface.mesh)) surface.facts.push_back(std::move(line));
  if (surface.mesh.triangles.empty())
    throw input_error(
        fmt::format("{}: no usable triangle is left.\n  Accepted: a surface that encloses a volume.", path));
  surface.key = mesh_file_key(surface.mesh);
  return surface;
}

bool is_worth_keeping(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  constexpr std::array kWhole{".obj", ".off", ".ply", ".stl"};
  std::error_code none;
  return std::find(kWhole.begin(), kWhole.end(), ending) != kWhole.end() && fs::is_regular_file(path, none) &&
         fs::file_size(path, none) >= kLeastBytes;
}

/// Messages name the path, and readers are chosen by its ending.
StageKey stored_key(const std::string& path) {
  return KeyHasher(kReadVersion).add(path).add(hash_bytes(read_file(path))).key();
}

void put(ByteWriter& out, const std::string& text) {
  out.put_array(std::vector<char>(text.begin(), text.end()));
}

std::string get_text(ByteReader& in) {
  const std::vector<char> text = in.get_array<char>();
  return {text.begin(), text.end()};
}

Bytes pack(const ReadSurface& surface, const std::vector<Message>& messages) {
  ByteWriter out;
  out.put(static_cast<std::uint64_t>(messages.size()));
  for (const Message& message : messages) {
    out.put(static_cast<std::uint8_t>(message.is_warning));
    put(out, message.line);
  }
  out.put(static_cast<std::uint64_t>(surface.facts.size()));
  for (const std::string& fact : surface.facts) put(out, fact);
  put(out, surface.key);
  const SurfaceMesh& mesh = surface.mesh;
  out.put_array(mesh.positions);
  out.put_array(mesh.texture_coordinates);
  out.put_array(mesh.colors);
  out.put_array(mesh.polygons.offsets);
  out.put_array(mesh.polygons.corner_vertices);
  out.put_array(mesh.polygons.corner_textures);
  out.put_array(mesh.polygons.polygon_groups);
  out.put_array(mesh.polygons.polygon_materials);
  out.put(static_cast<std::uint64_t>(mesh.groups.size()));
  for (const VertexGroup& group : mesh.groups) {
    put(out, group.name);
    out.put_array(group.vertices);
  }
  out.put_array(mesh.joined);
  out.put_array(mesh.triangles);
  out.put_array(mesh.triangle_polygon);
  out.put_array(mesh.triangle_textures);
  return out.take();
}

SurfaceMesh unpack_mesh(ByteReader& in) {
  SurfaceMesh mesh;
  mesh.positions = in.get_array<Vec3>();
  mesh.texture_coordinates = in.get_array<Vec2>();
  mesh.colors = in.get_array<Vec3f>();
  mesh.polygons.offsets = in.get_array<Index>();
  mesh.polygons.corner_vertices = in.get_array<Index>();
  mesh.polygons.corner_textures = in.get_array<Index>();
  mesh.polygons.polygon_groups = in.get_array<Index>();
  mesh.polygons.polygon_materials = in.get_array<Index>();
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    std::string name = get_text(in);
    mesh.groups.push_back({std::move(name), in.get_array<Index>()});
  }
  mesh.joined = in.get_array<Index>();
  mesh.triangles = in.get_array<Triangle>();
  mesh.triangle_polygon = in.get_array<Index>();
  mesh.triangle_textures = in.get_array<Triangle>();
  return mesh;
}

/// Says what reading said.
ReadSurface unpack(std::span<const std::uint8_t> bytes, const Log& log) {
  ByteReader in(bytes);
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    const bool is_warning = in.get<std::uint8_t>() != 0;
    const std::string line = get_text(in);
    is_warning ? log.warn(line) : log.info(line);
  }
  ReadSurface surface;
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) surface.facts.push_back(get_text(in));
  surface.key = get_text(in);
  surface.mesh = unpack_mesh(in);
  return surface;
}

}  // namespace

StageKey mesh_file_key(const SurfaceMesh& mesh) {
  KeyHasher key("mesh 1");
  key.add(mesh.positions).add(mesh.triangles);
  for (const Vec2& at : mesh.texture_coordinates) key.add(at.x()).add(at.y());
  const PolygonList& polygons = mesh.polygons;
  key.add(polygons.offsets).add(polygons.corner_vertices).add(polygons.corner_textures).add(polygons.polygon_groups);
  for (const VertexGroup& group : mesh.groups) key.add(group.name).add(group.vertices);
  if (!polygons.polygon_materials.empty()) key.add("materials").add(polygons.polygon_materials);
  return key.key();
}

ReadSurface read_surface(const std::string& path, SurfaceUse use, const RunContext& context) {
  if (!is_worth_keeping(path)) return read_anew(path, context.log);
  const StageKey key = stored_key(path);
  if (use == SurfaceUse::LookUp) {
    const auto stored = context.cache.load(kSurfaceStage, key);
    ReadSurface surface = stored ? unpack(stored->bytes, context.log) : read_anew(path, context.log);
    surface.stored = key;
    return surface;
  }
  ReadSurface surface;
  const auto read = [&] {
    Listener listener(context.log);
    surface = read_anew(path, listener.log());
    if (stored_key(path) != key)  // or the new file would be taken for the old one for ever
      throw work_error(fmt::format("{}: changed while it was being read.\n  Run again.", path));
    return pack(surface, listener.messages());
  };
  const Cache::Produced produced = context.cache.produce(
      kSurfaceStage, key, [&] { context.stop_if_cancelled(); }, read);
  if (produced.from_cache) surface = unpack(produced.bytes, context.log);
  surface.stored = key;
  return surface;
}

}  // namespace softreel
