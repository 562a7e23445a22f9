/// Bodies that glue joins: one simulation for all of them, and each body's share of its frames.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/dynamics/joined_model.h"
#include "tool/bodies/body_stage.h"
#include "tool/bodies/simulate_stage.h"
#include "tool/shot/shot.h"

namespace softreel {

/// Indices of the bodies that glue joins, directly or through others: two at least to a group, in the order of the
/// shot. Glue whose stiffness is always 0 joins nothing.
std::vector<std::vector<std::size_t>> glue_groups(const Shot& shot);

/// A body of a group; all are kept by reference.
struct GlueMember {
  const BodySettings& settings;
  const LoadedBody& loaded;
  BodySimulation& simulation;  ///< its tetrahedra and constraints are asked for, its frames are not
};

/// The bodies of one group, simulated as one. A frame of the group is one result of the cache: its key is that of a
/// frame of each member, so any change of one body, or of the glue, makes the frames of all of them anew. Not
/// thread-safe but for keys.
class GlueGroup {
 public:
  /// Throws input_error, with the place, for a selection that takes nothing. shot and context are kept by reference.
  GlueGroup(const Shot& shot, std::vector<GlueMember> members, const RunContext& context);

  const StageKey& frame_key(int frame) const { return joined_->frame_key(frame); }
  /// One body at a frame; the reference is good until kKeptFrames other frames were asked for.
  const BodyFrame& at(std::size_t member, int frame);
  SimulationCounts counts(int last) const { return joined_->counts(last); }
  const std::string& name() const { return settings_.name; }
  const std::map<int, FrameEnergy>& energies() const { return joined_->energies(); }
  std::vector<LevelInfo> levels() const { return joined_->levels(); }

 private:
  /// Motion blur and motion vectors look at the frames beside one, body by body.
  static constexpr std::size_t kKeptFrames = 4;

  /// Glue between two members.
  struct Joint {
    const GlueSettings& settings;
    std::string field;          ///< "glue[0]"
    std::string name;           ///< "glue[0] (shots/a.toml:31)"
    std::size_t first, second;  ///< members
    std::vector<Index> points;  ///< selected vertices of the first
  };
  struct SplitFrame {
    int frame = 0;
    std::vector<BodyFrame> members;
  };

  Glue make_glue(const Joint& joint, const std::vector<ModelOffsets>& offsets) const;
  std::vector<BodyModel> make_models() const;
  FilledBody join_filled() const;
  BodyModel make_model() const;
  BodyConstraints join_constraints() const;
  StageKey base_key() const;
  SplitFrame split(int frame) const;

  const Shot& shot_;
  const RunContext& context_;
  std::vector<GlueMember> members_;
  std::vector<Joint> joints_;
  BodySettings settings_;  ///< of the whole: name and rotation
  std::unique_ptr<BodySimulation> joined_;
  std::deque<SplitFrame> recent_;
};

}  // namespace softreel
