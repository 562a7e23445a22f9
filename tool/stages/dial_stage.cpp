#include "tool/stages/dial_stage.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "core/dynamics/frame_steps.h"
#include "core/skinning/skinning.h"
#include "tool/stages/bytes.h"
#include "tool/stages/simulate_key.h"
#include "tool/stages/stage_names.h"

namespace softreel {
namespace {

/// Raised whenever the same inputs would give another choice.
constexpr const char* kDialVersion = "dial 1";

/// Constraints are looked at so many times a frame for the key, whatever step is chosen.
constexpr int kLooksPerFrame = 16;
constexpr std::size_t kMostPoints = 2000;
constexpr int kMostStaticFrames = 8;

/// What the shot says where neither it nor the dial does.
constexpr std::int64_t kDefaultTets = 20000;

bool is_static(const Shot& shot) {
  return shot.settings.mode == SimulationMode::Static;
}

/// The tolerance that decides: of balance, or of a step's linear solve.
double& tolerance_of(Shot& shot) {
  const bool balances = is_static(shot) || linearization(shot.solver) == Linearize::Iterated;
  return balances ? shot.solver.force_tolerance : shot.solver.tolerance;
}

bool has_size(const BodySettings& body) {
  return body.tets > 0 || body.edge > 0 || body.error.value > 0 || !body.tetrahedra.empty();
}

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

/// Short runs of one body of a shot; what their meshes and steps say goes nowhere.
class Pilots {
 public:
  Pilots(const Shot& shot, const BodySettings& body, const LoadedBody& loaded, const BodyConstraints& constraints,
         const RunContext& context)
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

  std::optional<Motion> run(const Discretization& cut) {
    quiet_.stop_if_cancelled();
    try {
      const FilledBody& filled = fill(cut.tets);
      Shot shot = shot_;
      shot.solver.substeps = cut.substeps;
      tolerance_of(shot) = cut.tolerance;
      Simulator simulator(make_body_model(shot, body_, loaded_, filled, constraints_), shot.solver, quiet_.threads,
                          quiet_.log, quiet_.times);
      return is_static(shot) ? balance(simulator, filled) : move(simulator, filled);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::Interrupt) throw;
      problem_ = error.what();
      return std::nullopt;
    }
  }

  /// Why the last run that failed did.
  const std::string& problem() const { return problem_; }

 private:
  /// The coarsest mesh is asked for again and again.
  const FilledBody& fill(std::int64_t tets) {
    if (const auto known = fills_.find(tets); known != fills_.end()) return known->second;
    if (fills_.size() > 1) fills_.erase(std::prev(fills_.end()));
    return fills_.emplace(tets, fill_body_anew(at_size(body_, tets), loaded_, quiet_)).first->second;
  }

  static SimulationState rest_of(const TetMesh& mesh) {
    return {mesh.nodes, std::vector<Vec3>(mesh.nodes.size(), Vec3::Zero()),
            std::vector<Quaternion>(mesh.tets.size(), Quaternion::Identity())};
  }

  std::vector<Vec3> points_of(const Simulator& simulator, const FilledBody& filled) const {
    const std::vector<Vec3> all = skin_positions(loaded_.surface.positions, filled.embedding, filled.mesh,
                                                 simulator.state().positions, quiet_.threads);
    std::vector<Vec3> some;
    for (const std::size_t v : points_) some.push_back(all[v]);
    return some;
  }

  void require(bool is_solved, int frame) const {
    if (!is_solved) throw work_error(fmt::format("frame {} could not be solved", frame));
  }

