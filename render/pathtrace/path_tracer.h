/// Path tracing of a Scene on Embree.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "core/base/parallel.h"
#include "core/base/timer.h"
#include "render/image/image.h"
#include "render/pathtrace/direct_light.h"
#include "render/scene/scene.h"

namespace softreel {

struct RenderParams {
  int width = 960, height = 540;
  int samples = 16;     ///< paths a pixel, at most 2^20
  int max_bounces = 8;  ///< scattering events of a path
  float clamp = 0;      ///< firefly control: largest value an indirect sample may add; 0: off
  /// Surfaces seen by way of a wide scattering are at least this rough: caustics of glass and metal are blurred, where
  /// they would be fireflies. 0: off. The picture is unbiased with clamp and caustic_roughness 0.
  float caustic_roughness = 0.4f;
  DirectLight direct_light = DirectLight::Weighed;
  bool auxiliary = false;  ///< albedo, normal and depth channels too
};

/// Renders frames of one sequence. The trees are built for each frame alone, so that no frame knows of earlier ones.
///
/// Bits do not depend on the thread count, on earlier frames or on the machine's vector width: samples are keyed by
/// pixel and by a hash of geometry and camera (design 4.6). Not thread-safe; one frame at a time.
class PathTracer {
 public:
  PathTracer(const Threads& threads, StageTimes& times);
  ~PathTracer();

  /// Channels R, G, B and, if asked, albedo.R/G/B, normal.X/Y/Z, depth.Z (m along the ray; 0 where nothing was hit).
  /// `cancelled` is asked between tiles; if it says yes, an Error of kind Interrupt is thrown.
  Image render(const Scene& scene, const RenderParams& params, const std::function<bool()>& cancelled = {});

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace softreel
