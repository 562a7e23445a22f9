#include "tool/stages/shot_run.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/skinning/skinning.h"
#include "tool/bodies/held_ranges.h"
#include "tool/bodies/simulate_key.h"
#include "tool/cache/stage_names.h"
#include "tool/shot/missed_keys.h"
#include "tool/shot/unused_fields.h"
#include "tool/stages/heat_map.h"

namespace softreel {

struct ShotRun::Body {
  LoadedBody loaded;
  StageKey dial_key;
  std::optional<BodyDial> dial;
  Shot resolved;
  std::unique_ptr<BodySimulation> simulation;
  std::vector<ElementMaterial> materials;  ///< per element; empty until heat needs them
};

ShotRun::ShotRun(const Shot& shot, const RunContext& context, DialUse dial) : shot_(shot), context_(context) {
  for (const std::string& line : find_unused_fields(shot)) context.log.warn(line);
  for (const std::string& line : find_missed_keys(shot)) context.log.warn(line);
  for (std::size_t b = 0; b < shot.bodies.size(); ++b) {
    const BodySettings& settings = shot.bodies[b];
    context.stop_if_cancelled();
    auto body = std::make_unique<Body>();
    body->loaded =
        load_body(settings, context, shot.glues, dial == DialUse::Turn ? SurfaceUse::Keep : SurfaceUse::LookUp);
    for (const std::string& fact : body->loaded.facts) context.log.info(settings.name + ": " + fact);
    bodies_.push_back(std::move(body));
  }
  // Selections that take nothing are said before the long work starts.
  std::vector<BodyConstraints> constraints;
  for (std::size_t b = 0; b < shot.bodies.size(); ++b)
    constraints.push_back(resolve_constraints(shot, shot.bodies[b], bodies_[b]->loaded, context.log));
  for (std::size_t b = 0; b < shot.bodies.size(); ++b) resolve(b, std::move(constraints[b]), dial);
  join_glued();
}

namespace {

/// How the pins and pulls of a body are said to hold, and do not.
void warn_of_missed_ranges(const Shot& shot, const BodyConstraints& constraints, const Log& log) {
  const auto warn = [&](const auto& constraint) {
    for (const std::string& line : find_missed_ranges(shot, constraint.name, constraint.active, constraint.grab))
      log.warn(line);
  };
  std::for_each(constraints.pins.begin(), constraints.pins.end(), warn);
  std::for_each(constraints.pulls.begin(), constraints.pulls.end(), warn);
}

}  // namespace

void ShotRun::join_glued() {
  for (std::size_t g = 0; g < shot_.glues.size(); ++g) {
    const GlueSettings& glue = shot_.glues[g];
    const std::string name = fmt::format("glue[{}] ({})", g, to_string(glue.origin));
    for (const std::string& line : find_missed_ranges(shot_, name, glue.active, false)) context_.log.warn(line);
  }
  for (const std::vector<std::size_t>& group : glue_groups(shot_)) {
    std::vector<GlueMember> members;
    for (const std::size_t b : group)
      members.push_back({bodies_[b]->resolved.bodies[b], bodies_[b]->loaded, *bodies_[b]->simulation});
    groups_.push_back(std::make_unique<GlueGroup>(shot_, std::move(members), context_));
  }
}

/// Chooses what the shot leaves open for a body; then all its keys are known.
void ShotRun::resolve(std::size_t index, BodyConstraints constraints, DialUse use) {
  Body& body = *bodies_[index];
  const BodySettings& asked = shot_.bodies[index];
  if (shot_.dial.is_on()) {
    body.dial_key = softreel::dial_key(shot_, asked, body.loaded, constraints);
    body.dial = use == DialUse::Turn ? turn_body_dial(shot_, asked, body.loaded, constraints, body.dial_key, context_)
                                     : stored_dial(shot_, body.dial_key, context_);
  }
  body.resolved = filled_in(shot_, index, body.dial);
  warn_of_missed_ranges(body.resolved, constraints, context_.log);
  body.simulation = std::make_unique<BodySimulation>(body.resolved, body.resolved.bodies[index], body.loaded,
                                                     std::move(constraints), context_);
}

const Shot& ShotRun::resolved(std::size_t body) const {
  return bodies_[body]->resolved;
}

const std::optional<BodyDial>& ShotRun::dial(std::size_t body) const {
  return bodies_[body]->dial;
}

const StageKey& ShotRun::dial_key(std::size_t body) const {
  return bodies_[body]->dial_key;
}

ShotRun::~ShotRun() = default;

const LoadedBody& ShotRun::loaded(std::size_t body) const {
  return bodies_[body]->loaded;
}

const BodySimulation& ShotRun::simulation(std::size_t body) const {
  return *bodies_[body]->simulation;
}

const FilledBody* ShotRun::filled(std::size_t body) const {
  BodySimulation& simulation = *bodies_[body]->simulation;
  return simulation.is_filled() ? &simulation.filled() : nullptr;
}

StageKey ShotRun::surfaces_key(int frame, const SkinRequest& request) const {
  KeyHasher key("surfaces 2");
  const bool blurred = request.shutter > 0;
  key.add(request.normals).add(request.shutter).add(blurred ? request.segments : 0);
  if (request.heat != HeatQuantity::None) key.add("heat 1").add(request.heat);
  if (request.strain) key.add("strain 1");
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto& body = bodies_[b];
    key.add(body->loaded.key).add(body->simulation->filled_key()).add(body->simulation->frame_key(frame));
    if (request.creases && settings(b).has_creases()) key.add("creases 1").add(settings(b).crease_deg);
    const bool at_end = frame == shot_.settings.last_frame;
    if ((blurred || (request.next && at_end)) && frame > first_simulated_frame(shot_))
      key.add(body->simulation->frame_key(frame - 1));
    if (request.next) key.add("next");
    if (request.next && !at_end) key.add(body->simulation->frame_key(frame + 1));
  }
  return key.key();
}

