#include "core/mesh/readers/scene_import.h"

#include <fmt/format.h>

#include "core/base/part.h"
#include "core/mesh/readers/assimp_scene_reader.h"
#include "core/mesh/readers/mesh_source.h"

namespace softreel {
namespace {

#if SOFTREEL_WITH_ASSIMP

SceneAnimation read_scene_with_assimp(const std::string& path, const Log&) {
  static const auto read =
      part_function<&detail::softreel_read_scene_with_assimp>("assimp", "softreel_read_scene_with_assimp");
  return read(path);
}

#else

SceneAnimation read_scene_with_assimp(const std::string& path, const Log&) {
  throw input_error(fmt::format(
      "{}: animated scenes need assimp, which was not built in.\n  Accepted without it: point caches, .pc2 and .mdd. "
      "Configure with SOFTREEL_WITH_ASSIMP=ON, or export the motion as a point cache.",
      path));
}

#endif

/// glTF says the kind of a curve as a word of its JSON, which .glb holds as text, too.
void warn_of_curves(const std::string& path, const Log& log) {
  const std::string extension = detail::lower_extension(path);
  if (extension != ".gltf" && extension != ".glb") return;
  const std::string bytes = detail::read_mesh_file(path);
  for (const char* kind : {"\"STEP\"", "\"CUBICSPLINE\""})
    if (bytes.find(kind) != std::string::npos)
      log.warn(fmt::format("{}: curves of the kind {} are taken as straight lines between their keys", path, kind));
}

}  // namespace

SceneAnimation import_scene(const std::string& path, const Log& log) {
  detail::require_mesh_file(path);
  SceneAnimation scene = read_scene_with_assimp(path, log);
  warn_of_curves(path, log);
  return scene;
}

}  // namespace softreel
