#include "tool/bodies/glue_stage.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "core/base/check.h"
#include "tool/bodies/at_field.h"
#include "tool/bodies/simulate_key.h"

namespace softreel {
namespace {

/// Raised whenever the same glued bodies would give other frames.
constexpr const char* kGlueVersion = "glued bodies 2";

bool can_stick(const GlueSettings& glue) {
  const auto& keys = glue.stiffness.keys;
  return keys.empty() || std::any_of(keys.begin(), keys.end(), [](const Key<double>& key) { return key.value > 0; });
}

std::size_t index_of(const std::vector<BodySettings>& bodies, const std::string& name) {
  const auto found =
      std::find_if(bodies.begin(), bodies.end(), [&name](const BodySettings& body) { return body.name == name; });
  CHECK(found != bodies.end());  // the shot was checked when it was read
  return static_cast<std::size_t>(found - bodies.begin());
}

StageKey materials_key(const Shot& shot, const GlueMember& member) {
  KeyHasher key("materials");
  add_materials(key, shot, member.settings, member.loaded);
  return key.key();
}

Triangle shifted(Triangle triangle, Index by) {
  for (Index& vertex : triangle) vertex += by;
  return triangle;
}

/// Of one member's pins or pulls; empty where nothing grabs.
std::vector<Grab> grabs_of(const std::vector<Grab>& all, std::size_t first, std::size_t count) {
  if (all.empty()) return {};
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

/// What the keys of frames see of glue.
Glue timed(const GlueSettings& settings) {
  Glue glue;
  glue.stiffness = settings.stiffness;
  glue.close_frames = settings.close;
  glue.active = settings.active;
  return glue;
}

}  // namespace

std::vector<std::vector<std::size_t>> glue_groups(const Shot& shot) {
  std::vector<std::size_t> group(shot.bodies.size());
  std::iota(group.begin(), group.end(), 0);
  for (const GlueSettings& glue : shot.glues) {
    if (!can_stick(glue)) continue;
    const std::size_t a = group[index_of(shot.bodies, glue.bodies[0])];
    const std::size_t b = group[index_of(shot.bodies, glue.bodies[1])];
    std::replace(group.begin(), group.end(), std::max(a, b), std::min(a, b));
  }
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t first = 0; first < group.size(); ++first) {
    std::vector<std::size_t> members;
    for (std::size_t b = 0; b < group.size(); ++b)
      if (group[b] == first) members.push_back(b);
    if (members.size() > 1) groups.push_back(std::move(members));
  }
  return groups;
}

GlueGroup::GlueGroup(const Shot& shot, std::vector<GlueMember> members, const RunContext& context)
    : shot_(shot), context_(context), members_(std::move(members)) {
  const auto member_of = [&](const std::string& name) {
    const auto found = std::find_if(members_.begin(), members_.end(),
                                    [&name](const GlueMember& member) { return member.settings.name == name; });
    return static_cast<std::size_t>(found - members_.begin());
  };
  for (std::size_t g = 0; g < shot.glues.size(); ++g) {
    const GlueSettings& glue = shot.glues[g];
    const std::size_t first = member_of(glue.bodies[0]);
    if (first == members_.size() || !can_stick(glue)) continue;
    const std::string field = fmt::format("glue[{}]", g);
    joints_.push_back({glue, field, fmt::format("{} ({})", field, to_string(glue.origin)), first,
                       member_of(glue.bodies[1]),
                       select_or_fail(glue.select, members_[first].loaded, glue.origin, field)});
  }
  for (const GlueMember& member : members_)
    settings_.name += (settings_.name.empty() ? "" : " + ") + member.settings.name;
  settings_.rotation = members_.front().settings.rotation;
  BodyConstraints constraints = join_constraints();
  SimulationSource source{{},
                          chain_keys(shot, constraints, base_key()),
                          [this] { return join_filled(); },
                          [this](const FilledBody&, const BodyConstraints&) { return make_model(); }};
  joined_ = std::make_unique<BodySimulation>(shot, settings_, std::move(source), std::move(constraints), context);
  for (std::size_t m = 0; m < members_.size(); ++m) members_[m].simulation.join(*this, m);
}

/// As far as keys and unchanged frames ask: which points constraints hold is in the base key.
BodyConstraints GlueGroup::join_constraints() const {
  BodyConstraints joined;
  for (const GlueMember& member : members_) {
    const BodyConstraints& own = member.simulation.constraints();
    joined.pins.insert(joined.pins.end(), own.pins.begin(), own.pins.end());
    joined.pulls.insert(joined.pulls.end(), own.pulls.begin(), own.pulls.end());
  }
  for (const Joint& joint : joints_) joined.glues.push_back(timed(joint.settings));
  return joined;
}

StageKey GlueGroup::base_key() const {
  KeyHasher key(kGlueVersion);
  for (const GlueMember& member : members_)
    key.add(simulation_base_key(shot_, solver_of(shot_, member.settings), member.simulation.constraints(),
                                member.simulation.filled_key(), materials_key(shot_, member)));
  for (const Joint& joint : joints_)
    key.add(joint.first)
        .add(joint.second)
        .add(joint.points)
        .add(joint.settings.distance)
        .add(joint.settings.close)
        .add(joint.settings.max_force)
        .add(joint.settings.stiffness.keys.empty());
  return key.key();
}

std::vector<BodyModel> GlueGroup::make_models() const {
  std::vector<BodyModel> models;
  for (const GlueMember& member : members_) {
    require_regions(member.settings, member.loaded, member.simulation.filled().mesh);
    models.push_back(make_body_model(shot_, member.settings, member.loaded, member.simulation.filled(),
                                     member.simulation.constraints()));
  }
  return models;
}

FilledBody GlueGroup::join_filled() const {
  FilledBody filled;
  filled.mesh = join_models(make_models()).mesh;
  return filled;
}

Glue GlueGroup::make_glue(const Joint& joint, const std::vector<ModelOffsets>& offsets) const {
  const GlueMember &first = members_[joint.first], &second = members_[joint.second];
  const FilledBody &body = first.simulation.filled(), &other = second.simulation.filled();
  const ModelOffsets &from = offsets[joint.first], &onto = offsets[joint.second];
  Glue glue = timed(joint.settings);
  glue.name = joint.name;
  glue.body = first.settings.name;
  glue.other = second.settings.name;
  glue.points = at_field(joint.settings.origin, joint.field, [&] {
    return make_glue_points(first.loaded.surface.positions, first.loaded.surface.triangles, joint.points, body.mesh,
                            body.embedding, std::min(spacing_of(body.mesh), spacing_of(other.mesh)));
  });
  for (GluePoint& point : glue.points) point.element += from.tet;
  for (const Triangle& triangle : second.loaded.surface.triangles)
    glue.triangles.push_back(shifted(triangle, onto.point));
  glue.elements = {onto.tet, onto.tet + static_cast<Index>(other.mesh.tets.size())};
  glue.distance = joint.settings.distance;
  glue.max_force = joint.settings.max_force;
  return glue;
}

BodyModel GlueGroup::make_model() const {
  const std::vector<BodyModel> models = make_models();
  BodyModel joined = join_models(models);
  const std::vector<ModelOffsets> offsets = find_offsets(models);
  for (const Joint& joint : joints_) joined.glues.push_back(make_glue(joint, offsets));
  return joined;
}

GlueGroup::SplitFrame GlueGroup::split(int frame) const {
  context_.stop_if_cancelled();
  const BodyFrame& whole = joined_->at(frame);
  SplitFrame result{frame, {}};
  ModelOffsets from;
  std::size_t first_pin = 0, first_pull = 0;
  for (const GlueMember& member : members_) {
    const TetMesh& mesh = member.simulation.filled().mesh;
    BodyFrame& part = result.members.emplace_back();
    part.state = part_of(whole.state, from, mesh.nodes.size(), mesh.tets.size());
    const BodyConstraints& constraints = member.simulation.constraints();
    part.state.grabs.pins = grabs_of(whole.state.grabs.pins, first_pin, constraints.pins.size());
    part.state.grabs.pulls = grabs_of(whole.state.grabs.pulls, first_pull, constraints.pulls.size());
    first_pin += constraints.pins.size();
    first_pull += constraints.pulls.size();
    for (const std::vector<Vec3>& step : whole.earlier_steps) {
      const auto begin = step.begin() + from.node;
      part.earlier_steps.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(mesh.nodes.size()));
    }
    from.node += static_cast<Index>(mesh.nodes.size());
    from.tet += static_cast<Index>(mesh.tets.size());
  }
  result.members.front().work = whole.work;
  result.members.front().recovering_elements = whole.recovering_elements;
  return result;
}

const BodyFrame& GlueGroup::at(std::size_t member, int frame) {
  auto found =
      std::find_if(recent_.begin(), recent_.end(), [frame](const SplitFrame& split) { return split.frame == frame; });
  if (found == recent_.end()) {
    recent_.push_back(split(frame));
    if (recent_.size() > kKeptFrames) recent_.pop_front();
    found = recent_.end() - 1;
  }
  return found->members[member];
}

}  // namespace softreel
