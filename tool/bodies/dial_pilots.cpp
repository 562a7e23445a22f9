#include "tool/bodies/dial_pilots.h"

#include <fmt/format.h>

#include "core/dynamics/frame_steps.h"
#include "core/skinning/skinning.h"
#include "tool/bodies/simulate_key.h"

namespace softreel {
namespace {

constexpr std::size_t kMostPoints = 2000;
constexpr int kMostStaticFrames = 8;

/// A body at pilot sizes: as the shot has it but for the number of tetrahedra.
BodySettings at_size(BodySettings body, std::int64_t tets) {
  body.graded = body.graded || body.error.value > 0;
  body.tets = tets;
  body.edge = 0;
  body.error = {};
  body.tetrahedra.clear();
  body.optimize = false;
  return body;
}

SimulationState rest_of(const TetMesh& mesh) {
  return {mesh.nodes, std::vector<Vec3>(mesh.nodes.size(), Vec3::Zero()),
          std::vector<Quaternion>(mesh.tets.size(), Quaternion::Identity())};
}

void require(const StepReport& report, int frame) {
  if (report.ok()) return;
  throw work_error(fmt::format("frame {} could not be solved{}{}", frame, report.culprit.empty() ? "" : "; worst at ",
                               report.culprit));
}

}  // namespace

bool is_static(const Shot& shot) {
  return shot.settings.mode == SimulationMode::Static;
}

double& tolerance_of(Shot& shot) {
  const bool balances = is_static(shot) || linearization(shot.solver) == Linearize::Iterated;
  return balances ? shot.solver.force_tolerance : shot.solver.tolerance;
}

DialPilots::DialPilots(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                       const BodyConstraints& constraints, const RunContext& context)
    : shot_(shot),
      body_(body),
      loaded_(loaded),
      constraints_(constraints),
      quiet_{context.threads, no_log_, no_times_, context.cache, context.cancelled} {
  loaded_.given.reset();
  const std::size_t vertices = loaded_.surface.positions.size();
  const std::size_t stride = (vertices + kMostPoints - 1) / kMostPoints;
  for (std::size_t v = 0; v < vertices; v += stride) points_.push_back(v);
}

std::optional<SampledMotion> DialPilots::run(const Discretization& cut) {
  quiet_.stop_if_cancelled();
  try {
    return run_on(fill(cut.tets), cut);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::Interrupt) throw;
    problem_ = error.what();
    return std::nullopt;
  }
}

SampledMotion DialPilots::run_on(const FilledBody& filled, const Discretization& cut) const {
  Shot shot = shot_;
  shot.solver.substeps = cut.substeps;
  tolerance_of(shot) = cut.tolerance;
  StageTimes times;
  Simulator simulator(make_body_model(shot, body_, loaded_, filled, constraints_), solver_of(shot, body_),
                      quiet_.threads, quiet_.log, times);
  return is_static(shot) ? balance(simulator, filled) : move(simulator, filled);
}

/// A mesh may be asked for again.
const FilledBody& DialPilots::fill(std::int64_t tets) {
  if (const auto known = fills_.find(tets); known != fills_.end()) return known->second;
  return fills_.emplace(tets, fill_body_anew(at_size(body_, tets), loaded_, quiet_)).first->second;
}

std::vector<Vec3> DialPilots::points_of(const Simulator& simulator, const FilledBody& filled) const {
  const std::vector<Vec3> all = skin_positions(loaded_.surface.positions, filled.embedding, filled.mesh,
                                               simulator.state().positions, quiet_.threads);
  std::vector<Vec3> some;
  for (const std::size_t v : points_) some.push_back(all[v]);
  return some;
}

SampledMotion DialPilots::move(Simulator& simulator, const FilledBody& filled) const {
  simulator.set_state(rest_of(filled.mesh));
  const int start = first_simulated_frame(shot_);
  if (shot_.settings.start == StartState::Equilibrium)
    require(simulator.find_equilibrium(start), start);
  else
    simulator.start_grabs(start);
  SampledMotion motion;
  for (int frame = start; frame <= shot_.settings.last_frame; ++frame) {
    if (frame > start) {
      const FrameReport report = advance_to_frame(
          simulator, frame, shot_.settings.fps, [this] { quiet_.stop_if_cancelled(); }, [](int) {});
      require(report.last, frame);
    }
    if (frame >= shot_.settings.first_frame) motion.push_back(points_of(simulator, filled));
  }
  return motion;
}

/// A few frames are looked at. All between are walked, as the turns of pins are only known from frame to frame; unless
/// no frame of the shot knows of another.
SampledMotion DialPilots::balance(Simulator& simulator, const FilledBody& filled) const {
  const int count = shot_.settings.last_frame - shot_.settings.first_frame + 1;
  const int stride = (count + kMostStaticFrames - 1) / kMostStaticFrames;
  const int station = shot_.settings.independent ? stride : 1;
  simulator.set_state(rest_of(filled.mesh));
  SampledMotion motion;
  // From the last frame backwards, so that the end of the motion is among the frames.
  const int last = count - 1;
  for (int i = station == 1 ? 0 : last % stride; i <= last; i += station) {
    quiet_.stop_if_cancelled();
    if (shot_.settings.independent) simulator.set_state(rest_of(filled.mesh));
    const int frame = shot_.settings.first_frame + i;
    require(simulator.find_equilibrium(frame), frame);
    if ((last - i) % stride == 0) motion.push_back(points_of(simulator, filled));
  }
  return motion;
}

}  // namespace softreel
