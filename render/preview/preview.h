/// A quick lit picture of a Scene by rasterisation; EGL where it works, a null back end for tests of its callers.
#pragma once

#include <memory>
#include <string>

#include "render/image/image_io.h"
#include "render/preview/gizmo_marks.h"
#include "render/scene/pixel_window.h"
#include "render/scene/scene.h"

namespace softreel {

struct PreviewStyle {
  bool fast = false;       ///< lit only: no shadows, no anti-aliasing
  bool wireframe = false;  ///< the edges of the bodies' triangles over them
  GizmoMarks marks;        ///< whole where they are seen, faint behind bodies
  PixelWindow window;      ///< what of the picture is drawn; beyond its edges the view goes on
};

class Preview {
 public:
  virtual ~Preview() = default;
  /// The scene at the closing of the shutter, seen by the same camera, lit by the lights that preview_lights names; the
  /// first four of them that can cast shadows of the bodies do. An image of the surroundings is seen, and lights by its
  /// spherical harmonics, without shadows. Materials look about as the path tracer has them: textures, colours of
  /// vertices, heat, lines along edges, coat, sheen and emission; of glass the nearest surface, and what is behind
  /// without refraction; nothing of light that scatters inside or from body to body. A ground that catches shadows
  /// leaves the picture's alpha, without the soft shadow of the surroundings.
  /// width, height: of the whole picture; the result has the size of style.window.
  virtual DisplayImage draw(const Scene& scene, int width, int height, ViewTransform view, float exposure,
                            const PreviewStyle& style) = 0;
  DisplayImage draw(const Scene& scene, int width, int height, ViewTransform view, float exposure) {
    return draw(scene, width, height, view, exposure, {});
  }
  /// "EGL 1.5, Mesa llvmpipe ..." for the report.
  virtual std::string description() const = 0;
};

/// Opens EGL without a display (surfaceless). Throws work_error (exit 1) saying what failed and what to install.
/// Throws input_error if EGL is not built in.
std::unique_ptr<Preview> make_egl_preview();
/// Draws nothing: pictures of the background colour.
std::unique_ptr<Preview> make_null_preview();

/// The entry of the part, which make_egl_preview calls.
extern "C" [[gnu::visibility("default")]] std::unique_ptr<Preview> softreel_make_egl_preview();

}  // namespace softreel
