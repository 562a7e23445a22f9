/// Bodies through time, frame by frame; frames that the cache holds are read, not simulated.
#pragma once

#include <memory>
#include <vector>

#include "core/dynamics/simulator.h"
#include "tool/shot/shot.h"
#include "tool/stages/key.h"
#include "tool/stages/run_context.h"

namespace softreel {

/// One body at one frame.
struct BodyFrame {
  SimulationState state;                         ///< at the frame
  std::vector<std::vector<Vec3>> earlier_steps;  ///< node positions after each sub-step of the frame but the last
  StageKey key;
  bool from_cache = false;
  int linear_iterations = 0, nonlinear_iterations = 0;  ///< summed over the sub-steps; 0 if from the cache
};

/// Runs one body from its start to any later frame, in order.
class BodySimulation {
 public:
  /// The model's key must cover everything that shaped it but its constraints' values over time.
  BodySimulation(const Shot& shot, BodyModel model, const StageKey& filled_key, const RunContext& context);
  ~BodySimulation();

  /// The next frame, from first_frame - preroll on. Throws work_error naming frame, body and element or constraint if a
  /// step cannot be solved.
  BodyFrame next_frame();
  /// The frame that next_frame will return.
  int upcoming_frame() const { return upcoming_; }

  const BodyModel& model() const;
  /// Levels of the multigrid hierarchy; empty while all frames came from the cache.
  std::vector<LevelInfo> levels() const;

 private:
  Simulator& simulator();
  SimulationState rest_state() const;
  BodyFrame start_frame();
  BodyFrame simulated(int frame);
  int first_simulated_frame() const;
  StageKey next_key(int frame) const;
  void require_solved(const StepReport& report, int frame) const;

  const Shot& shot_;
  BodyModel model_;
  const RunContext& context_;
  StageKey base_key_, previous_key_;
  SimulationState state_;  ///< at the frame before the upcoming one
  bool simulator_holds_state_ = false;
  int upcoming_;
  std::unique_ptr<Simulator> simulator_;  ///< made when the first frame has to be simulated
};

}  // namespace softreel
