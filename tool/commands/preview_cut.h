/// Previews of the tetrahedra that lie behind a plane.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tool/report/body_cuts.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/shot_run.h"

namespace softreel {

class PreviewCut {
 public:
  /// cut: as --cut has it; empty: through the middle, whichever way the camera of the first frame looks most face on.
  /// run and scenes: kept by reference.
  PreviewCut(ShotRun& run, const SceneStage& scenes, const std::string& cut);

  /// What pictures depend on beyond the surfaces.
  void add_key(KeyHasher& key) const { key.add("tets 1").add(cut_); }

  /// Puts the cut tetrahedra of a frame in the place of the bodies. bodies: with their nodes.
  void replace_bodies(int frame, const std::vector<SkinnedBody>& bodies, Scene& scene);

  /// Per body and point of its surface, whether what carries it is shown. After replace_bodies.
  std::vector<std::vector<char>> shown_points() const;

 private:
  ShotRun& run_;
  const SceneStage& scenes_;
  std::string cut_;
  std::optional<BodyCuts> cuts_;  ///< made at the first frame that is drawn
};

}  // namespace softreel
