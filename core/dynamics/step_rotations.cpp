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

}  // namespace

RecoveryReport find_step_rotations(Simulator::Parts& parts, double frame, StepWork& work) {
  const ScopedStage stage(parts.times, "simulate/rotate");
  RecoveryReport report;
  const std::span<const Vec3> positions = work.positions;
  const bool recovers = parts.params.recovery && parts.params.rotation != RotationMethod::None;
  if (!recovers) {
    find_rotations(parts.body, parts.params.rotation, positions, work.rotations, parts.threads);
    return report;
  }
  const std::int64_t flat =
      find_rotations_and_flat(parts.body, parts.params.rotation, positions, work.rotations, parts.threads);
  if (flat == 0 && work.troubles.empty()) return report;
  const std::vector<std::uint8_t> held_pieces = parts.held_pieces(work.pinned, work.pulls);
  count_troubles(parts.body, positions, flat, {work.pinned.held, held_pieces, parts.pieces}, work.step.h, work.troubles,
                 report);
  share_rotations(parts.body, positions, work.step.h, work.troubles, parts.state.rotations, work.rotations, report);
  log_recovery(parts, frame, report);
  return report;
}

}  // namespace softreel
