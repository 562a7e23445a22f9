#include "core/mesh/readers/mesh_import.h"

#include <fmt/format.h>

#include "core/base/part.h"
#include "core/mesh/polygon_triangulation.h"
#include "core/mesh/readers/assimp_reader.h"
#include "core/mesh/readers/mesh_source.h"
#include "core/mesh/readers/obj_reader.h"
#include "core/mesh/readers/off_reader.h"
#include "core/mesh/readers/ply_reader.h"
#include "core/mesh/readers/stl_reader.h"

namespace softreel {
namespace {

using Reader = SurfaceMesh (*)(const detail::MeshSource&, const Log&);

/// The own reader for an extension, or null.
Reader own_reader(const std::string& extension) {
  if (extension == ".obj") return detail::read_obj;
  if (extension == ".ply") return detail::read_ply;
  if (extension == ".off" || extension == ".coff" || extension == ".noff") return detail::read_off;
  if (extension == ".stl") return detail::read_stl;
  return nullptr;
}

#if SOFTREEL_WITH_ASSIMP

SurfaceMesh read_with_assimp(const std::string& path, const Log& log) {
  static const auto read = part_function<&detail::softreel_read_with_assimp>("assimp", "softreel_read_with_assimp");
  return read(path, log);
}

#else

SurfaceMesh read_with_assimp(const std::string& path, const Log&) {
  throw input_error(
      fmt::format("{}: this format needs assimp, which was not built in.\n  Accepted without it: .obj, .ply, .off, "
                  ".stl. Configure with SOFTREEL_WITH_ASSIMP=ON, or convert the mesh.",
                  path));
}

#endif

}  // namespace

SurfaceMesh import_mesh(const std::string& path, const Log& log) {
  detail::require_mesh_file(path);
  const Reader reader = own_reader(detail::lower_extension(path));
  SurfaceMesh mesh;
  if (reader != nullptr) {
    const std::string bytes = detail::read_mesh_file(path);
    mesh = reader({path, bytes}, log);
  } else {
    mesh = read_with_assimp(path, log);
  }
  if (mesh.polygons.corner_vertices.size() > INT32_MAX || mesh.positions.size() > INT32_MAX)
    throw detail::unusable_file(path, "the mesh has more than 2^31 face corners", "Reduce it");
  if (mesh.positions.empty())
    throw detail::unusable_file(path,
                                "no vertex and no face is in it, so its format may not be the one that its name says",
                                "Check the file, or export the mesh again");
  if (mesh.polygons.size() == 0)
    throw detail::unusable_file(path, fmt::format("the mesh has {} vertices but no face", mesh.positions.size()),
                                "Export it with its faces; points and lines alone cannot be filled");
  const std::int64_t dropped = triangulate_polygons(mesh);
  if (dropped > 0)
    log.warn(fmt::format("{}: {} of {} faces left out: they use vertices that are not finite numbers", path, dropped,
                         mesh.polygons.size()));
  if (mesh.triangles.empty())
    throw detail::unusable_file(path, "every face of the mesh uses vertices that are not finite numbers",
                                "Export it again");
  return mesh;
}

}  // namespace softreel
