#include <cmath>

#include <fmt/format.h>

#include "core/dynamics/step_work.h"

namespace softreel {
namespace {

Index count_sharing(const ElementTroubles& troubles) {
  Index count = 0;
  for (const ElementTrouble& trouble : troubles) count += trouble.sharing > 0 ? 1 : 0;
  return count;
}

/// One line where a recovery begins, ends or is given up; nothing on the steps between.
void log_recovery(const Simulator::Parts& parts, double frame, const RecoveryReport& report) {
  const Index before = count_sharing(parts.state.troubles);
  if (before == 0 && report.elements > 0)
    parts.log.info(
        fmt::format("{}: frame {:g}: elements stay inverted or wound round an edge; recovery gives {} of {} "
                    "elements one rotation a patch ({} patches)",
                    parts.model.name, frame, report.elements, parts.body.tets.size(), report.patches));
  if (before > 0 && report.elements == 0)
    parts.log.info(fmt::format("{}: frame {:g}: recovery ends", parts.model.name, frame));
  if (report.given_up > 0)
    parts.log.warn(fmt::format("{}: frame {:g}: recovery gives up {} elements that pins or pulls keep inverted",
                               parts.model.name, frame, report.given_up));
}

/// Turns smaller than this since the step's start, rad, have no lag worth its cost.
constexpr double kNoTurn = 2e-3;

/// Adds TimeStep::turn_lag to the turn of each element since the step's start, by the share of its nodes that are not
/// held, whose places at the end are known. Not where elements tumble by more than a radian a step: nothing is even
/// there.
void make_up_for_lag(const Simulator::Parts& parts, StepWork& work) {
  const double lag = work.step.turn_lag;
  if (lag == 0) return;
  constexpr std::int64_t kGrain = 4096;
  parts.threads.for_chunks(
      static_cast<std::int64_t>(work.rotations.size()), kGrain, [&](std::int64_t b, std::int64_t e) {
        for (auto k = static_cast<std::size_t>(b); k < static_cast<std::size_t>(e); ++k) {
          Quaternion turn = work.rotations[k] * parts.state.rotations[k].conjugate();
          const double sine = turn.vec().norm();
          if (2 * sine < kNoTurn) continue;
          const double angle = 2 * std::atan2(sine, std::abs(turn.w()));
          int free = 0;
          for (const Index node : parts.body.tets[k])
            free += work.pinned.held[static_cast<std::size_t>(node)] == 0 ? 1 : 0;
          const double added = 0.25 * free * lag * angle * angle * angle / (1 + std::pow(angle, 8));
          const Vec3 axis = turn.vec() / (turn.w() < 0 ? -sine : sine);
          work.rotations[k] = Quaternion(Eigen::AngleAxisd(added, axis)) * work.rotations[k];
        }
      });
}

}  // namespace

RecoveryReport find_step_rotations(Simulator::Parts& parts, double frame, StepWork& work) {
  const ScopedStage stage(parts.times, "simulate/rotate");
  RecoveryReport report;
  const std::span<const Vec3> positions = work.positions;
  const bool recovers = parts.params.recovery && parts.params.rotation != RotationMethod::None;
  if (!recovers) {
    find_rotations(parts.body, parts.params.rotation, positions, work.rotations, parts.threads);
    if (parts.params.rotation != RotationMethod::None) make_up_for_lag(parts, work);
    return report;
  }
  const std::int64_t flat =
      find_rotations_and_flat(parts.body, parts.params.rotation, positions, work.rotations, parts.threads);
  make_up_for_lag(parts, work);
  if (flat == 0 && work.troubles.empty()) return report;
  const std::vector<std::uint8_t> held_pieces = parts.held_pieces(work.pinned, work.pulls);
  count_troubles(parts.body, positions, flat, {work.pinned.held, held_pieces, parts.pieces}, work.step.h, work.troubles,
                 report);
  share_rotations(parts.body, positions, work.step.h, work.troubles, parts.state.rotations, work.rotations, report);
  log_recovery(parts, frame, report);
  return report;
}

}  // namespace softreel
