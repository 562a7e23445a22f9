#include "render/preview/preview.h"

#include "core/base/error.h"
#include "core/base/part.h"

namespace softreel {

#if SOFTREEL_WITH_EGL

std::unique_ptr<Preview> make_egl_preview() {
  static const auto make = part_function<&softreel_make_egl_preview>("egl", "softreel_make_egl_preview");
  return make();
}

#else

std::unique_ptr<Preview> make_egl_preview() {
  throw input_error(
      "This build of softreel has no preview: it was configured with SOFTREEL_WITH_EGL=OFF or without EGL and epoxy.\n"
      "  Accepted: a build with SOFTREEL_WITH_EGL=ON. Install libegl-dev and libepoxy-dev and configure again, or "
      "render with the path tracer.");
}

#endif

}  // namespace softreel
