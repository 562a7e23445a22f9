/// Where the depths of a preview's picture begin and end.
#pragma once

#include <vector>

#include "render/preview/gizmo_marks.h"
#include "render/preview/lamp_shapes.h"
#include "render/scene/camera_frame.h"
#include "render/scene/scene.h"

namespace softreel {

/// Distances along the view that hold all that is drawn, m.
struct DepthRange {
  float near = 0, far = 0;
};

/// With a little air. A body may be close beside a ground that goes on for kilometres; what is nearer than 1e-5 of
/// `far` is left out. ground: a ground_mesh of any number of cells, or empty; lamps: corners of what is drawn of them.
DepthRange depth_range(const std::vector<MotionMesh>& meshes, const MotionMesh& ground, const GizmoMarks& marks,
                       const std::vector<LampCorner>& lamps, const CameraFrame& camera);

}  // namespace softreel
