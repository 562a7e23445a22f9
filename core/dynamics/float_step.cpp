/// The system of a step with its matrix in float: half the bytes to write and to read, and no copy for the cycle.
///
/// The answer is that of the system in double, to the same tolerance: the right side and, wherever rounding could
/// matter, the residual come from the elements in double (find_step_terms at the changed velocities), so the float
/// matrix is no more than the preconditioner of a refinement. How much rounding matters is estimated from |diag(S)|
/// |d|, which grows with the ratio of stiffness to mass; where it does not, no residual has to be found again.
#include <algorithm>
#include <cmath>

#include "core/dynamics/step_work.h"

namespace softreel {
namespace {

constexpr int kMostRounds = 4;  ///< of refinement; each gains three digits, or float does not do

/// Below, a solve in float would be refined more than once.
constexpr double kLeastTolerance = 1e-7;

/// Greatest ratio of stiffness to mass around a node, or of a bond of glue to the mass that it holds. A rigid motion of
/// a stiff part has no elastic force, but in a matrix rounded to float it seems to have the unit round-off times this
/// ratio of its inertia; a residual relative to all of the right side does not see that if other rows are far stiffer.
/// At 8e4 in each row of a stiff core, velocities were as exact as by double precision (6e-4 at a tolerance of 1e-3),
/// at 8e5 five times less so. Cut bars whose steepest row had 5e4 were wrong by 7e-6 of their motion, at 7e5 by 1.5e-3.
constexpr double kGreatestRatio = 8e4;

/// Rings of neighbours that the ratio is taken over: a part that could move rigidly is larger than a node. The small
/// tetrahedra at a surface have ten times the ratio of what they hang on, which decides how they move.
constexpr int kRatioRings = 2;

/// values[i] = the sum over the elements of node i of their means.
void sum_over_ring(const std::vector<Tet>& tets, std::vector<double>& values) {
  std::vector<double> sums(values.size(), 0.0);
  for (const Tet& tet : tets) {
    double sum = 0;
    for (const Index node : tet) sum += values[static_cast<std::size_t>(node)];
    for (const Index node : tet) sums[static_cast<std::size_t>(node)] += 0.25 * sum;
  }
  values = std::move(sums);
}

/// The values summed over the rings of each node; of float, as nobody needs more of them.
std::vector<float> sum_over_rings(const std::vector<Tet>& tets, std::vector<double> values) {
  for (int ring = 0; ring < kRatioRings; ++ring) sum_over_ring(tets, values);
  return {values.begin(), values.end()};
}

RigidityOverMass rigidity_over_mass(const Simulator::Parts& parts) {
  const std::vector<Tet>& tets = parts.body.tets;
  std::vector<double> stiffness(parts.nodes(), 0.0), damping(parts.nodes(), 0.0);
  for (std::size_t e = 0; e < tets.size(); ++e) {
    const ElementShape& shape = parts.body.shapes[e];
    const double factor = shape.volume * (parts.body.laws[e].lambda + 4 * parts.body.laws[e].mu) / 3;
    for (std::size_t k = 0; k < 4; ++k) {
      const double entry = factor * shape.gradients.col(static_cast<Index>(k)).squaredNorm();
      stiffness[static_cast<std::size_t>(tets[e][k])] += entry;
      damping[static_cast<std::size_t>(tets[e][k])] += parts.damping_stiffness[e] * entry;
    }
  }
  return {sum_over_rings(tets, std::move(stiffness)), sum_over_rings(tets, std::move(damping)),
          sum_over_rings(tets, parts.masses.mass)};
}

/// Greatest mean diagonal entry of K's share in S over the mass, of all nodes and what is around them; damping of mass,
/// which would make it less, is left out. A rotation does not change it.
double greatest_ratio(const RigidityOverMass& ratio, const StepSeconds& seconds) {
  double greatest = 0;
  for (std::size_t i = 0; i < ratio.mass.size(); ++i)
    greatest = std::max(greatest,
                        seconds.velocity * (seconds.position * ratio.stiffness[i] + ratio.damping[i]) / ratio.mass[i]);
  return greatest;
}

double norm(std::span<const Vec3> vectors) {
  double sum = 0;
  for (const Vec3& v : vectors) sum += v.squaredNorm();
  return std::sqrt(sum);
}

/// Per node, of the springs of glue in S.
std::vector<double> glue_stiffness(const Simulator::Parts& parts, const StepWork& work) {
  std::vector<double> stiffness(parts.nodes(), 0.0);
  for (const ActivePull& pull : work.pulls) {
    const double factor = work.step.seconds.velocity * work.step.seconds.position * pull_factor(pull, work.positions);
    for (const Spring& spring : pull.springs)
      for (std::size_t k = 0; k < spring.count && spring.joins_material(); ++k)
        stiffness[static_cast<std::size_t>(spring.nodes[k])] +=
            factor * spring.stiffness * spring.weights[k] * spring.weights[k];
  }
  return stiffness;
}

/// The same ratio for the bonds of glue, whose ends move together as a stiff part does. What the rings even out is the
/// small mass of a node at the surface, or of one whose elements are hardly filled.
double glue_over_mass(const Simulator::Parts& parts, const StepWork& work) {
  if (work.bonds.empty()) return 0;
  const std::vector<double> stiffness = glue_stiffness(parts, work);
  double at_a_node = 0;
  for (std::size_t i = 0; i < stiffness.size(); ++i)
    at_a_node = std::max(at_a_node, stiffness[i] / parts.masses.mass[i]);
  if (at_a_node <= kGreatestRatio) return at_a_node;  // no sums exceed it
  const std::vector<float> around = sum_over_rings(parts.body.tets, stiffness);
  double greatest = 0;
  for (std::size_t i = 0; i < around.size(); ++i)
    greatest = std::max(greatest, static_cast<double>(around[i]) / static_cast<double>(parts.rigidity.mass[i]));
  return greatest;
}

/// The elements fill no block between two bodies.
void clear_joints(const Simulator::Parts& parts, Multigrid& multigrid) {
  BlockMatrixf& matrix = multigrid.float_matrix();
  const auto row = [&](Index node) { return multigrid.row_of_node()[static_cast<std::size_t>(node)]; };
  for (const Joint& joint : parts.joints)
    for (const Index i : parts.body.tets[static_cast<std::size_t>(joint.element)])
      for (const Index j : parts.body.tets[static_cast<std::size_t>(joint.other)])
        for (const auto& [from, to] : {std::pair{i, j}, std::pair{j, i}}) {
          float* block = matrix.block(matrix.pattern.find(row(from), row(to)));
          std::fill(block, block + 9, 0.0F);
        }
}

/// Adds scale * (secant) stiffness of a pull to the float matrix.
void add_pull_stiffness(const ActivePull& pull, std::span<const Vec3> positions, double scale, Multigrid& multigrid) {
  BlockMatrixf& matrix = multigrid.float_matrix();
  const double factor = scale * pull_factor(pull, positions);
  const auto row = [&](Index node) { return multigrid.row_of_node()[static_cast<std::size_t>(node)]; };
  for (const Spring& spring : pull.springs)
    for (std::size_t i = 0; i < spring.count; ++i)
      for (std::size_t j = 0; j < spring.count; ++j) {
        float* block = matrix.block(matrix.pattern.find(row(spring.nodes[i]), row(spring.nodes[j])));
        const auto value = static_cast<float>(factor * spring.stiffness * spring.weights[i] * spring.weights[j]);
        for (int c = 0; c < 3; ++c) block[4 * c] += value;
      }
}

void add(std::span<const Vec3> a, std::span<const Vec3> b, std::span<Vec3> sum) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = a[i] + b[i];
}

/// What work.change may still lack, up to factors: the motion goes on as in the last step, and as it changed there.
/// Empty vectors where nothing is known.
struct Guesses {
  std::vector<Vec3> correction, difference;
};

Guesses guess_corrections(const Simulator::Parts& parts, const StepWork& work) {
  const std::vector<Vec3>&last = parts.state.accelerations, &before = parts.state.previous_accelerations;
  const double t = work.step.seconds.velocity;
  Guesses guesses{std::vector<Vec3>(last.size(), Vec3::Zero()), std::vector<Vec3>(before.size(), Vec3::Zero())};
  for (std::size_t i = 0; i < last.size(); ++i)
    if (work.pinned.held[i] == 0) guesses.correction[i] = t * last[i] - work.change[i];
  for (std::size_t i = 0; i < before.size(); ++i)
    if (work.pinned.held[i] == 0) guesses.difference[i] = t * (last[i] - before[i]);
  return guesses;
}

/// Corrections in float until the residual meets `target`. residual: that of work.change.
SolveReport refine(Simulator::Parts& parts, StepWork& work, double target, std::vector<Vec3>& residual) {
  SolveReport report;
  std::vector<Vec3> correction(residual.size()), velocities;
  for (int round = 0; round < kMostRounds; ++round) {
    const double before = norm(residual);
    report.residual = before;
    if (before <= target) return report;
    const Guesses guesses = round == 0 ? guess_corrections(parts, work) : Guesses{};
    const std::span<const Vec3> directions[] = {guesses.correction, guesses.difference};
    const FloatCorrection found = parts.multigrid.correct_in_float(
        residual, target, parts.params.max_iterations - report.iterations, correction, directions);
    report.iterations += found.report.iterations;
    report.status = found.report.status;
    if (!found.report.ok()) return report;
    add(work.change, correction, work.change);
    report.residual = found.report.residual * before;
    if (report.residual + found.rounding <= target) return report;
    velocities.resize(residual.size());
    add(work.velocities, work.change, velocities);
    find_residual(parts, work, velocities, work.change, residual);
  }
  report.residual = norm(residual);
  if (!(report.residual <= target)) report.status = SolveStatus::Breakdown;
  return report;
}

/// The float matrix of parts.step_terms with its pulls. same_system: what has not changed may stay. Returns the share
/// of the rows that did.
double assemble_in_float(Simulator::Parts& parts, const StepWork& work, bool same_system) {
  StepTerms& terms = parts.step_terms;
  const std::vector<std::uint8_t> rows =
      same_system ? nodes_of_slabs(parts.body.node_slabs, terms.changed) : std::vector<std::uint8_t>();
  parts.float_assembler().assemble(terms, work.node_terms, rows, parts.multigrid.float_matrix(), parts.threads);
  std::fill(terms.changed.begin(), terms.changed.end(), std::uint8_t{0});
  clear_joints(parts, parts.multigrid);
  for (const ActivePull& pull : work.pulls) {
    add_pull_stiffness(pull, work.positions, work.step.seconds.velocity * work.step.seconds.position, parts.multigrid);
    // What is added here is taken away by making these rows anew.
    for (const Spring& spring : pull.springs)
      for (std::size_t k = 0; k < spring.count; ++k)
        choose_slabs_of(parts.body.node_slabs, spring.nodes[k], terms.changed);
  }
  return static_cast<double>(std::count(rows.begin(), rows.end(), 0)) / static_cast<double>(parts.nodes());
}

}  // namespace

