#include "core/dynamics/simulator.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/dynamics/simulator_parts.h"

namespace softreel {
namespace {

/// Glue of 1e4 times the stiffness of firm glue took ten times the iterations on one bar; other solves ended there.
constexpr double kStiffGlue = 1e3;

/// Pulls of 1e20 times the stiffness of a bar were solved in its equilibria; one of 1e25 times was not.
constexpr double kStiffPull = 1e18;

/// Diagonal of the box around the nodes, m.
double box_diagonal(const std::vector<Vec3>& nodes) {
  Vec3 low = nodes.front(), high = low;
  for (const Vec3& node : nodes) {
    low = low.cwiseMin(node);
    high = high.cwiseMax(node);
  }
  return (high - low).norm();
}

/// Checks what the simulator divides by, and returns the model.
BodyModel checked(BodyModel model) {
  const TetMesh& mesh = model.mesh;
  CHECK(model.materials.size() == mesh.tets.size());
  CHECK(model.embedding.elements.size() == model.surface_points.size());
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const TetNodes rest = nodes_of(mesh.tets[e], mesh.nodes);
    const double volume = tet_volume(rest[0], rest[1], rest[2], rest[3]);
    if (volume > 0) continue;
    throw input_error(
        fmt::format("{}: tetrahedron {} has volume {} m^3 at rest.\n  Accepted: above 0. Orient its nodes so that "
                    "det[X1-X0, X2-X0, X3-X0] > 0, or remove it if it is flat.",
                    model.name, e, volume));
  }
  return model;
}

MultigridParams with_poisson_ratio(MultigridParams params, const std::vector<ElementMaterial>& materials) {
  for (const ElementMaterial& material : materials)
    params.poisson_ratio = std::max(params.poisson_ratio, material.poisson_ratio);
  return params;
}

}  // namespace

std::vector<double> youngs_moduli(const std::vector<ElementMaterial>& materials) {
  std::vector<double> moduli;
  moduli.reserve(materials.size());
  for (const ElementMaterial& material : materials) moduli.push_back(material.youngs_modulus);
  return moduli;
}

Simulator::Parts::Parts(BodyModel body_model, const SolverParams& solver_params, const Threads& its_threads,
                        const Log& its_log, StageTimes& its_times)
    : model(checked(std::move(body_model))),
      params(solver_params),
      threads(its_threads),
      log(its_log),
      times(its_times),
      body(make_elastic_body(model.mesh, model.materials, params.dilatation)),
      masses(lump_masses(model.mesh, model.materials)),
      pins(model.pins, model.embedding, model.mesh),
      pieces(find_pieces(model.mesh.tets, model.mesh.nodes.size())),
      matrix{stiffness_pattern(model.mesh.tets, static_cast<Index>(model.mesh.nodes.size())), {}},
      multigrid(model.mesh, youngs_moduli(model.materials), matrix.pattern,
                with_poisson_ratio(params.multigrid, model.materials), threads),
      body_size(box_diagonal(model.mesh.nodes)) {
  CHECK(params.newmark.is_stable());
  if (const std::string conflict = pins.find_conflict(); !conflict.empty()) throw input_error(conflict);
  damping_stiffness.reserve(model.materials.size());
  for (const ElementMaterial& material : model.materials) damping_stiffness.push_back(material.damping_stiffness);
  state.positions = model.mesh.nodes;
  state.velocities.assign(model.mesh.nodes.size(), Vec3::Zero());
  state.rotations.assign(model.mesh.tets.size(), Quaternion::Identity());
}

const StiffnessAssembler& Simulator::Parts::assembler() {
  if (!assembler_in_double) assembler_in_double.emplace(model.mesh.tets, matrix.pattern);
  return *assembler_in_double;
}

const FloatAssembler& Simulator::Parts::float_assembler() {
  if (!assembler_in_float)
    assembler_in_float.emplace(model.mesh.tets, body.node_elements, multigrid.float_matrix().pattern,
                               multigrid.row_of_node());
  return *assembler_in_float;
}

std::vector<ActivePull> Simulator::Parts::pulls_at(double frame, const Grabs& grabs,
                                                   const std::vector<GlueBond>& bonds) const {
  std::vector<ActivePull> pulls =
      active_pulls(model.pulls, model.surface_points, model.embedding, model.mesh, frame, grabs.pulls);
  for (std::size_t g = 0; g < model.glues.size(); ++g)
    if (const auto own = bonds_of(bonds, static_cast<std::int64_t>(g)); !own.empty())
      pulls.push_back(glue_springs(model.glues[g], own, model.mesh, frame));
  return pulls;
}

void Simulator::Parts::gather_all_forces(std::span<const Vec3> positions, const std::vector<ActivePull>& pulls,
                                         std::span<Vec3> forces) const {
  gather_forces(body, stresses, forces, threads);
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] += masses.mass[i] * model.gravity;
  for (const ActivePull& pull : pulls) add_pull_forces(pull, positions, forces);
}

