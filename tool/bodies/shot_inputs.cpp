#include "tool/bodies/shot_inputs.h"

#include "tool/bodies/weight_maps.h"

namespace softreel {

std::vector<std::string> files_read(const Shot& shot) {
  std::vector<std::string> files{shot.path, shot.environment_image};
  Shot named = shot;
  for (BodySettings& body : named.bodies) {
    files.insert(files.end(), {body.mesh, body.tetrahedra});
    for (const std::string* path : constraint_files(body, named.glues)) files.push_back(*path);
  }
  for (auto& [name, material] : named.materials)
    for (const std::string* path : material.textures.paths()) files.push_back(*path);
  std::erase(files, "");
  return files;
}

}  // namespace softreel
