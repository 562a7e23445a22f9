#include "render/preview/picture_regions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "render/preview/near_limit.h"

namespace softreel {
namespace {

constexpr float kMapMargin =
    0.03f;  ///< by which what is shaded looks beyond the map of a light, share of half its edge

Eigen::Vector4f clip_of(const Eigen::Matrix4f& clip_from_world, const Vec3f& p) {
  return clip_from_world * p.homogeneous();
}

/// The part of a convex polygon where a linear function is not negative (Sutherland and Hodgman 1974).
template <typename Point, typename Function>
std::vector<Point> cut(const std::vector<Point>& polygon, const Function& function) {
  std::vector<Point> kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const float at_a = function(a), at_b = function(b);
    if (at_a >= 0) kept.push_back(a);
    if ((at_a >= 0) != (at_b >= 0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return kept;
}

/// The part of a triangle that lies in the map of a light or behind it.
std::vector<Vec3f> in_map(std::vector<Vec3f> polygon, const Eigen::Matrix4f& light) {
  constexpr float kWide = 1 + kMapMargin;
  for (int axis = 0; axis < 2; ++axis)
    for (const float side : {-1.0f, 1.0f})
      polygon = cut(polygon, [&](const Vec3f& p) {
        const Eigen::Vector4f clip = clip_of(light, p);
        return kWide * clip.w() + side * clip[axis];
      });
  polygon = cut(polygon, [&](const Vec3f& p) { return clip_of(light, p).w() - kNearest; });
  return cut(polygon, [&](const Vec3f& p) {
    const Eigen::Vector4f clip = clip_of(light, p);
    return kWide * clip.w() + clip.z();
  });
}

/// One bit for each side of the clip volume that a point lies beyond.
unsigned outside_bits(const Eigen::Vector4f& clip) {
  unsigned bits = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (clip[axis] < -clip.w()) bits |= 1U << (2 * axis);
    if (clip[axis] > clip.w()) bits |= 2U << (2 * axis);
  }
  return bits;
}

}  // namespace

PixelRect common(const PixelRect& a, const PixelRect& b) {
  return {std::max(a.left, b.left), std::max(a.bottom, b.bottom), std::min(a.right, b.right), std::min(a.top, b.top)};
}

std::vector<PixelRect> without(const PixelRect& whole, const PixelRect& hole) {
  const PixelRect inner = common(whole, hole);
  if (inner.empty()) return whole.empty() ? std::vector<PixelRect>{} : std::vector<PixelRect>{whole};
  std::vector<PixelRect> rects{{whole.left, whole.bottom, whole.right, inner.bottom},
                               {whole.left, inner.top, whole.right, whole.top},
                               {whole.left, inner.bottom, inner.left, inner.top},
                               {inner.right, inner.bottom, whole.right, inner.top}};
  std::erase_if(rects, [](const PixelRect& rect) { return rect.empty(); });
  return rects;
}

void SeenRegion::add(const Eigen::Vector4f& clip) {
  if (clip.w() < kNearest) {
    left_ = bottom_ = -1;
    right_ = top_ = 1;
    return;
  }
  const float x = clip.x() / clip.w(), y = clip.y() / clip.w();
  left_ = std::min(left_, x);
  right_ = std::max(right_, x);
  bottom_ = std::min(bottom_, y);
  top_ = std::max(top_, y);
}

PixelRect SeenRegion::rect(int margin) const {
  if (left_ > right_) return {};
  const auto pixel = [](float place, int size) {
    return static_cast<int>(std::floor(0.5f * static_cast<float>(size) * (1 + std::clamp(place, -1.5f, 1.5f))));
  };
  const PixelRect wide{pixel(left_, width_) - margin, pixel(bottom_, height_) - margin,
                       pixel(right_, width_) + 1 + margin, pixel(top_, height_) + 1 + margin};
  return common(wide, {0, 0, width_, height_});
}

void add_bodies(SeenRegion& region, const std::vector<MotionMesh>& meshes, const Eigen::Matrix4f& clip_from_world) {
  for (const MotionMesh& mesh : meshes)
    for (const Vec3f& p : mesh.times.back().positions) region.add(clip_of(clip_from_world, p));
}

PixelRect shadow_region(const MotionMesh& ground, const std::vector<ShadowView>& views,
                        const Eigen::Matrix4f& clip_from_world, int width, int height) {
  SeenRegion region(width, height);
  const std::vector<Vec3f>& positions = ground.times.back().positions;
  for (const Triangle& t : ground.triangles)
    for (const ShadowView& view : views) {
      std::vector<Vec3f> polygon;
      for (const Index corner : t) polygon.push_back(positions[static_cast<std::size_t>(corner)]);
      std::vector<Eigen::Vector4f> seen;
      for (const Vec3f& p : in_map(std::move(polygon), view.clip_from_world))
        seen.push_back(clip_of(clip_from_world, p));
      seen = cut(seen, [](const Eigen::Vector4f& clip) { return clip.w() - 2 * kNearest; });
      for (const Eigen::Vector4f& clip : seen) region.add(clip);
    }
  return region.rect(2);
}

bool may_see_rim(const MotionMesh& mesh, const Eigen::Matrix4f& clip_from_world) {
  std::map<std::pair<Index, Index>, int> uses;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax(t[k], t[(k + 1) % 3])];
  const auto bits = [&](Index p) {
    return outside_bits(clip_of(clip_from_world, mesh.times.back().positions[static_cast<std::size_t>(p)]));
  };
  return std::any_of(uses.begin(), uses.end(), [&](const auto& edge) {
    return edge.second == 1 && (bits(edge.first.first) & bits(edge.first.second)) == 0;
  });
}

}  // namespace softreel
