/// Path tracing of a Scene on Embree.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "core/base/parallel.h"
#include "core/base/timer.h"
#include "render/image/image.h"
#include "render/pathtrace/direct_light.h"
#include "render/pathtrace/picture_channels.h"
#include "render/pathtrace/rays/ray_scene.h"
#include "render/scene/pixel_window.h"
#include "render/scene/scene.h"

namespace softreel {

struct RenderParams {
  int width = 960, height = 540;
  /// What of the picture is computed, in its pixels; beyond its edges (overscan) the view goes on.
  PixelWindow window;
  int samples = 16;  ///< paths a pixel, at most 2^20; with noise or time_limit, the most
  /// Pixels stop when they are this close to their limit on a screen whose white is 1 (adaptive_sampling.h says how
  /// it is judged); 0: all get `samples`.
  float noise = 0;
  int min_samples = 16;  ///< with noise: paths that every pixel gets; a multiple of 8, at least 16
  /// s of tracing, after which no further pass over the picture begins; 0: none. Every pixel gets its share of whole
  /// passes. The one parameter whose picture depends on the machine and its load.
  double time_limit = 0;
  int max_bounces = 8;  ///< scattering events of a path
  float clamp = 0;      ///< firefly control: largest value an indirect sample may add; 0: off
  /// Surfaces seen by way of a wide scattering are at least this rough: caustics of glass and metal are blurred,
  /// where they would be fireflies. 0: off. The picture is unbiased with clamp and caustic_roughness 0.
  float caustic_roughness = 0.4f;
  DirectLight direct_light = DirectLight::Weighed;
  bool auxiliary = false;  ///< albedo, normal and depth channels too
  ChannelSet channels;     ///< more channels

  /// Whether pixels get their samples in passes, so that they may differ in number.
  bool has_passes() const { return noise > 0 || time_limit > 0; }
  /// `channels`, and those that `auxiliary` stands for; where there are passes, the number of samples.
  ChannelSet all_channels() const;
};

/// Renders frames of one sequence. Trees are built for each frame alone or fitted to it from shapes at rest, so that no
/// frame knows of earlier ones.
///
/// Bits do not depend on the thread count, on earlier frames or on the machine's vector width: samples are keyed by
/// pixel and by a hash of geometry and camera (design 4.6). Not thread-safe; one frame at a time.
class PathTracer {
 public:
  PathTracer(const Threads& threads, StageTimes& times);
  /// With trees of another kind than make_ray_scene's, for measurements.
  PathTracer(const Threads& threads, StageTimes& times, std::unique_ptr<RayScene> rays);
  ~PathTracer();

  /// Channels R, G, B; with a shadow catcher A (then colours are premultiplied); then those of params.all_channels()
  /// under the names in ChannelLayout::add_planes.
  /// `cancelled` is asked between tiles; if it says yes, an Error of kind Interrupt is thrown.
  Image render(const Scene& scene, const RenderParams& params, const std::function<bool()>& cancelled = {});

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace softreel
