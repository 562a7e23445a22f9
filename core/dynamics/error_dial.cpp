#include "core/dynamics/error_dial.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace softreel {
namespace {

/// Shares of the wanted error. Work grows as (mesh error)^(-3/p) with p about 1.5 and as (time error)^(-1/2): least for
/// a given sum where the first is four times the second. Tolerance is cheap.
constexpr double kMeshShare = 0.75, kTimeShare = 0.2, kAlgebraShare = 0.05;

/// Coarsest mesh: below, the surface is hardly carried.
constexpr std::int64_t kFirstTets = 500;
constexpr std::int64_t kFewestTets = 250;
/// From one pilot mesh to the next, in tetrahedra.
constexpr std::int64_t kMeshRatio = 4;
/// Linear tetrahedra: 2 where the solution is smooth, 1 at the edges of pins, whose place moves with the mesh.
constexpr double kLowestMeshOrder = 1, kHighestMeshOrder = 2;

/// A jump of constraints leaves first order, a slowly damped oscillation of long steps less.
constexpr double kLowestStepOrder = 0.7, kHighestStepOrder = 2.2;

constexpr double kNoError = -1;  ///< no two runs to compare

constexpr double kPilotTolerance = 1e-6;
/// Which the algebraic error is measured with; it is proportional to the tolerance.
constexpr double kLooseTolerance = 1e-3;
constexpr double kTightestTolerance = 1e-8, kLoosestTolerance = 1e-2;

/// The order that three errors' differences show where each run divides the step by `ratio`.
double fitted_order(double first, double second, double ratio, double lowest, double highest) {
  if (second <= 0 || first <= 0) return highest;
  return std::clamp(std::log(first / second) / std::log(ratio), lowest, highest);
}

/// The search; one object for one body.
class Dial {
 public:
  Dial(const DialRequest& request, const PilotRun& run) : request_(request), run_(run) {}

  std::optional<DialChoice> turn() {
    choice_.chosen.tolerance = kPilotTolerance;
    choice_.chosen.substeps = std::max(1, request_.given_substeps);
    if (!find_first_mesh()) return std::nullopt;
    if (request_.dynamic) choose_step();
    if (!choose_mesh()) return std::nullopt;
    choose_tolerance();
    choice_.reached = is_reached();
    return choice_;
  }

 private:
  std::optional<Motion> pilot(std::int64_t tets, int substeps, double tolerance) {
    std::optional<Motion> motion = run_({tets, substeps, tolerance});
    choice_.pilots += motion ? 1 : 0;
    return motion;
  }

  double distance(const Motion& a, const Motion& b) const { return motion_distance(a, b) / request_.size; }

  /// The largest pilot: a quarter of a given mesh, so that pilots stay cheaper than the run.
  std::int64_t most_pilot_tets() const {
    return request_.given_tets > 0 ? std::max(kFewestTets * kMeshRatio * kMeshRatio, request_.given_tets / kMeshRatio)
                                   : request_.most_tets;
  }

  bool find_first_mesh() {
    first_tets_ = request_.given_tets > 0 ? std::clamp(request_.given_tets / (kMeshRatio * kMeshRatio * kMeshRatio),
                                                       kFewestTets, kFirstTets)
                                          : std::min(kFirstTets, request_.most_tets);
    for (; first_tets_ <= most_pilot_tets(); first_tets_ *= kMeshRatio) {
      coarse_ = pilot(first_tets_, choice_.chosen.substeps, kPilotTolerance);
      if (coarse_) return true;
    }
    return false;
  }

  /// Steps halved on the coarsest mesh until the rest of the error is small, or twice where they are given.
  void choose_step() {
    const int first = choice_.chosen.substeps;
    const bool is_given = request_.given_substeps > 0;
    const double wanted = kTimeShare * request_.error;
    std::optional<Motion> longer = coarse_;
    std::vector<double> differences;
    double error = 0;  // left with `steps`
    int steps = 2 * first;
    for (;; steps *= 2) {
      std::optional<Motion> shorter = pilot(first_tets_, steps, kPilotTolerance);
      if (shorter && longer)
        differences.push_back(distance(*longer, *shorter));
      else
        differences.clear();
      longer = std::move(shorter);
      if (!differences.empty()) {
        choice_.step_order = order_of_steps(differences);
        error = differences.back() / (std::pow(2, choice_.step_order) - 1);
      }
      const bool is_fitted = differences.size() > 1;
      if (is_fitted && (is_given || error <= wanted)) break;
      if (2 * steps > (is_given ? 8 * first : request_.most_substeps)) break;
    }
    if (!is_given) choice_.chosen.substeps = needed_steps(steps, differences.empty() ? kNoError : error, wanted);
    choice_.believed.time = error * std::pow(static_cast<double>(steps) / choice_.chosen.substeps, choice_.step_order);
  }

  /// So many that `error`, which is left with `steps`, becomes `wanted`; not known: as many as there may be.
  int needed_steps(int steps, double error, double wanted) const {
    if (error == kNoError) return request_.most_substeps;
    const double needed = std::ceil(steps * std::pow(error / wanted, 1 / choice_.step_order));
    return static_cast<int>(std::clamp(needed, 1.0, static_cast<double>(request_.most_substeps)));
  }

