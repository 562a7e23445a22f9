/// What tests of drawn previews ask for: the preview, and its pixels.
#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "render/preview/preview.h"
#include "render/scene/camera_frame.h"

namespace softreel {

/// Null, with the reason printed, where this machine cannot draw.
inline std::unique_ptr<Preview> egl_preview_or_null(std::string& reason) {
  try {
    return make_egl_preview();
  } catch (const Error& error) {
    reason = error.what();
    return nullptr;
  }
}

/// Red, green and blue of a pixel.
inline Vec3f pixel_at(const DisplayImage& image, int x, int y) {
  const std::size_t at =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return Vec3f(image.pixels[at], image.pixels[at + 1], image.pixels[at + 2]);
}

/// Where the camera sees a point, pixels from the upper left corner; from the camera's axes, not from a matrix.
inline Vec2f place_of(const Vec3f& point, const Camera& camera, int width, int height) {
  const CameraFrame frame = camera_frame(camera, width, height);
  const Vec3f to = point - frame.position;
  const float depth = to.dot(frame.forward);
  const float x = to.dot(frame.right) / (depth * frame.half_width), y = to.dot(frame.up) / (depth * frame.half_height);
  return {0.5f * static_cast<float>(width) * (1 + x), 0.5f * static_cast<float>(height) * (1 - y)};
}

/// The pixel at which the camera sees a point.
inline Vec3f pixel_of(const DisplayImage& image, const Camera& camera, const Vec3f& point) {
  const Vec2f at = place_of(point, camera, image.width, image.height);
  return pixel_at(image, static_cast<int>(at.x()), static_cast<int>(at.y()));
}

/// Small square pictures, drawn as they are; skips where this machine cannot draw.
class DrawnPreview : public ::testing::Test {
 protected:
  static constexpr int kSize = 96;  ///< pixels

  void SetUp() override {
    std::string reason;
    preview_ = egl_preview_or_null(reason);
    if (preview_ == nullptr) GTEST_SKIP() << reason;
  }
  DisplayImage draw(const Scene& scene) { return preview_->draw(scene, kSize, kSize, ViewTransform::Raw, 0); }
  Vec3f seen(const Scene& scene, const Vec3f& point) { return pixel_of(draw(scene), scene.camera, point); }

 private:
  std::unique_ptr<Preview> preview_;
};

}  // namespace softreel