std::vector<std::uint8_t> Simulator::Parts::held_pieces(const PinnedNodes& pinned,
                                                        const std::vector<ActivePull>& pulls) const {
  std::vector<std::uint8_t> held(static_cast<std::size_t>(pieces.count), 0);
  const auto hold = [&](std::size_t node) { held[static_cast<std::size_t>(pieces.of_node[node])] = 1; };
  for (std::size_t i = 0; i < nodes(); ++i)
    if (pinned.held[i] != 0) hold(i);
  for (const ActivePull& pull : pulls)
    for (const Spring& spring : pull.springs)
      if (!spring.joins_material() && spring.stiffness > 0) hold(static_cast<std::size_t>(spring.nodes[0]));
  return held;
}

std::vector<GlueBond> Simulator::Parts::bonds_at(double frame) const {
  const GluedMesh glued{model.mesh, body.node_elements, model.materials, model.surface_points, model.embedding};
  std::vector<GlueBond> bonds;
  for (std::size_t g = 0; g < model.glues.size(); ++g) {
    if (!is_sticking(model.glues[g], frame)) continue;
    const auto number = static_cast<std::int64_t>(g);
    const std::span<const GlueBond> known = bonds_that_hold(state.bonds, model.glues[g], number, frame);
    bonds.insert(bonds.end(), known.begin(), known.end());
    if (!known.empty()) continue;
    const std::vector<GlueBond> made = bind_glue(model.glues[g], number, glued, state.positions, frame);
    log.info(fmt::format("{}: sticks at {} points from frame {:g} on", model.glues[g].name, made.size(), frame));
    bonds.insert(bonds.end(), made.begin(), made.end());
  }
  return bonds;
}

void Simulator::Parts::join(const std::vector<GlueBond>& bonds) {
  std::vector<Joint> needed = find_joints(model.glues, bonds);
  if (needed == joints) return;
  joints = std::move(needed);
  unjoined_pieces = find_pieces(model.mesh.tets, nodes());
  pieces = join_pieces(unjoined_pieces, model.mesh.tets, joints);
  if (joints.empty()) unjoined_pieces = {};
  matrix = {join_pattern(stiffness_pattern(model.mesh.tets, static_cast<Index>(nodes())), model.mesh.tets, joints), {}};
  multigrid = Multigrid(model.mesh, youngs_moduli(model.materials), matrix.pattern,
                        with_poisson_ratio(params.multigrid, model.materials), threads);
  assembler_in_double.reset();
  assembler_in_float.reset();
  coarse_lag.usable = false;
  known_rest.known = false;
}

std::string Simulator::Parts::find_boundless_pull(double frame, std::span<const Vec3> positions) const {
  for (std::size_t p = 0; p < model.pulls.size(); ++p) {
    const Pull& pull = model.pulls[p];
    const Grab grab = p < state.grabs.pulls.size() ? state.grabs.pulls[p] : Grab{};
    std::vector<Vec3> forces(positions.size(), Vec3::Zero());
    for (const ActivePull& active :
         active_pulls({pull}, model.surface_points, model.embedding, model.mesh, frame, {&grab, 1}))
      add_pull_forces(active, positions, forces);
    double square = 0;
    for (const Vec3& force : forces) square += force.squaredNorm();
    if (!std::isfinite(square))
      return fmt::format("{}: with a stiffness of {:g} N/m its force is not finite", pull.name,
                         pull.stiffness.at(frame));
  }
  return {};
}

std::string Simulator::Parts::find_stiff_glue(double frame) const {
  const GluedMesh glued{model.mesh, body.node_elements, model.materials, model.surface_points, model.embedding};
  for (std::size_t g = 0; g < model.glues.size(); ++g) {
    const Glue& glue = model.glues[g];
    if (glue.stiffness.keys.empty() || !is_sticking(glue, frame)) continue;
    const auto number = static_cast<std::int64_t>(g);
    const std::span<const GlueBond> known = bonds_that_hold(state.bonds, glue, number, frame);
    const std::vector<GlueBond> made =
        known.empty() ? bind_glue(glue, number, glued, state.positions, frame) : std::vector<GlueBond>{};
    double firm = 0;
    for (const GlueBond& bond : known.empty() ? std::span<const GlueBond>(made) : known) firm += bond.firmness;
    const double stiffness = glue.stiffness.at(frame);
    if (stiffness > kStiffGlue * firm)
      return fmt::format(
          "{}: its stiffness of {:g} N/m is {:.2g} times that of firm glue, {:.2g} N/m, which leaving "
          "stiffness out gives",
          glue.name, stiffness, stiffness / firm, firm);
  }
  return {};
}

namespace {

/// Names the first pull active at `frame` that is so stiff that its rounding drowns all other forces; empty if there is
/// none.
std::string find_stiff_pull(const Simulator::Parts& parts, double frame) {
  double hardest = 0;
  for (const ElementMaterial& material : parts.model.materials) hardest = std::max(hardest, material.youngs_modulus);
  for (const Pull& pull : parts.model.pulls) {
    const double stiffness = pull.stiffness.at(frame), own = hardest * parts.body_size;
    if (is_active(pull.active, frame) && stiffness > kStiffPull * own)
      return fmt::format("{}: its stiffness of {:g} N/m is {:.2g} times that of the body, about {:.2g} N/m", pull.name,
                         stiffness, stiffness / own, own);
  }
  return {};
}

}  // namespace

