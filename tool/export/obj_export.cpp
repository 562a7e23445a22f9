#include "tool/export/obj_export.h"

#include <iterator>
#include <string>

#include <fmt/compile.h>

#include "core/base/check.h"
#include "tool/export/whole_file.h"

namespace softreel {
namespace {

/// A corner is VERTEX, VERTEX/TEXTURE, VERTEX//NORMAL or VERTEX/TEXTURE/NORMAL.
void write_polygons(const SurfaceMesh& mesh, bool has_normals, fmt::memory_buffer& text) {
  const PolygonList& polygons = mesh.polygons;
  const auto out = std::back_inserter(text);
  Index group = -1;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    if (!polygons.polygon_groups.empty() && polygons.polygon_groups[p] != group) {
      group = polygons.polygon_groups[p];
      fmt::format_to(out, "{}\n", group < 0 ? "g" : "g " + mesh.groups[static_cast<std::size_t>(group)].name);
    }
    text.push_back('f');
    for (Index c = polygons.offsets[p]; c < polygons.offsets[p + 1]; ++c) {
      const auto corner = static_cast<std::size_t>(c);
      const Index texture = polygons.corner_textures.empty() ? -1 : polygons.corner_textures[corner];
      const Index vertex = polygons.corner_vertices[corner] + 1;
      fmt::format_to(out, FMT_COMPILE(" {}"), vertex);
      if (texture >= 0) fmt::format_to(out, FMT_COMPILE("/{}"), texture + 1);
      if (has_normals) fmt::format_to(out, FMT_COMPILE("{}/{}"), texture >= 0 ? "" : "/", vertex);
    }
    text.push_back('\n');
  }
}

}  // namespace

std::vector<std::uint8_t> encode_obj(const SurfaceMesh& mesh, std::span<const Vec3> positions,
                                     std::span<const Vec3> normals) {
  CHECK(positions.size() == mesh.positions.size());
  CHECK((normals.empty() || normals.size() == positions.size()));
  fmt::memory_buffer text;
  text.reserve(64 * (positions.size() + normals.size()) + 16 * mesh.polygons.corner_vertices.size());
  const auto out = std::back_inserter(text);
  for (const Vec3& p : positions) fmt::format_to(out, FMT_COMPILE("v {} {} {}\n"), p.x(), p.y(), p.z());
  for (const Vec2& t : mesh.texture_coordinates) fmt::format_to(out, FMT_COMPILE("vt {} {}\n"), t.x(), t.y());
  for (const Vec3& n : normals) fmt::format_to(out, FMT_COMPILE("vn {} {} {}\n"), n.x(), n.y(), n.z());
  write_polygons(mesh, !normals.empty(), text);
  return {text.begin(), text.end()};
}

ExportFormat obj_format() {
  ExportFormat format;
  format.name = "obj";
  format.about = "Wavefront OBJ, a file a frame, with polygons, texture coordinates and groups; exact";
  format.version = 3;
  format.has_normals = true;
  format.make = whole_file_writer(encode_obj);
  return format;
}

}  // namespace softreel
