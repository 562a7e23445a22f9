/// Marks that a preview draws over the bodies: where constraints hold them, and where they pull them to.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/base/types.h"

namespace softreel {

/// Colours are display values, 0 to 1; no light falls on marks.
struct GizmoMarks {
  struct Dot {
    Vec3f at;
    Vec3f color;
    float diameter = 5;  ///< pixels of a picture 720 pixels high; it grows with the picture
  };
  struct Line {
    Vec3f from, to;
    Vec3f color;
  };
  std::vector<Dot> dots;
  std::vector<Line> lines;  ///< drawn below the dots

  bool empty() const { return dots.empty() && lines.empty(); }
};

/// A corner of one of the triangles that marks are drawn as.
struct OverlayVertex {
  Eigen::Vector4f clip;
  Vec2f disk;   ///< place in the unit disk of a dot; the origin on lines
  Vec3f color;  ///< display values
};

/// Triangles, three vertices each, that show the marks in width x height pixels of a picture `picture_height` pixels
/// high: lines first. What lies behind the camera is left out, and lines are cut there. Marks come nearer to the
/// camera, which is at `eye`, by two thousandths of their distance, so that those on a surface are not half in it.
std::vector<OverlayVertex> overlay_triangles(const GizmoMarks& marks, const Eigen::Matrix4f& clip_from_world,
                                             const Vec3f& eye, int width, int height, int picture_height);

}  // namespace softreel