std::string Simulator::Parts::describe_element(std::size_t element) const {
  const TetNodes rest = nodes_of(body.tets[element], body.rest_positions);
  const Vec3 center = 0.25 * (rest[0] + rest[1] + rest[2] + rest[3]);
  const auto number = static_cast<Index>(element);
  const BodyPart* part = nullptr;
  for (const BodyPart& one : model.parts)
    if (one.first_tet <= number) part = &one;
  return fmt::format("{}: element {} with rest centroid ({:.6g}, {:.6g}, {:.6g})", part ? part->name : model.name,
                     part ? number - part->first_tet : number, center.x(), center.y(), center.z());
}

std::string Simulator::Parts::find_culprit(double frame, std::span<const Vec3> positions,
                                           std::span<const Vec3> blame) const {
  const auto blamed = [&](std::size_t e, const char* what) { return describe_element(e) + " " + what; };
  for (std::size_t e = 0; e < body.tets.size(); ++e) {
    const Mat3 F = deformation_gradient(body.shapes[e].gradients, nodes_of(body.tets[e], positions));
    if (!F.allFinite()) return blamed(e, "has a shape that is not finite");
    if (!std::isfinite(F.squaredNorm())) return blamed(e, "has a force that is not finite");
  }
  if (std::string pull = find_boundless_pull(frame, positions); !pull.empty()) return pull;
  if (std::string pull = find_stiff_pull(*this, frame); !pull.empty()) return pull;
  if (std::string glue = find_stiff_glue(frame); !glue.empty()) return glue;
  std::size_t worst = 0;
  double greatest = -1;
  for (std::size_t e = 0; e < body.tets.size(); ++e) {
    double size = 0;
    for (const Index node : body.tets[e]) {
      const double norm = blame[static_cast<std::size_t>(node)].norm();
      if (!std::isfinite(norm)) return blamed(e, "has a force that is not finite");
      size += norm;
    }
    if (size > greatest) {
      greatest = size;
      worst = e;
    }
  }
  return blamed(worst, "has the greatest unbalanced force");
}

Simulator::Simulator(BodyModel model, const SolverParams& params, const Threads& threads, const Log& log,
                     StageTimes& times)
    : parts_(std::make_unique<Parts>(std::move(model), params, threads, log, times)) {}

bool Simulator::Parts::damps_strain() const {
  return std::any_of(damping_stiffness.begin(), damping_stiffness.end(), [](double b) { return b > 0; });
}

Simulator::~Simulator() = default;

const BodyModel& Simulator::model() const {
  return parts_->model;
}

const SolverParams& Simulator::params() const {
  return parts_->params;
}

const SimulationState& Simulator::state() const {
  return parts_->state;
}

void Simulator::set_state(SimulationState state) {
  CHECK(state.positions.size() == parts_->nodes());
  CHECK(state.velocities.size() == parts_->nodes());
  CHECK(state.rotations.size() == parts_->body.tets.size());
  for (const auto* memory :
       {&state.previous_positions, &state.previous_velocities, &state.accelerations, &state.previous_accelerations})
    if (!memory->empty()) CHECK(memory->size() == parts_->nodes());
  CHECK((state.grabs.pins.empty() || state.grabs.pins.size() == parts_->model.pins.size()));
  CHECK((state.grabs.pulls.empty() || state.grabs.pulls.size() == parts_->model.pulls.size()));
  CHECK((state.troubles.empty() || state.troubles.size() == parts_->body.tets.size()));
  parts_->state = std::move(state);
  parts_->coarse_lag.usable = false;
  parts_->known_rest.known = false;
}

StepReport Simulator::step(double frame, double seconds, double error_limit) {
  CHECK(seconds > 0);
  return parts_->step(frame, seconds, error_limit);
}

StepReport Simulator::find_equilibrium(double frame) {
  return parts_->find_equilibrium(frame);
}

std::vector<LevelInfo> Simulator::levels() const {
  return parts_->multigrid.levels();
}

StateMeasures Simulator::measure() const {
  const Parts& parts = *parts_;
  const SimulationState& state = parts.state;
  StateMeasures measures;
  for (std::size_t i = 0; i < parts.nodes(); ++i) {
    const double mass = parts.masses.mass[i];
    const Vec3 momentum = mass * state.velocities[i];
    measures.kinetic_energy += 0.5 * momentum.dot(state.velocities[i]);
    measures.potential_energy -= mass * parts.model.gravity.dot(state.positions[i]);
    measures.linear_momentum += momentum;
    measures.angular_momentum += state.positions[i].cross(momentum);
  }
  std::vector<Quaternion> rotations = state.rotations;
  find_rotations(parts.body, parts.params.rotation, state.positions, rotations, parts.threads);
  measures.elastic_energy = elastic_energy(parts.body, state.positions, rotations, parts.threads);
  return measures;
}

}  // namespace softreel
