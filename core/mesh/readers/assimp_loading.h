/// Reading a file with assimp, as meshes and as scenes are read.
#pragma once

#include <string>

namespace Assimp {
class Importer;
}
struct aiScene;

namespace softreel::detail {

/// The file as assimp has it, with nothing done to it; null where it cannot be read, and `problem` says why. importer
/// owns the scene.
const aiScene* load_scene(Assimp::Importer& importer, const std::string& path, std::string& problem);

}  // namespace softreel::detail