double rigidity_beyond_float(Simulator::Parts& parts, const StepWork& work) {
  const StepSeconds& seconds = work.step.seconds;
  if (parts.float_seconds != seconds) {
    parts.float_seconds = seconds;
    if (parts.rigidity.mass.empty()) parts.rigidity = rigidity_over_mass(parts);
    parts.float_ratio = greatest_ratio(parts.rigidity, seconds);
  }
  return std::max(parts.float_ratio, glue_over_mass(parts, work)) / kGreatestRatio;
}

bool suits_float(Simulator::Parts& parts, const StepWork& work) {
  return rigidity_beyond_float(parts, work) <= 1 && parts.params.tolerance >= kLeastTolerance;
}

SolveReport solve_step_in_float(Simulator::Parts& parts, StepWork& work, StepReport& step) {
  SolveReport report{SolveStatus::Breakdown, 0, 0, false};
  const std::size_t n = parts.nodes();
  CoarseLag& lag = parts.coarse_lag;
  const bool same_system = lag.has_same_system(work.step.seconds, work.pinned.held);
  work.right_side.resize(n);
  work.change.assign(n, Vec3::Zero());
  if (same_system) work.kept_change = parts.params.matrix_lag * parts.params.tolerance;
  {
    const ScopedStage stage(parts.times, "simulate/assemble");
    find_residual(parts, work, work.velocities, {}, work.right_side);
    step.kept_rows = assemble_in_float(parts, work, same_system);
  }
  const double scale = norm(work.right_side);
  if (!std::isfinite(scale)) return report;
  step.kept_hierarchy = parts.params.keep_hierarchy && same_system && lag.is_fresh();
  lag.usable = false;
  {
    const ScopedStage stage(parts.times, "simulate/update");
    if (!parts.multigrid.update_in_float(work.pinned.held, step.kept_hierarchy)) return report;
  }
  const ScopedStage stage(parts.times, "simulate/solve");
  correct_translations(parts, work);
  std::vector<Vec3> residual = work.right_side;
  for (std::size_t i = 0; i < n; ++i) residual[i] -= work.node_terms[i] * work.change[i];
  report = refine(parts, work, parts.params.tolerance * scale, residual);
  correct_translations(parts, work);
  if (!step.kept_hierarchy) lag = {false, work.step.seconds, work.pinned.held, report.iterations, 0};
  lag.last_iterations = report.iterations;
  lag.usable = report.ok();
  if (scale > 0) report.residual /= scale;
  return report;
}

}  // namespace softreel