std::vector<CacheItem> ShotRun::items(int first, int last) const {
  std::vector<CacheItem> items;
  for (const auto& body : bodies_) {
    if (!body->loaded.stored_key.empty()) items.push_back(cache_item(kSurfaceStage, body->loaded.stored_key));
    if (shot_.dial.is_on()) items.push_back(cache_item(kDialStage, body->dial_key));
    items.push_back(cache_item(kTetrahedraStage, body->simulation->filled_key()));
    for (int frame = first; frame <= last; ++frame)
      items.push_back(cache_item(kSimulationStage, body->simulation->frame_key(frame)));
  }
  return items;
}

void ShotRun::simulate(int frame) {
  for (const auto& body : bodies_) body->simulation->at(frame);
}

SimulationCounts ShotRun::counts(int last) const {
  SimulationCounts sum;
  for (const auto& body : bodies_) {
    const SimulationCounts counts = body->simulation->counts(last);
    sum.computed += counts.computed;
    sum.loaded += counts.loaded;
    sum.not_needed += counts.not_needed;
    sum.work += counts.work;
    sum.saved_seconds += counts.saved_seconds;
    sum.recoveries.insert(sum.recoveries.end(), counts.recoveries.begin(), counts.recoveries.end());
  }
  return sum;
}

StageKey ShotRun::all_frames_key() const {
  KeyHasher key("all frames 1");
  for (const auto& body : bodies_) {
    key.add(body->loaded.key).add(body->simulation->filled_key());
    for (int frame = shot_.settings.first_frame; frame <= shot_.settings.last_frame; ++frame)
      key.add(body->simulation->frame_key(frame));
  }
  return key.key();
}

HeatSource ShotRun::heat_source(Body& body, std::size_t index, int frame) {
  const std::vector<Vec3>& nodes = body.simulation->at(frame).state.positions;
  const FilledBody& filled = body.simulation->filled();
  if (body.materials.empty()) body.materials = element_materials(shot_, settings(index), body.loaded, filled.mesh);
  return {body.loaded.surface.positions, filled, body.materials, nodes};
}

std::vector<double> ShotRun::heat(std::size_t index, int frame, HeatQuantity quantity) {
  const HeatSource source = heat_source(*bodies_[index], index, frame);
  const ScopedStage stage(context_.times, "heat");
  return heat_values(quantity, source, context_.threads);
}

std::vector<double> ShotRun::element_heat(std::size_t index, int frame, HeatQuantity quantity) {
  const HeatSource source = heat_source(*bodies_[index], index, frame);
  const ScopedStage stage(context_.times, "heat");
  return element_heat_values(quantity, source, context_.threads);
}

