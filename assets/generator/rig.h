/// An animated rig without meshes: nodes that pins of a shot follow.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/types.h"

namespace softreel::sculpt {

/// A node that turns about its place and moves away from it.
struct RigNode {
  std::string name;
  Vec3 place = Vec3::Zero();               ///< m, at rest
  std::function<Quaternion(double)> turn;  ///< at a frame
  std::function<Vec3(double)> move;        ///< m, at a frame
};

struct Rig {
  std::string name;  ///< of the file, without ending
  std::string clip;
  double fps = 24;
  int frames = 0;  ///< of the clip, from frame 0 on; a key a frame
  std::vector<RigNode> nodes;
};

/// The dragon as a hand puppet: "head" nods and looks round, "right_arm" waves from the shoulder.
Rig make_puppet();

/// Binary glTF.
std::vector<std::uint8_t> encode_glb(const Rig& rig);

}  // namespace softreel::sculpt
