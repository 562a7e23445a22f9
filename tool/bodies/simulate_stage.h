/// One body through time: any frame, from the cache where it has it, simulated from the nearest stored one otherwise.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/dynamics/frame_steps.h"
#include "core/dynamics/simulator.h"
#include "tool/bodies/body_stage.h"
#include "tool/bodies/run_context.h"
#include "tool/cache/key.h"
#include "tool/shot/shot.h"

namespace softreel {

/// What frames took, and what they need not take.
struct SimulationWork {
  std::int64_t linear_iterations = 0, nonlinear_iterations = 0;
  std::int64_t steps = 0;             ///< of time, at rest or not
  std::int64_t steps_at_rest = 0;     ///< of these, left out
  std::int64_t steps_rejected = 0;    ///< solved in vain, as their error was too great
  std::int64_t frames_unchanged = 0;  ///< static, left out: the constraints are those of the frame before
  std::int64_t kept_hierarchies = 0;  ///< steps that took the coarse levels of an earlier one
  double kept_matrices = 0;           ///< sum over the steps of the shares of their matrices that were kept
  SimulationWork& operator+=(const SimulationWork& other);
};

/// Energies of a body at a frame, J. What pulls store is not in them.
struct FrameEnergy {
  double kinetic = 0;
  double elastic = 0;  ///< of the corotated material
  double gravity = 0;  ///< potential, against the body at rest
  double total() const { return kinetic + elastic + gravity; }
};

/// One body at one frame.
struct BodyFrame {
  SimulationState state;                         ///< at the frame
  std::vector<std::vector<Vec3>> earlier_steps;  ///< node positions after each sub-step of the frame but the last
  SimulationWork work;                           ///< of this run: nothing if from the cache
  Index recovering_elements = 0;                 ///< most in a step; 0 if from the cache
  std::optional<FrameEnergy> energy;             ///< none if a softreel that did not measure it stored the frame
};

/// Recovery at work in a frame.
struct FrameRecovery {
  std::string body;
  int frame = 0;
  Index elements = 0;  ///< most that shared a rotation in a step
};

/// What a run did and what it need not do, of one body or of several.
struct SimulationCounts {
  int computed = 0, loaded = 0, not_needed = 0;
  SimulationWork work;
  double saved_seconds = 0;               ///< what the frames that were not computed took when they were
  std::vector<FrameRecovery> recoveries;  ///< of the computed frames
};

class GlueGroup;

/// What a simulation is made of.
struct SimulationSource {
  StageKey filled_key;
  std::vector<StageKey> frame_keys;  ///< from first_simulated_frame on
  std::function<FilledBody()> fill;
  std::function<BodyModel(const FilledBody&, const BodyConstraints&)> make_model;
};

/// Nothing is filled or simulated before it is asked for. Not thread-safe.
class BodySimulation {
 public:
  /// All are kept by reference but the constraints.
  BodySimulation(const Shot& shot, const BodySettings& settings, const LoadedBody& loaded, BodyConstraints constraints,
                 const RunContext& context);
  /// The same of any source: of several bodies as one. settings: name and rotation count.
  BodySimulation(const Shot& shot, const BodySettings& settings, SimulationSource source, BodyConstraints&& constraints,
                 const RunContext& context);
  ~BodySimulation();

  /// From now on keys and frames are those of a group's member. The group is kept by reference.
  void join(GlueGroup& group, std::size_t member);

  const BodyConstraints& constraints() const { return constraints_; }
  const StageKey& filled_key() const { return source_.filled_key; }
  /// Of a frame between first_simulated_frame and the last one of the shot.
  const StageKey& frame_key(int frame) const;

  /// The tetrahedra; the first call reads or makes them.
  const FilledBody& filled();
  bool is_filled() const { return filled_ != nullptr; }

  /// The body at a frame. Throws work_error naming frame, body and element or constraint if a step cannot be solved.
  const BodyFrame& at(int frame);

  /// Frames up to `last` that were neither computed nor loaded count as not needed if they are stored. Those of a group
  /// count once, for its first member.
  SimulationCounts counts(int last) const;
  /// What moves as one, and has one energy: the body, or the bodies that glue joins, "a + b".
  const std::string& whole_name() const;
  /// Energies of that at the frames that this run computed or loaded.
  const std::map<int, FrameEnergy>& energies() const;
  /// Levels of the multigrid hierarchy; empty while no frame was computed.
  std::vector<LevelInfo> levels() const;

 private:
  Simulator& simulator();
  SimulationState rest_state() const;
  void put_aside();
  bool take_other(int frame);
  bool load(int frame);
  void produce(int frame);
  BodyFrame simulated(int frame);
  FrameEnergy measured_energy();
  void note(int frame);
  void note_loaded(int frame, double seconds);
  bool starts_from_rest(int frame) const;
  void advance(int frame, BodyFrame& result);
  SimulationWork find_equilibrium(int frame);
  void require_solved(const StepReport& report, int frame) const;
  void require_small_error(const FrameReport& report, int frame) const;

  const Shot& shot_;
  const BodySettings& settings_;
  const RunContext& context_;
  SimulationSource source_;
  BodyConstraints constraints_;
  GlueGroup* group_ = nullptr;  ///< that moves the body; null: it moves by itself
  std::size_t member_ = 0;
  std::vector<bool> touched_;  ///< per frame: computed or loaded by this run
  std::unique_ptr<FilledBody> filled_;
  std::unique_ptr<Simulator> simulator_;  ///< made when the first frame has to be simulated
  bool simulator_holds_frame_ = false;
  BodyFrame frame_;
  int frame_number_;  ///< of frame_; before the first simulated frame while there is none
  /// Motion blur and differences between frames go back by one, which must not need the cache: it may be unwritable.
  bool goes_back_;
  BodyFrame other_;  ///< what frame_ was before, if frames are asked for again
  int other_number_;
  SimulationCounts counts_;
  std::map<int, FrameEnergy> energies_;
  std::optional<double> rest_potential_;  ///< of gravity, J; found when the first energy is measured
};

}  // namespace softreel
