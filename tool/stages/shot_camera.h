/// The camera of a shot, from its settings.
#pragma once

#include <optional>
#include <vector>

#include "core/mesh/surface_mesh.h"
#include "render/scene/scene.h"
#include "tool/shot/shot.h"

namespace softreel {

/// The camera of a shot at a frame. rest_bounds: of all bodies at rest, for CameraMode::Frame. Throws input_error where
/// keys take it to its target.
Camera camera_at(const CameraSettings& settings, double frame, const Bounds& rest_bounds, double aspect);

/// The last frame in (after, until] at which the camera jumps, as keys of ease "constant" do; none: it moves or stands.
std::optional<double> last_cut(const CameraSettings& settings, double after, double until);

/// The cameras at the times of the shutter that ends at a frame, as Scene::camera_motion: empty if all are alike. Times
/// before a cut count as the cut's.
std::vector<Camera> camera_motion_at(const CameraSettings& settings, const RenderSettings& render, double frame,
                                     const Bounds& rest_bounds, double aspect);

/// The camera of the frame after this one, for motion vectors. It stays where a cut lies between them, as what the next
/// shot shows has not moved there, and where it would stand in its target.
Camera next_camera_at(const CameraSettings& settings, double frame, const Bounds& rest_bounds, double aspect);

/// The same after the last frame, where bodies go on as they came from the frame before: so does the camera, whatever
/// its keys say. It stays after a cut, and where it would go on into its target.
Camera camera_led_on(const CameraSettings& settings, double frame, const Bounds& rest_bounds, double aspect);

}  // namespace softreel
