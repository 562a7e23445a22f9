#include "tool/export/ply_export.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/mesh/readers/ply_header.h"
#include "tool/export/export_colors.h"
#include "tool/export/whole_file.h"

namespace softreel {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

class PlyEncoder {
 public:
  PlyEncoder(const SurfaceMesh& mesh, std::span<const Vec3> positions, std::span<const Vec3> normals)
      : mesh_(mesh),
        positions_(positions),
        normals_(normals),
        colors_(displayed_colors(mesh)),
        has_byte_colors_(are_bytes(colors_)),
        vertex_textures_(find_vertex_textures()) {
    has_face_textures_ = !mesh.polygons.corner_textures.empty() && !vertex_textures_;
    const std::vector<Index>& offsets = mesh.polygons.offsets;
    for (std::size_t p = 0; p + 1 < offsets.size(); ++p)
      most_corners_ = std::max(most_corners_, offsets[p + 1] - offsets[p]);
  }

  std::vector<std::uint8_t> encode() {
    write_header();
    write_vertices();
    for (std::size_t p = 0; p < mesh_.polygons.size(); ++p) write_face(p);
    const auto size = static_cast<std::size_t>(at_ - bytes_.data());
    CHECK(size <= bytes_.size());
    bytes_.resize(size);
    return std::move(bytes_);
  }

 private:
  /// The texture coordinate of each vertex, if no vertex has two and every used one has one.
  std::optional<std::vector<Vec2>> find_vertex_textures() const {
    const std::vector<Index>& textures = mesh_.polygons.corner_textures;
    if (textures.empty()) return std::nullopt;
    std::vector<Vec2> of_vertex(positions_.size(), Vec2::Zero());
    std::vector<char> known(positions_.size(), 0);
    for (std::size_t c = 0; c < textures.size(); ++c) {
      if (textures[c] < 0) return std::nullopt;
      const auto v = static_cast<std::size_t>(mesh_.polygons.corner_vertices[c]);
      const Vec2& uv = mesh_.texture_coordinates[static_cast<std::size_t>(textures[c])];
      if (known[v] != 0 && of_vertex[v] != uv) return std::nullopt;
      of_vertex[v] = uv;
      known[v] = 1;
    }
    return of_vertex;
  }

  const char* count_type(Index most) const { return most < 256 ? "uchar" : "uint"; }

  void write_header() {
    std::string header = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment vertices in the order of the mesh file\n"
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n",
        positions_.size());
    if (!normals_.empty()) header += "property double nx\nproperty double ny\nproperty double nz\n";
    if (vertex_textures_) header += "property double s\nproperty double t\n";
    if (!colors_.empty())
      header += fmt::format("property {0} red\nproperty {0} green\nproperty {0} blue\n",
                            has_byte_colors_ ? "uchar" : "float");
    for (const VertexGroup& group : mesh_.groups)
      header += fmt::format("property uchar {}{}\n", detail::kPlyGroupPrefix, detail::encode_ply_name(group.name));
    header += fmt::format("element face {}\nproperty list {} int vertex_indices\n", mesh_.polygons.size(),
                          count_type(most_corners_));
    if (has_face_textures_) header += fmt::format("property list {} double texcoord\n", count_type(2 * most_corners_));
    header += "end_header\n";
    bytes_.assign(header.begin(), header.end());
    bytes_.resize(header.size() + vertex_bytes() + face_bytes());
    at_ = bytes_.data() + header.size();
  }

  std::size_t vertex_bytes() const {
    const std::size_t doubles = 3 + (normals_.empty() ? 0 : 3) + (vertex_textures_ ? 2 : 0);
    const std::size_t channel = has_byte_colors_ ? 1 : sizeof(float), colors = colors_.empty() ? 0 : 3 * channel;
    return positions_.size() * (doubles * sizeof(double) + colors + mesh_.groups.size());
  }

