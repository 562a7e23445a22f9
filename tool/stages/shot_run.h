/// One shot on its way through the stages: bodies filled once, then frame after frame in order.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tool/shot/shot.h"
#include "tool/stages/body_stage.h"
#include "tool/stages/run_context.h"
#include "tool/stages/simulate_stage.h"

namespace softreel {

/// The surface of a body at the times of the shutter; one time where there is no motion blur.
struct SkinnedBody {
  struct Time {
    std::vector<Vec3> positions;  ///< as surface.positions, m
    std::vector<Vec3> normals;    ///< empty if not asked for
  };
  std::vector<Time> times;  ///< times.back() is the frame itself
};

/// What is wanted of each frame.
struct SkinRequest {
  bool normals = true;
  double shutter = 0;  ///< share of a frame, ending at the frame
  int segments = 1;    ///< straight pieces while the shutter is open
};

/// Counts for the report.
struct SimulationCounts {
  int frames = 0, frames_from_cache = 0;
  std::int64_t linear_iterations = 0, nonlinear_iterations = 0;
};

class ShotRun {
 public:
  /// Loads the bodies; nothing is filled or simulated yet. shot and context are kept by reference.
  ShotRun(const Shot& shot, const RunContext& context);
  ~ShotRun();

  const Shot& shot() const { return shot_; }
  const RunContext& context() const { return context_; }
  std::size_t body_count() const { return bodies_.size(); }
  const BodySettings& settings(std::size_t body) const { return shot_.bodies[body]; }
  const LoadedBody& loaded(std::size_t body) const;
  /// Fills the bodies (or reads them from the cache) and sets up their simulations; the first call does the work.
  void fill();
  const FilledBody& filled(std::size_t body) const;
  /// Levels of the body's multigrid hierarchy; empty if no frame had to be simulated.
  std::vector<LevelInfo> levels(std::size_t body) const;

  /// Runs all bodies up to `frame` (from the cache where it holds them). Frames must be asked for in rising order, from
  /// shot.frames[0] on.
  void advance_to(int frame);
  /// The bodies' surfaces at the frame that advance_to reached.
  std::vector<SkinnedBody> skin(const SkinRequest& request);
  const SimulationCounts& counts() const { return counts_; }

 private:
  struct Body;
  SkinnedBody skin(const Body& body, const SkinRequest& request) const;

  const Shot& shot_;
  const RunContext& context_;
  std::vector<std::unique_ptr<Body>> bodies_;
  bool filled_ = false;
  SimulationCounts counts_;
};

/// Node positions at a time in [-1, 0] frames before a frame, on the straight lines between sub-steps. `steps`: node
/// positions at equally spaced times from the previous frame to this one, at least one.
std::vector<Vec3> positions_between(const std::vector<const std::vector<Vec3>*>& steps, double time);

}  // namespace softreel
