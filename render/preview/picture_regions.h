/// Rectangles of a picture outside of which something is not seen, so that it need not be drawn there.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "render/preview/shadow_views.h"
#include "render/scene/scene.h"

namespace softreel {

/// Pixels from the lower left corner of the picture; right and top do not belong to it.
struct PixelRect {
  int left = 0, bottom = 0, right = 0, top = 0;

  bool empty() const { return right <= left || top <= bottom; }
  int width() const { return right - left; }
  int height() const { return top - bottom; }
  bool operator==(const PixelRect&) const = default;
};

PixelRect common(const PixelRect& a, const PixelRect& b);
/// What is left of `whole`, as at most four rectangles that do not overlap; none is empty.
std::vector<PixelRect> without(const PixelRect& whole, const PixelRect& hole);

/// A rectangle that grows with what is added to it.
class SeenRegion {
 public:
  SeenRegion(int width, int height) : width_(width), height_(height) {}

  /// clip: what is not before the camera makes the region the whole picture.
  void add(const Eigen::Vector4f& clip);
  /// `margin` pixels wider all round, within the picture. Empty if nothing was added.
  PixelRect rect(int margin) const;

 private:
  int width_, height_;
  float left_ = 2, right_ = -2, bottom_ = 2, top_ = -2;  ///< of the clip cube, -1 to 1
};

/// Where the bodies are seen.
void add_bodies(SeenRegion& region, const std::vector<MotionMesh>& meshes, const Eigen::Matrix4f& clip_from_world);

/// Where a ground may be seen in the shadow of bodies: what lies in the maps of the lights.
PixelRect shadow_region(const MotionMesh& ground, const std::vector<ShadowView>& views,
                        const Eigen::Matrix4f& clip_from_world, int width, int height);

/// Whether an edge of only one triangle may be seen; edges beside the picture may count as seen if they are long.
bool may_see_rim(const MotionMesh& mesh, const Eigen::Matrix4f& clip_from_world);

}  // namespace softreel
