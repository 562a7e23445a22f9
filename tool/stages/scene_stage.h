/// From a shot and its bodies' surfaces at one frame to the scene that is rendered or previewed.
#pragma once

#include <vector>

#include "render/scene/scene.h"
#include "tool/shot/shot.h"
#include "tool/stages/key.h"
#include "tool/stages/shot_run.h"

namespace softreel {

/// Builds scenes; loads the environment image once, and finds the framing camera from the bodies at rest.
class SceneStage {
 public:
  explicit SceneStage(const ShotRun& run);

  Scene at(int frame, const std::vector<SkinnedBody>& bodies) const;

 private:
  const ShotRun& run_;
  Environment environment_;
  Bounds rest_bounds_;
};

/// The camera of a shot at a frame. rest_bounds: of all bodies at rest, for CameraMode::Frame.
Camera camera_at(const CameraSettings& settings, double frame, const Bounds& rest_bounds, double aspect);

/// What a request for skinned surfaces must hold for the shot's motion blur.
SkinRequest skin_request(const RenderSettings& settings);

/// Key of a picture: everything its pixels depend on, and not the frame's number.
StageKey picture_key(const Scene& scene, const RenderParams& params);

}  // namespace softreel
