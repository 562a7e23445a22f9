/// Short runs of one body of a shot in any cut of space and time, for the error dial to compare.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/dynamics/error_dial.h"
#include "core/dynamics/simulator.h"
#include "tool/bodies/body_stage.h"
#include "tool/bodies/run_context.h"
#include "tool/shot/shot.h"

namespace softreel {

bool is_static(const Shot& shot);

/// The tolerance that decides the solver's error: of balance, or of a step's linear solve.
double& tolerance_of(Shot& shot);

/// Runs that leave nothing behind: neither in the cache nor in the log or the times of stages.
class DialPilots {
 public:
  /// All but `loaded` are kept by reference.
  DialPilots(const Shot& shot, const BodySettings& body, const LoadedBody& loaded, const BodyConstraints& constraints,
             const RunContext& context);

  /// At most 2000 vertices of the surface, evenly taken, at all frames of a dynamic shot and at most 8 of a static one.
  /// None if the body cannot be filled so coarsely or a frame cannot be solved: problem() says why.
  std::optional<SampledMotion> run(const Discretization& cut);

  /// The same on tetrahedra made elsewhere; cut.tets is not looked at. Throws Error if a frame cannot be solved.
  SampledMotion run_on(const FilledBody& filled, const Discretization& cut) const;

  /// Why the last run that failed did.
  const std::string& problem() const { return problem_; }

 private:
  const FilledBody& fill(std::int64_t tets);
  std::vector<Vec3> points_of(const Simulator& simulator, const FilledBody& filled) const;
  SampledMotion move(Simulator& simulator, const FilledBody& filled) const;
  SampledMotion balance(Simulator& simulator, const FilledBody& filled) const;

  const Shot& shot_;
  const BodySettings& body_;
  LoadedBody loaded_;
  const BodyConstraints& constraints_;
  const Log no_log_;
  StageTimes no_times_;
  RunContext quiet_;
  std::vector<std::size_t> points_;           ///< vertices that are compared
  std::map<std::int64_t, FilledBody> fills_;  ///< by the number asked for
  std::string problem_;
};

}  // namespace softreel
