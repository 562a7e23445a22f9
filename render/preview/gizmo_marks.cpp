#include "render/preview/gizmo_marks.h"

#include <algorithm>
#include <array>
#include <utility>

#include "render/preview/near_limit.h"

namespace softreel {
namespace {

constexpr float kLineWidth = 1.6f;       ///< pixels of a picture 720 pixels high
constexpr float kSmallestDiameter = 3;   ///< pixels of any picture
constexpr float kSmallestLineWidth = 1;  ///< pixels of any picture

class Overlay {
 public:
  Overlay(const Eigen::Matrix4f& clip_from_world, const Vec3f& eye, int width, int height, int picture_height)
      : clip_from_world_(clip_from_world),
        eye_(eye),
        width_(static_cast<float>(width)),
        height_(static_cast<float>(height)),
        scale_(static_cast<float>(picture_height) / 720) {}

  void add(const GizmoMarks::Dot& dot) {
    const Eigen::Vector4f center = clip(dot.at);
    if (center.w() < kNearest) return;
    const float radius = 0.5f * std::max(kSmallestDiameter, scale_ * dot.diameter);
    const Vec2f right = Vec2f(radius, 0), up = Vec2f(0, radius);
    add_quad({shifted(center, -right - up), shifted(center, right - up), shifted(center, right + up),
              shifted(center, up - right)},
             {Vec2f(-1, -1), Vec2f(1, -1), Vec2f(1, 1), Vec2f(-1, 1)}, dot.color);
  }

  void add(const GizmoMarks::Line& line) {
    Eigen::Vector4f a = clip(line.from);
    Eigen::Vector4f b = clip(line.to);
    if (std::max(a.w(), b.w()) < kNearest) return;
    if (a.w() < kNearest) a = cut(b, a);
    if (b.w() < kNearest) b = cut(a, b);
    const Vec2f along = pixel(b) - pixel(a);
    if (!(along.norm() > 0)) return;  // seen end on
    const float half = 0.5f * std::max(kSmallestLineWidth, scale_ * kLineWidth);
    const Vec2f side = half * Vec2f(-along.y(), along.x()).normalized();
    add_quad({shifted(a, -side), shifted(b, -side), shifted(b, side), shifted(a, side)},
             {Vec2f::Zero(), Vec2f::Zero(), Vec2f::Zero(), Vec2f::Zero()}, line.color);
  }

  std::vector<OverlayVertex> take() { return std::move(vertices_); }

 private:
  Eigen::Vector4f clip(const Vec3f& p) const {
    const Vec3f nearer = eye_ + 0.998f * (p - eye_);
    return clip_from_world_ * Eigen::Vector4f(nearer.x(), nearer.y(), nearer.z(), 1);
  }
  /// The point between a visible and a hidden one where it becomes visible.
  static Eigen::Vector4f cut(const Eigen::Vector4f& visible, const Eigen::Vector4f& hidden) {
    return visible + (visible.w() - kNearest) / (visible.w() - hidden.w()) * (hidden - visible);
  }
  Vec2f pixel(const Eigen::Vector4f& clip) const {
    return {0.5f * width_ * clip.x() / clip.w(), 0.5f * height_ * clip.y() / clip.w()};
  }
  Eigen::Vector4f shifted(Eigen::Vector4f clip, const Vec2f& pixels) const {
    clip.x() += 2 * pixels.x() / width_ * clip.w();
    clip.y() += 2 * pixels.y() / height_ * clip.w();
    return clip;
  }
  void add_quad(const std::array<Eigen::Vector4f, 4>& corners, const std::array<Vec2f, 4>& disk, const Vec3f& color) {
    for (const std::size_t k : {0U, 1U, 2U, 0U, 2U, 3U}) vertices_.push_back({corners[k], disk[k], color});
  }

  Eigen::Matrix4f clip_from_world_;
  Vec3f eye_;
  float width_, height_, scale_;
  std::vector<OverlayVertex> vertices_;
};

}  // namespace

std::vector<OverlayVertex> overlay_triangles(const GizmoMarks& marks, const Eigen::Matrix4f& clip_from_world,
                                             const Vec3f& eye, int width, int height, int picture_height) {
  Overlay overlay(clip_from_world, eye, width, height, picture_height);
  for (const GizmoMarks::Line& line : marks.lines) overlay.add(line);
  for (const GizmoMarks::Dot& dot : marks.dots) overlay.add(dot);
  return overlay.take();
}

}  // namespace softreel
