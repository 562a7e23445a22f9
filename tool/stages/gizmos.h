/// The marks of a shot's constraints at a frame, as previews show them.
#pragma once

#include <vector>

#include "render/preview/gizmo_marks.h"
#include "tool/stages/shot_run.h"

namespace softreel {

struct GizmoKinds {
  bool pins = true, pulls = true;
  bool regions = false;  ///< of other material or stiffness, at all frames
};

/// Pins: pink dots on their points. Pulls: blue dots on their points, lines from some of them to where they are
/// pulled to, and a large dot in the middle of their targets. Regions: green dots. Constraints that are not active at a
/// frame, and pulls without stiffness there, show nothing. Where points lie close, one of them stands for those in a
/// cube at rest, the same in all frames, so that the body stays visible between the dots.
class Gizmos {
 public:
  /// run: kept by reference.
  Gizmos(const ShotRun& run, const GizmoKinds& kinds);

  /// bodies: the surfaces at this frame. shown: per body and point of its surface, 0 where it gets no mark; empty: all
  /// may get one.
  GizmoMarks at(int frame, const std::vector<SkinnedBody>& bodies,
                const std::vector<std::vector<char>>& shown = {}) const;
  /// All that the marks depend on beyond the surfaces.
  void add_key(KeyHasher& key, int frame) const;

 private:
  const ShotRun& run_;
  GizmoKinds kinds_;
  struct BodyMarks {
    BodyConstraints constraints;
    std::vector<std::vector<Index>> pin_dots, pull_dots;  ///< per constraint, points that get a dot
    std::vector<Index> region_dots;
  };
  std::vector<BodyMarks> bodies_;
};

}  // namespace softreel
