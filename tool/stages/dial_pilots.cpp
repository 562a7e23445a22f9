#include "tool/stages/dial_pilots.h"

#include <fmt/format.h>

#include "core/dynamics/frame_steps.h"
#include "core/skinning/skinning.h"
#include "tool/stages/simulate_key.h"

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

void require(bool is_solved, int frame) {
  if (!is_solved) throw work_error(fmt::format("frame {} could not be solved", frame));
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
  if (shot_.settings.start == StartState::Equilibrium) require(simulator.find_equilibrium(start).ok(), start);
  SampledMotion motion;
  for (int frame = start; frame <= shot_.settings.last_frame; ++frame) {
    if (frame > start) {
      const FrameReport report = advance_to_frame(
          simulator, frame, shot_.settings.fps, [this] { quiet_.stop_if_cancelled(); }, [](int) {});
      require(report.ok(), frame);
    }
    if (frame >= shot_.settings.first_frame) motion.push_back(points_of(simulator, filled));
  }
  return motion;
}

/// A few frames in order; all of them as stations on the way where the few are too far apart.
SampledMotion DialPilots::balance(Simulator& simulator, const FilledBody& filled) const {
  const int count = shot_.settings.last_frame - shot_.settings.first_frame + 1;
  const int stride = (count + kMostStaticFrames - 1) / kMostStaticFrames;
  if (auto motion = balance_every(stride, stride, simulator, filled)) return *motion;
  if (auto motion = balance_every(1, stride, simulator, filled)) return *motion;
  throw work_error("an equilibrium could not be found");
}

std::optional<SampledMotion> DialPilots::balance_every(int station, int stride, Simulator& simulator,
                                                       const FilledBody& filled) const {
  simulator.set_state(rest_of(filled.mesh));
  SampledMotion motion;
  // From the last frame backwards, so that the end of the motion is among the frames.
  const int count = shot_.settings.last_frame - shot_.settings.first_frame;
  for (int i = count % stride; i <= count; i += station) {
    quiet_.stop_if_cancelled();
    if (shot_.settings.independent) simulator.set_state(rest_of(filled.mesh));
    if (!simulator.find_equilibrium(shot_.settings.first_frame + i).ok()) return std::nullopt;
    if ((count - i) % stride == 0) motion.push_back(points_of(simulator, filled));
  }
  return motion;
}

}  // namespace softreel