std::vector<Vec3> positions_between(const std::vector<const std::vector<Vec3>*>& steps, double time) {
  const auto intervals = static_cast<double>(steps.size() - 1);
  const double place = std::clamp((1 + time) * intervals, 0.0, intervals);
  const auto first = static_cast<std::size_t>(std::min(std::floor(place), std::max(0.0, intervals - 1)));
  const double share = place - static_cast<double>(first);
  if (share == 0 || steps.size() == 1) return *steps[first];
  const std::vector<Vec3>&a = *steps[first], &b = *steps[first + 1];
  std::vector<Vec3> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = share == 1 ? b[i] : Vec3(a[i] + share * (b[i] - a[i]));
  return result;
}

/// Of the tetrahedra a frame earlier; empty if there is none or nothing asks for it.
std::vector<Vec3> ShotRun::previous_nodes(Body& body, int frame, const SkinRequest& request) const {
  const bool at_end = frame == shot_.settings.last_frame;
  if (!(request.shutter > 0 || (request.next && at_end)) || frame == first_simulated_frame(shot_)) return {};
  return body.simulation->at(frame - 1).state.positions;
}

void ShotRun::skin_times(Body& body, int frame, const SkinRequest& request, const std::vector<Vec3>& previous,
                         const TakeSkin& take) const {
  const BodyFrame& state = body.simulation->at(frame);
  const FilledBody& filled = body.simulation->filled();
  std::vector<const std::vector<Vec3>*> steps;
  if (!previous.empty()) steps.push_back(&previous);
  for (const auto& step : state.earlier_steps) steps.push_back(&step);
  steps.push_back(&state.state.positions);
  const bool blurred = request.shutter > 0 && steps.size() > 1;
  const int segments = blurred ? request.segments : 0;
  for (int k = 0; k <= segments; ++k) {
    SkinnedBody::Time at;
    {
      const ScopedStage stage(context_.times, "skin");
      const double time = segments == 0 ? 0.0 : request.shutter * (static_cast<double>(k) / segments - 1);
      std::vector<Vec3> nodes = positions_between(steps, time);
      at.positions =
          skin_positions(body.loaded.surface.positions, filled.embedding, filled.mesh, nodes, context_.threads);
      if (request.normals) {
        const bool hard = request.creases && !filled.creases.empty();
        at.normals = skin_normals(hard ? filled.creases.normals : filled.normals, filled.embedding, filled.mesh, nodes,
                                  context_.threads, hard ? filled.creases.vertex_of : std::span<const Index>{});
      }
      if (request.nodes) at.nodes = std::move(nodes);
    }
    take(std::move(at));
  }
}

void ShotRun::skin_times(std::size_t index, int frame, const SkinRequest& request, const TakeSkin& take) {
  Body& body = *bodies_[index];
  skin_times(body, frame, request, previous_nodes(body, frame, request), take);
}

SkinnedBody ShotRun::skin_body(std::size_t index, int frame, const SkinRequest& request) {
  Body& body = *bodies_[index];
  const std::vector<Vec3> previous = previous_nodes(body, frame, request);
  SkinnedBody skinned;
  skinned.pull_grabs = body.simulation->at(frame).state.grabs.pulls;
  skin_times(body, frame, request, previous, [&](SkinnedBody::Time at) { skinned.times.push_back(std::move(at)); });
  if (request.next) skinned.next_positions = next_positions(body, frame, skinned.times.back().positions, previous);
  return skinned;
}

/// positions: of the surface at the frame; previous_nodes: of the tetrahedra a frame earlier, empty if there is none.
std::vector<Vec3> ShotRun::next_positions(Body& body, int frame, const std::vector<Vec3>& positions,
                                          const std::vector<Vec3>& previous_nodes) {
  const FilledBody& filled = body.simulation->filled();
  const auto skinned = [&](const std::vector<Vec3>& nodes) {
    return skin_positions(body.loaded.surface.positions, filled.embedding, filled.mesh, nodes, context_.threads);
  };
  if (frame < shot_.settings.last_frame) return skinned(body.simulation->at(frame + 1).state.positions);
  std::vector<Vec3> next = positions;
  if (previous_nodes.empty()) return next;
  const std::vector<Vec3> previous = skinned(previous_nodes);
  for (std::size_t v = 0; v < next.size(); ++v) next[v] += positions[v] - previous[v];
  return next;
}

std::vector<SkinnedBody> ShotRun::skin(int frame, const SkinRequest& request) {
  std::vector<SkinnedBody> skinned;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    skinned.push_back(skin_body(b, frame, request));
    if (request.heat != HeatQuantity::None) skinned.back().heat = heat(b, frame, request.heat);
    if (request.strain) skinned.back().strain = heat(b, frame, HeatQuantity::Strain);
  }
  return skinned;
}

}  // namespace softreel
