#include "core/mesh/readers/mesh_source.h"

#include <fmt/format.h>

namespace softreel::detail {

Error unusable_file(const std::string& path, const std::string& problem, const std::string& advice) {
  return input_error(
      fmt::format("{}: {}.\n  Accepted: a mesh file (.obj, .ply, .off, .stl, .gltf, .glb, .fbx, .dae, ...). {}.", path,
                  problem, advice));
}

Error broken_file(const MeshSource& source, const std::string& place, const std::string& problem,
                  const std::string& accepted, const std::string& advice) {
  return input_error(fmt::format("{}{}: {}.\n  Accepted: {}. {}.", source.name, place, problem, accepted, advice));
}

Error bad_index(const MeshSource& source, const std::string& place, const std::string& what, const std::string& value,
                std::size_t count) {
  return broken_file(source, place, fmt::format("a face refers to {} {}, which the file does not have", what, value),
                     fmt::format("one of the file's {}", count), "Export the mesh again; the file may be cut off");
}

std::string at_line(std::int64_t line) {
  return fmt::format(":{}", line);
}

bool close_polygon(PolygonList& polygons) {
  const auto begin = static_cast<std::size_t>(polygons.offsets.back());
  if (polygons.corner_vertices.size() - begin < 3) {
    polygons.corner_vertices.resize(begin);
    if (polygons.corner_textures.size() > begin) polygons.corner_textures.resize(begin);
    return false;
  }
  polygons.offsets.push_back(static_cast<Index>(polygons.corner_vertices.size()));
  return true;
}

void SkippedFaces::add(const std::string& place) {
  if (count++ == 0) first_place = place;
}

void SkippedFaces::report(const MeshSource& source, const Log& log) const {
  if (count == 0) return;
  log.warn(fmt::format("{}: {} face(s) of fewer than 3 corners left out, the first at {}{}", source.name, count,
                       source.name, first_place));
}

}  // namespace softreel::detail
