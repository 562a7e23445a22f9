#include "core/mesh/readers/mesh_import.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

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

namespace fs = std::filesystem;

void require_regular_file(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!fs::exists(status)) throw detail::unusable_file(path, "there is no such mesh file", "Check the path");
  if (fs::is_directory(status))
    throw detail::unusable_file(path, "this is a folder, not a mesh file", "Name a file in it");
  if (!fs::is_regular_file(status))
    throw detail::unusable_file(path, "this is not a regular file", "Save the mesh to a file");
  if (fs::file_size(path, ignored) == 0)
    throw detail::unusable_file(path, "the mesh file is empty", "Export the mesh again");
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes;
  std::error_code ignored;
  bytes.resize(fs::file_size(path, ignored));
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file) throw detail::unusable_file(path, "the mesh file cannot be read", "Check its permissions");
  return bytes;
}

std::string lower_extension(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

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
  require_regular_file(path);
  const Reader reader = own_reader(lower_extension(path));
  SurfaceMesh mesh;
  if (reader != nullptr) {
    const std::string bytes = read_bytes(path);
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