  /// At most: a face without all of its texture coordinates has none.
  std::size_t face_bytes() const {
    const std::size_t counts = mesh_.polygons.size() * sizeof(std::uint32_t) * (has_face_textures_ ? 2 : 1);
    const std::size_t corner = sizeof(Index) + (has_face_textures_ ? 2 * sizeof(double) : 0);
    return counts + mesh_.polygons.corner_vertices.size() * corner;
  }

  void write_vertices() {
    std::vector<std::vector<std::uint8_t>> members;
    for (const VertexGroup& group : mesh_.groups) {
      members.emplace_back(positions_.size(), std::uint8_t{0});
      for (const Index v : group.vertices) members.back()[static_cast<std::size_t>(v)] = 1;
    }
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      for (int k = 0; k < 3; ++k) put(positions_[v][k]);
      for (int k = 0; k < 3 && !normals_.empty(); ++k) put(normals_[v][k]);
      if (vertex_textures_)
        for (int k = 0; k < 2; ++k) put((*vertex_textures_)[v][k]);
      if (!colors_.empty()) put_color(colors_[v]);
      for (const std::vector<std::uint8_t>& member : members) put(member[v]);
    }
  }

  void write_face(std::size_t p) {
    const PolygonList& polygons = mesh_.polygons;
    const auto begin = static_cast<std::size_t>(polygons.offsets[p]);
    const auto end = static_cast<std::size_t>(polygons.offsets[p + 1]);
    put_count(static_cast<Index>(end - begin), most_corners_);
    for (std::size_t c = begin; c < end; ++c) put(polygons.corner_vertices[c]);
    if (!has_face_textures_) return;
    const auto first = polygons.corner_textures.begin();
    const bool complete = std::all_of(first + polygons.offsets[p], first + polygons.offsets[p + 1],
                                      [](Index texture) { return texture >= 0; });
    put_count(complete ? static_cast<Index>(2 * (end - begin)) : 0, 2 * most_corners_);
    for (std::size_t c = begin; complete && c < end; ++c)
      for (int k = 0; k < 2; ++k)
        put(mesh_.texture_coordinates[static_cast<std::size_t>(polygons.corner_textures[c])][k]);
  }

  void put_color(const Vec3f& color) {
    for (const float value : color)
      if (has_byte_colors_)
        put(static_cast<std::uint8_t>(std::lround(255 * value)));
      else
        put(value);
  }

  void put_count(Index count, Index most) {
    if (most < 256)
      put(static_cast<std::uint8_t>(count));
    else
      put(static_cast<std::uint32_t>(count));
  }

  template <typename T>
  void put(T value) {
    std::memcpy(at_, &value, sizeof(T));
    at_ += sizeof(T);
  }

  const SurfaceMesh& mesh_;
  std::span<const Vec3> positions_, normals_;
  std::vector<Vec3f> colors_;  ///< as a screen shows them; empty if the mesh has none
  bool has_byte_colors_ = false;
  std::optional<std::vector<Vec2>> vertex_textures_;
  bool has_face_textures_ = false;
  Index most_corners_ = 0;
  std::vector<std::uint8_t> bytes_;
  std::uint8_t* at_ = nullptr;  ///< where the next value goes
};

}  // namespace

std::vector<std::uint8_t> encode_ply(const SurfaceMesh& mesh, std::span<const Vec3> positions,
                                     std::span<const Vec3> normals) {
  CHECK(positions.size() == mesh.positions.size());
  CHECK((normals.empty() || normals.size() == positions.size()));
  return PlyEncoder(mesh, positions, normals).encode();
}

ExportFormat ply_format() {
  ExportFormat format;
  format.name = "ply";
  format.about = "binary PLY, a file a frame, with polygons, texture coordinates, colours and groups; exact";
  format.version = 5;
  format.has_normals = true;
  format.has_colors = true;
  format.make = whole_file_writer(encode_ply);
  return format;
}

}  // namespace softreel
