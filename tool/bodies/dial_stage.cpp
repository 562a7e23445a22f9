#include "tool/bodies/dial_stage.h"

#include <algorithm>

#include <fmt/format.h>

#include "tool/bodies/dial_pilots.h"
#include "tool/bodies/simulate_key.h"
#include "tool/cache/bytes.h"
#include "tool/cache/stage_names.h"

namespace softreel {
namespace {

/// Raised whenever the same inputs would give another choice.
constexpr const char* kDialVersion = "dial 4";

/// Constraints are looked at so many times a frame for the key, whatever step is chosen.
constexpr int kLooksPerFrame = 16;

/// Where forces must balance; Newton's next iteration would mostly be far below it.
constexpr double kLoosestForceTolerance = 1e-4;

/// What cancels is said from this share of the error on.
constexpr double kTold = 0.02;

bool has_size(const BodySettings& body) {
  return body.tets > 0 || body.edge > 0 || body.error.value > 0 || !body.tetrahedra.empty();
}

Bytes pack(const DialChoice& choice) {
  ByteWriter out;
  out.put(choice.chosen.tets);
  out.put(choice.chosen.substeps);
  out.put(choice.chosen.tolerance);
  for (const double part : {choice.believed.mesh, choice.believed.time, choice.believed.algebra,
                            choice.believed.cancelled, choice.mesh_order, choice.step_order})
    out.put(part);
  out.put(choice.pilots);
  out.put(choice.finest_pilot);
  out.put(choice.pilot_share);
  out.put(static_cast<std::uint8_t>(choice.reached));
  return out.take();
}

DialChoice unpack(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  DialChoice choice;
  choice.chosen.tets = in.get<std::int64_t>();
  choice.chosen.substeps = in.get<int>();
  choice.chosen.tolerance = in.get<double>();
  for (double* part : {&choice.believed.mesh, &choice.believed.time, &choice.believed.algebra,
                       &choice.believed.cancelled, &choice.mesh_order, &choice.step_order})
    *part = in.get<double>();
  choice.pilots = in.get<int>();
  choice.finest_pilot = in.get<std::int64_t>();
  choice.pilot_share = in.get<double>();
  choice.reached = in.get<std::uint8_t>() != 0;
  return choice;
}

/// What is not reached is an error where the dial had all in hand, else what the shot gives is to blame.
void require_reached(const Shot& shot, const BodySettings& body, const LoadedBody& loaded, const BodyDial& dial,
                     const RunContext& context) {
  if (dial.choice.reached) return;
  const bool dial_chose_all = !has_size(body) && !loaded.given && (is_static(shot) || shot.solver.substeps == 0);
  const std::string what = fmt::format("{}: solver.error = {:.3g} % is not reached for body \"{}\": {}", shot.path,
                                       100 * dial.asked, body.name, describe(dial, shot));
  if (!dial_chose_all) return context.log.warn(what + ". What the shot gives itself stays.");
  throw input_error(
      fmt::format("{}.\n  Accepted: {:.1f} % and more with solver.max_tets = {} and solver.max_substeps = {}. Raise "
                  "error, or these "
                  "two.",
                  what, std::ceil(1000 * attainable_error(dial.choice.believed)) / 10, shot.dial.max_tets,
                  shot.solver.max_substeps));
}

}  // namespace

DialRequest dial_request(Shot shot, const BodySettings& body, const LoadedBody& loaded, const RunContext& context) {
  DialRequest request;
  request.error = shot.dial.error;
  request.size = used_bounds(loaded.surface).diagonal();
  request.dynamic = !is_static(shot);
  request.given_tets = loaded.given ? 0 : body.tets;  // given tetrahedra are as many as they are
  if (request.given_tets == 0 && (has_size(body) || loaded.given))
    request.given_tets =
        static_cast<std::int64_t>(fill_body(body, loaded, filled_key(body, loaded), context).mesh.tets.size());
  request.given_substeps = is_static(shot) ? 1 : shot.solver.substeps;
  request.given_tolerance = tolerance_of(shot);
  if (&tolerance_of(shot) == &shot.solver.force_tolerance) request.loosest_tolerance = kLoosestForceTolerance;
  request.most_tets = shot.dial.max_tets;
  request.most_substeps = shot.solver.max_substeps;
  return request;
}

StageKey dial_key(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                  const BodyConstraints& constraints) {
  if (!shot.dial.is_on()) return {};
  KeyHasher materials("materials");
  add_materials(materials, shot, body, loaded);
  Shot looked_at = shot;
  looked_at.solver.substeps = kLooksPerFrame;
  return KeyHasher(kDialVersion)
      .add(simulation_keys(looked_at, solver_of(looked_at, body), constraints, filled_key(body, loaded),
                           materials.key()))
      .add(shot.settings.first_frame)
      .add(body.mode)
      .add(body.graded)
      .add(body.thickness)
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
    DialPilots pilots(shot, body, loaded, constraints, context);
    const auto choice = turn_dial(dial_request(shot, body, loaded, context),
                                  [&](const Discretization& cut) { return pilots.run(cut); });
    if (choice) return pack(*choice);
    throw input_error(
        fmt::format("{}: solver.error: no coarse run of body \"{}\" could be made to judge the error by: {}\n  "
                    "Accepted: a shot that can be simulated with solver.max_tets = {} tetrahedra a body. Say tets and "
                    "substeps instead of error.",
                    shot.path, body.name,
                    pilots.problem().empty() ? "solver.max_substeps leaves no two steps to compare" : pilots.problem(),
                    shot.dial.max_tets));
  };
  const Cache::Produced produced = context.cache.produce(
      kDialStage, key, [&] { context.stop_if_cancelled(); }, turn);
  const BodyDial dial{shot.dial.error, unpack(produced.bytes), produced.seconds, produced.from_cache};
  require_reached(shot, body, loaded, dial, context);
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
  if (parts.cancelled > kTold * parts.total()) text += fmt::format(", of which {:.2g} cancel", 100 * parts.cancelled);
  text += fmt::format(", solver {:.1g}) with {} tetrahedra", 100 * parts.algebra, choice.chosen.tets);
  if (!is_static(shot)) text += fmt::format(", {} steps a frame", choice.chosen.substeps);
  text += fmt::format(", tolerance {:.1g}; from {} pilots of up to {} tetrahedra, order {:.2g} of the mesh",
                      choice.chosen.tolerance, choice.pilots, choice.finest_pilot, choice.mesh_order);
  if (!is_static(shot)) text += fmt::format(" and {:.2g} of the steps", choice.step_order);
  return text;
}

}  // namespace softreel