  Motion move(Simulator& simulator, const FilledBody& filled) const {
    simulator.set_state(rest_of(filled.mesh));
    const int start = first_simulated_frame(shot_);
    if (shot_.settings.start == StartState::Equilibrium) require(simulator.find_equilibrium(start).ok(), start);
    Motion motion;
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
  Motion balance(Simulator& simulator, const FilledBody& filled) const {
    const int count = shot_.settings.last_frame - shot_.settings.first_frame + 1;
    const int stride = (count + kMostStaticFrames - 1) / kMostStaticFrames;
    if (auto motion = balance_every(stride, stride, simulator, filled)) return *motion;
    if (auto motion = balance_every(1, stride, simulator, filled)) return *motion;
    throw work_error("an equilibrium could not be found");
  }

  std::optional<Motion> balance_every(int station, int stride, Simulator& simulator, const FilledBody& filled) const {
    simulator.set_state(rest_of(filled.mesh));
    Motion motion;
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

  const Shot& shot_;
  const BodySettings& body_;
  LoadedBody loaded_;
  const BodyConstraints& constraints_;
  const Log no_log_;
  StageTimes no_times_;
  RunContext quiet_;
  std::vector<std::size_t> points_;  ///< vertices that are compared
  std::map<std::int64_t, FilledBody> fills_;
  std::string problem_;
};

Bytes pack(const DialChoice& choice) {
  ByteWriter out;
  out.put(choice.chosen.tets);
  out.put(choice.chosen.substeps);
  out.put(choice.chosen.tolerance);
  for (const double part :
       {choice.believed.mesh, choice.believed.time, choice.believed.algebra, choice.mesh_order, choice.step_order})
    out.put(part);
  out.put(choice.pilots);
  out.put(static_cast<std::uint8_t>(choice.reached));
  return out.take();
}

DialChoice unpack(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  DialChoice choice;
  choice.chosen.tets = in.get<std::int64_t>();
  choice.chosen.substeps = in.get<int>();
  choice.chosen.tolerance = in.get<double>();
  for (double* part :
       {&choice.believed.mesh, &choice.believed.time, &choice.believed.algebra, &choice.mesh_order, &choice.step_order})
    *part = in.get<double>();
  choice.pilots = in.get<int>();
  choice.reached = in.get<std::uint8_t>() != 0;
  return choice;
}

DialRequest request_of(Shot shot, const BodySettings& body, const LoadedBody& loaded, const RunContext& context) {
  DialRequest request;
  request.error = shot.dial.error;
  request.size = used_bounds(loaded.surface).diagonal();
  request.dynamic = !is_static(shot);
  request.given_tets = body.tets;
  if (body.tets == 0 && (has_size(body) || loaded.given))
    request.given_tets =
        static_cast<std::int64_t>(fill_body(body, loaded, filled_key(body, loaded), context).mesh.tets.size());
  request.given_substeps = is_static(shot) ? 1 : shot.solver.substeps;
  request.given_tolerance = tolerance_of(shot);
  request.most_tets = shot.dial.max_tets;
  request.most_substeps = shot.solver.max_substeps;
  return request;
}

/// What is not reached is an error where the dial had all in hand, else what the shot gives is to blame.
void require_reached(const Shot& shot, const BodySettings& body, const BodyDial& dial, const RunContext& context) {
  if (dial.choice.reached) return;
  const bool dial_chose_all = !has_size(body) && (is_static(shot) || shot.solver.substeps == 0);
  const std::string what = fmt::format("{}: solver.error = {:.3g} % is not reached for body \"{}\": {}", shot.path,
                                       100 * dial.asked, body.name, describe(dial, shot));
  if (!dial_chose_all) return context.log.warn(what + ". What the shot gives itself stays.");
  throw input_error(
      fmt::format("{}.\n  Accepted: {:.2g} % and more with solver.max_tets = {} and solver.max_substeps = {}. Raise "
                  "error, or these "
                  "two.",
                  what, 101 * dial.choice.believed.total(), shot.dial.max_tets, shot.solver.max_substeps));
}

}  // namespace

StageKey dial_key(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                  const BodyConstraints& constraints) {
  if (!shot.dial.is_on()) return {};
  KeyHasher materials("materials");
  add_materials(materials, shot, body, loaded.surface);
  Shot looked_at = shot;
  looked_at.solver.substeps = kLooksPerFrame;
  return KeyHasher(kDialVersion)
      .add(simulation_keys(looked_at, constraints, filled_key(body, loaded), materials.key()))
      .add(shot.settings.first_frame)
      .add(shot.dial.error)
      .add(shot.dial.max_tets)
      .add(shot.solver.substeps)
      .add(shot.solver.max_substeps)
      .key();
}

std::optional<BodyDial> stored_dial(const Shot& shot, const StageKey& key, const RunContext& context) {
  const auto stored = context.cache.load(kDialStage, key);
  if (!stored) return std::nullopt;
  return BodyDial{shot.dial.error, unpack(stored->bytes), stored->seconds, true};
}

BodyDial turn_body_dial(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                        const BodyConstraints& constraints, const StageKey& key, const RunContext& context) {
  const auto turn = [&] {
    const ScopedStage stage(context.times, "error dial");
    context.log.info(fmt::format("{}: looking for the mesh and the step of solver.error", body.name));
    Pilots pilots(shot, body, loaded, constraints, context);
    const auto choice =
        turn_dial(request_of(shot, body, loaded, context), [&](const Discretization& cut) { return pilots.run(cut); });
    if (choice) return pack(*choice);
    throw input_error(
        fmt::format("{}: solver.error: no coarse run of body \"{}\" could be made to judge the error by: {}\n  "
                    "Accepted: a shot that can be simulated with solver.max_tets = {} tetrahedra a body. Say tets and "
                    "substeps instead of error.",
                    shot.path, body.name, pilots.problem(), shot.dial.max_tets));
  };
  const Cache::Produced produced = context.cache.produce(
      kDialStage, key, [&] { context.stop_if_cancelled(); }, turn);
  const BodyDial dial{shot.dial.error, unpack(produced.bytes), produced.seconds, produced.from_cache};
  require_reached(shot, body, dial, context);
  return dial;
}

Shot filled_in(Shot shot, std::size_t index, const std::optional<BodyDial>& dial) {
  if (!shot.dial.is_on()) return shot;
  const SolverParams defaults;
  BodySettings& body = shot.bodies[index];
  if (!has_size(body)) body.tets = dial ? dial->choice.chosen.tets : kDefaultTets;
  if (shot.solver.substeps == 0) shot.solver.substeps = dial ? dial->choice.chosen.substeps : defaults.substeps;
  double& tolerance = tolerance_of(shot);
  const bool balances = &tolerance == &shot.solver.force_tolerance;
  if (tolerance == 0)
    tolerance = dial ? dial->choice.chosen.tolerance : balances ? defaults.force_tolerance : defaults.tolerance;
  return shot;
}

std::string describe(const BodyDial& dial, const Shot& shot) {
  const DialChoice& choice = dial.choice;
  const ErrorParts& parts = choice.believed;
  std::string text = fmt::format("error {:.2g} % believed, {:.3g} % asked (mesh {:.2g}", 100 * parts.total(),
                                 100 * dial.asked, 100 * parts.mesh);
  if (!is_static(shot)) text += fmt::format(", time {:.2g}", 100 * parts.time);
  text += fmt::format(", solver {:.1g}) with {} tetrahedra", 100 * parts.algebra, choice.chosen.tets);
  if (!is_static(shot)) text += fmt::format(", {} steps a frame", choice.chosen.substeps);
  return text + fmt::format(", tolerance {:.1g}; {} pilots", choice.chosen.tolerance, choice.pilots);
}

}  // namespace softreel
