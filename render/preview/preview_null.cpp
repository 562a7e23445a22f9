#include "core/base/check.h"
#include "render/image/view_transform.h"
#include "render/preview/preview.h"

namespace softreel {

namespace {

class NullPreview : public Preview {
 public:
  DisplayImage draw(const Scene& scene, int width, int height, ViewTransform view, float exposure,
                    const PreviewStyle& style) override {
    if (style.window != PixelWindow{}) width = style.window.width(), height = style.window.height();
    CHECK(width > 0);
    CHECK(height > 0);
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    const Vec3f color = scene.environment.strength * scene.environment.horizon;
    Image image{width, height, {}};
    const char* const names[] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) image.channels.push_back({names[c], std::vector<float>(pixels, color[c])});
    return to_display(image, view, exposure);
  }
  std::string description() const override { return "null preview: draws nothing"; }
};

}  // namespace

std::unique_ptr<Preview> make_null_preview() {
  return std::make_unique<NullPreview>();
}

}  // namespace softreel
