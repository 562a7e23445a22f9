/// The lamps that a camera sees, as triangles.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "render/preview/gizmo_marks.h"
#include "render/preview/picture_regions.h"
#include "render/scene/scene.h"

namespace softreel {

/// A corner of one of three to a triangle, which is seen from the side that it turns round counterclockwise: that to
/// which the lamp shines.
struct LampCorner {
  Vec3f position;
  Vec3f radiance;
};

/// Of the lamps that are visible, in their order.
std::vector<LampCorner> visible_lamps(const std::vector<AreaLight>& lamps);

/// To be added to what is behind, as lamps hide nothing (AreaLight); their colours are radiances.
std::vector<OverlayVertex> lamp_triangles(const std::vector<LampCorner>& lamps, const Eigen::Matrix4f& clip_from_world);

/// Where the triangles are seen: those beside the picture do not count, nor what is behind the camera.
void add_seen(SeenRegion& region, const std::vector<OverlayVertex>& triangles);

}  // namespace softreel
