#include "render/pathtrace/rays/ray_scene.h"

#include "core/base/error.h"
#include "core/base/part.h"

namespace softreel {

#if SOFTREEL_WITH_EMBREE

std::unique_ptr<RayScene> make_ray_scene(int threads) {
  static const auto make = part_function<&softreel_make_embree_scene>("embree", "softreel_make_embree_scene");
  return make(threads);
}

#else

std::unique_ptr<RayScene> make_ray_scene(int /*threads*/) {
  throw input_error(
      "This build of softreel has no path tracer: it was configured with SOFTREEL_WITH_EMBREE=OFF or without Embree "
      "3.\n"
      "  Accepted: a build with SOFTREEL_WITH_EMBREE=ON. Install libembree-dev and configure again, or use the "
      "preview.");
}

#endif

}  // namespace softreel
