#include "tool/export/obj_export.h"

#include <iterator>
#include <set>
#include <string>

#include <fmt/compile.h>

#include "core/base/check.h"
#include "tool/export/export_colors.h"
#include "tool/export/whole_file.h"

namespace softreel {
namespace {

/// Names of the groups as one word each, and no two alike: blanks part names there, and # begins a comment.
std::vector<std::string> group_words(const std::vector<VertexGroup>& groups) {
  std::vector<std::string> words;
  std::set<std::string> taken;
  for (const VertexGroup& group : groups) {
    std::string word = group.name;
    for (char& c : word)
      if (static_cast<unsigned char>(c) <= ' ' || c == '#' || c == '\\') c = '_';
    const std::string plain = word;
    for (int n = 2; !taken.insert(word).second; ++n) word = fmt::format("{}_{}", plain, n);
    words.push_back(std::move(word));
  }
  return words;
}

void write_vertices(const SurfaceMesh& mesh, std::span<const Vec3> positions, fmt::memory_buffer& text) {
  const auto out = std::back_inserter(text);
  const std::vector<Vec3f> colors = displayed_colors(mesh);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3& p = positions[v];
    fmt::format_to(out, FMT_COMPILE("v {} {} {}"), p.x(), p.y(), p.z());
    if (!colors.empty()) fmt::format_to(out, FMT_COMPILE(" {} {} {}"), colors[v].x(), colors[v].y(), colors[v].z());
    text.push_back('\n');
  }
}

/// A corner is VERTEX, VERTEX/TEXTURE, VERTEX//NORMAL or VERTEX/TEXTURE/NORMAL.
void write_polygons(const SurfaceMesh& mesh, bool has_normals, fmt::memory_buffer& text) {
  const PolygonList& polygons = mesh.polygons;
  const auto out = std::back_inserter(text);
  const std::vector<std::string> words = group_words(mesh.groups);
  const auto name = [&](const char* statement, Index now, Index& last) {
    if (now != last)
      fmt::format_to(out, "{}{}\n", statement, now < 0 ? "" : " " + words[static_cast<std::size_t>(now)]);
    last = now;
  };
  const auto of = [](const std::vector<Index>& groups, std::size_t p) { return groups.empty() ? -1 : groups[p]; };
  Index last_group = -1, last_material = -1;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    const Index group = of(polygons.polygon_groups, p), material = of(polygons.polygon_materials, p);
    name("g", group == material ? -1 : group, last_group);
    name("usemtl", material, last_material);
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
  write_vertices(mesh, positions, text);
  for (const Vec2& t : mesh.texture_coordinates) fmt::format_to(out, FMT_COMPILE("vt {} {}\n"), t.x(), t.y());
  for (const Vec3& n : normals) fmt::format_to(out, FMT_COMPILE("vn {} {} {}\n"), n.x(), n.y(), n.z());
  write_polygons(mesh, !normals.empty(), text);
  return {text.begin(), text.end()};
}

ExportFormat obj_format() {
  ExportFormat format;
  format.name = "obj";
  format.about =
      "Wavefront OBJ, a file a frame, with polygons, texture coordinates, colours, groups and names of materials; "
      "exact";
  format.version = 6;
  format.has_normals = true;
  format.has_colors = true;
  format.make = whole_file_writer(encode_obj);
  return format;
}

}  // namespace softreel