  static double order_of_steps(const std::vector<double>& differences) {
    const std::size_t n = differences.size();
    if (n < 2) return 1;
    return fitted_order(differences[n - 2], differences[n - 1], 2, kLowestStepOrder, kHighestStepOrder);
  }

  /// Errors on meshes of four times as many tetrahedra each, with the step that was chosen. False: no two could be run.
  bool choose_mesh() {
    const double edge_ratio = std::cbrt(static_cast<double>(kMeshRatio));
    const double wanted = kMeshShare * request_.error;
    std::optional<Motion> coarser = pilot(first_tets_, choice_.chosen.substeps, kPilotTolerance);
    std::vector<double> differences;
    double error = 0, needed = 0;  // left with `tets`, and what makes it `wanted`
    std::int64_t tets = kMeshRatio * first_tets_;
    for (;; tets *= kMeshRatio) {
      std::optional<Motion> finer = pilot(tets, choice_.chosen.substeps, kPilotTolerance);
      if (finer && coarser)
        differences.push_back(distance(*coarser, *finer));
      else
        differences.clear();
      coarser = std::move(finer);
      if (!differences.empty()) {
        choice_.mesh_order = order_of_meshes(differences, edge_ratio);
        error = differences.back() / (std::pow(edge_ratio, choice_.mesh_order) - 1);
        needed = static_cast<double>(tets) * std::pow(error / wanted, 3 / choice_.mesh_order);
      }
      const bool is_fitted = differences.size() > 1;
      const bool is_enough = needed <= static_cast<double>(kMeshRatio * tets);
      if (request_.given_tets == 0 && is_fitted && is_enough) break;
      if (kMeshRatio * tets > most_pilot_tets()) break;
    }
    if (differences.empty()) return false;
    choice_.chosen.tets = request_.given_tets > 0 ? request_.given_tets : rounded(needed);
    choice_.believed.mesh =
        error * std::pow(static_cast<double>(tets) / static_cast<double>(choice_.chosen.tets), choice_.mesh_order / 3);
    return true;
  }

  /// Of two meshes alone none can be told: between the two that linear tetrahedra have.
  static double order_of_meshes(const std::vector<double>& differences, double edge_ratio) {
    const std::size_t n = differences.size();
    if (n < 2) return 0.5 * (kLowestMeshOrder + kHighestMeshOrder);
    return fitted_order(differences[n - 2], differences[n - 1], edge_ratio, kLowestMeshOrder, kHighestMeshOrder);
  }

  /// Two digits, upwards, within the limits.
  std::int64_t rounded(double tets) const {
    const double most = static_cast<double>(request_.most_tets);
    const double fewest = std::min(static_cast<double>(first_tets_), most);
    if (!(tets < most)) return request_.most_tets;
    const double unit = std::pow(10, std::floor(std::log10(std::max(tets, fewest))) - 1);
    return static_cast<std::int64_t>(std::min(most, unit * std::ceil(std::max(tets, fewest) / unit)));
  }

  /// A residual of equal size hides errors of longer waves on a finer mesh: they grow as h^-2.
  void choose_tolerance() {
    const std::optional<Motion> tight = pilot(first_tets_, choice_.chosen.substeps, kPilotTolerance);
    const std::optional<Motion> loose = pilot(first_tets_, choice_.chosen.substeps, kLooseTolerance);
    const double growth =
        std::max(1.0, std::pow(static_cast<double>(choice_.chosen.tets) / static_cast<double>(first_tets_), 2.0 / 3));
    const double slope = tight && loose ? growth * distance(*tight, *loose) / kLooseTolerance : 0;
    const double wanted = kAlgebraShare * request_.error;
    double tolerance = request_.given_tolerance;
    if (tolerance == 0) {
      tolerance = tight && loose ? kLoosestTolerance : kPilotTolerance;
      if (slope * tolerance > wanted) tolerance = std::max(kTightestTolerance, wanted / slope);
    }
    choice_.chosen.tolerance = tolerance;
    choice_.believed.algebra = slope * tolerance;
  }

  bool is_reached() const {
    constexpr double kRounding = 1.01;
    return choice_.believed.total() <= kRounding * request_.error;
  }

  const DialRequest& request_;
  const PilotRun& run_;
  DialChoice choice_;
  std::int64_t first_tets_ = kFirstTets;
  std::optional<Motion> coarse_;  ///< on the first mesh
};

}  // namespace

double motion_distance(const Motion& a, const Motion& b) {
  CHECK(a.size() == b.size());
  CHECK(!a.empty());
  double largest = 0;
  for (std::size_t f = 0; f < a.size(); ++f) {
    CHECK(a[f].size() == b[f].size());
    CHECK(!a[f].empty());
    double sum = 0;
    for (std::size_t i = 0; i < a[f].size(); ++i) sum += (a[f][i] - b[f][i]).squaredNorm();
    largest = std::max(largest, sum / static_cast<double>(a[f].size()));
  }
  return std::sqrt(largest);
}

std::optional<DialChoice> turn_dial(const DialRequest& request, const PilotRun& run) {
  CHECK(request.error > 0);
  CHECK(request.size > 0);
  return Dial(request, run).turn();
}

}  // namespace softreel
