#include "tool/export/obj_export.h"

#include <iterator>

#include <fmt/format.h>

#include "core/base/check.h"

namespace softreel {
namespace {

using Bytes = std::vector<std::uint8_t>;

void write_polygons(const SurfaceMesh& mesh, Bytes& bytes) {
  const PolygonList& polygons = mesh.polygons;
  const auto out = std::back_inserter(bytes);
  Index group = -1;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    if (!polygons.polygon_groups.empty() && polygons.polygon_groups[p] != group) {
      group = polygons.polygon_groups[p];
      fmt::format_to(out, "{}\n", group < 0 ? "g" : "g " + mesh.groups[static_cast<std::size_t>(group)].name);
    }
    bytes.push_back('f');
    for (Index c = polygons.offsets[p]; c < polygons.offsets[p + 1]; ++c) {
      const auto corner = static_cast<std::size_t>(c);
      const Index texture = polygons.corner_textures.empty() ? -1 : polygons.corner_textures[corner];
      fmt::format_to(out, " {}", polygons.corner_vertices[corner] + 1);
      if (texture >= 0) fmt::format_to(out, "/{}", texture + 1);
    }
    bytes.push_back('\n');
  }
}

}  // namespace

std::vector<std::uint8_t> encode_obj(const SurfaceMesh& mesh, const std::vector<Vec3>& positions) {
  CHECK(positions.size() == mesh.positions.size());
  Bytes bytes;
  bytes.reserve(64 * positions.size() + 16 * mesh.polygons.corner_vertices.size());
  const auto out = std::back_inserter(bytes);
  for (const Vec3& p : positions) fmt::format_to(out, "v {} {} {}\n", p.x(), p.y(), p.z());
  for (const Vec2& t : mesh.texture_coordinates) fmt::format_to(out, "vt {} {}\n", t.x(), t.y());
  write_polygons(mesh, bytes);
  return bytes;
}

}  // namespace softreel
