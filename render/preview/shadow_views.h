/// Where the lights of a scene see its bodies from, for shadow maps.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "render/scene/scene.h"

namespace softreel {

/// The bodies as one light sees them. The map holds the ball around all bodies: what is outside it has no shadow.
struct ShadowView {
  Eigen::Matrix4f clip_from_world;
  bool is_sun = false;
  int light = 0;    ///< index in scene.suns or scene.area_lights
  float texel = 0;  ///< m, edge of a pixel of the map where the bodies are
};

/// One for each light of preview_lights that can cast a shadow, suns first, then lamps, each in the order of the shot;
/// `most` of them. Lamps within the ball around the bodies cast none. size: pixels of a map's edge.
std::vector<ShadowView> shadow_views(const Scene& scene, int most, int size);

}  // namespace softreel
