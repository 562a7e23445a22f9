#include "core/dynamics/error_dial.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/base/check.h"

namespace softreel {
namespace {

/// Shares of the wanted error. Work grows as (mesh error)^(-3/p) with p about 1.5 and as (time error)^(-1/2): least for
/// a given sum where the first is four times the second. Tolerance is cheap.
constexpr double kMeshShare = 0.75, kTimeShare = 0.2, kAlgebraShare = 0.05;

/// So many meshes that cannot be run: the shot is at fault, not the meshes.
constexpr int kMostFailures = 4;

/// The coarsest mesh, and the choice: below, the surface is hardly carried and errors follow no power.
constexpr std::int64_t kFirstTets = 1500;
constexpr std::int64_t kMeshRatio = 2;
/// The mesh that time and tolerance are judged on.
constexpr std::int64_t kMiddleTets = kFirstTets * kMeshRatio;
/// Three would do for a fit, but where pins scatter the errors two of them differ too little by chance.
constexpr std::size_t kFewestRungs = MeshErrors::kFewest + 1;
/// The run may have so many times the tetrahedra of the last rung.
constexpr double kReach = 8;
/// Steps of a frame on the rungs: two meshes differ by nearly the same in long steps as in short ones.
constexpr int kRungSteps = 2;

/// A jump of constraints leaves first order, a slowly damped oscillation of long steps less.
constexpr double kLowestStepOrder = 0.7, kHighestStepOrder = 2.2;

constexpr double kPilotTolerance = 1e-5;
constexpr double kExactTolerance = 1e-7;  ///< that others are compared to
constexpr double kTightestTolerance = 1e-6;

double order_of_steps(const std::vector<double>& differences) {
  const std::size_t n = differences.size();
  if (n < 2) return 1;
  if (differences[n - 1] <= 0 || differences[n - 2] <= 0) return kHighestStepOrder;
  return std::clamp(std::log2(differences[n - 2] / differences[n - 1]), kLowestStepOrder, kHighestStepOrder);
}

/// Two digits, upwards.
std::int64_t rounded_up(double tets) {
  const double unit = std::pow(10, std::floor(std::log10(tets)) - 1);
  return static_cast<std::int64_t>(unit * std::ceil(tets / unit * (1 - 1e-12)));
}

/// The search; one object for one body.
class Dial {
 public:
  Dial(const DialRequest& request, const PilotRun& run) : request_(request), run_(run) {}

  std::optional<DialChoice> turn() {
    choice_.chosen.substeps = std::max(1, request_.given_substeps);
    if (request_.dynamic && !choose_steps()) return std::nullopt;
    if (!choose_mesh()) return std::nullopt;
    find_cancelled();
    if (!choose_tolerance()) return std::nullopt;
    constexpr double kRounding = 1.01;
    choice_.reached = choice_.believed.total() <= kRounding * request_.error;
    choice_.pilot_share = work_ / (static_cast<double>(choice_.chosen.tets) * choice_.chosen.substeps);
    return choice_;
  }

 private:
  std::optional<SampledMotion> pilot(std::int64_t tets, int substeps, double tolerance = kPilotTolerance) {
    std::optional<SampledMotion> motion = run_({tets, substeps, tolerance});
    work_ += static_cast<double>(tets) * substeps;
    if (motion) {
      ++choice_.pilots;
      choice_.finest_pilot = std::max(choice_.finest_pilot, tets);
    }
    return motion;
  }

  double distance(const SampledMotion& a, const SampledMotion& b) const {
    return motion_distance(a, b) / request_.size;
  }

  /// The first mesh from the middle one on that can be run at all, in `substeps` steps a frame or, unless they are
  /// given, in twice as many; its motion starts the pairs. A step may be too long, or a part too thin for the mesh.
  std::optional<SampledMotion> find_middle(int& substeps) {
    middle_ = std::min(kMiddleTets, request_.most_tets);
    for (int failures = 0; middle_ <= request_.most_tets && failures < kMostFailures; ++failures) {
      if (auto motion = pilot(middle_, substeps)) return motion;
      if (request_.given_substeps == 0 && 2 * substeps <= request_.most_substeps)
        if (auto motion = pilot(middle_, 2 * substeps)) {
          substeps *= 2;
          return motion;
        }
      middle_ *= kMeshRatio;
    }
    return std::nullopt;
  }

  /// Steps doubled on the middle mesh until the rest of the error is small; where they are given, twice.
  bool choose_steps() {
    const bool is_given = request_.given_substeps > 0;
    int first = choice_.chosen.substeps;
    const double wanted = kTimeShare * request_.error;
    std::optional<SampledMotion> longer = find_middle(first);
    if (!longer) return false;
    std::vector<double> differences;
    double error = 0;  // left with `steps`
    int steps = first;
    const int most = is_given ? 4 * first : request_.most_substeps;
    while (2 * steps <= most) {
      std::optional<SampledMotion> shorter = pilot(middle_, 2 * steps);
      if (!shorter) break;
      steps *= 2;
      differences.push_back(distance(*longer, *shorter));
      time_motion_ = plus(std::move(*longer), -1, *shorter);
      longer = std::move(shorter);
      choice_.step_order = order_of_steps(differences);
      error = differences.back() / (std::pow(2, choice_.step_order) - 1);
      if (!is_given && differences.size() > 1 && error <= wanted) break;
    }
    if (differences.empty()) return false;
    if (!is_given) choice_.chosen.substeps = needed_steps(steps, error, wanted, differences.size() > 2);
    choice_.believed.time = error * std::pow(static_cast<double>(steps) / choice_.chosen.substeps, choice_.step_order);
    return true;
  }

  /// So many that `error`, which is left with `steps`, becomes `wanted`; more than half of `steps` where half of them
  /// were judged before and did not do.
  int needed_steps(int steps, double error, double wanted, bool is_half_judged) const {
    const double needed = std::ceil(steps * std::pow(error / wanted, 1 / choice_.step_order));
    const double fewest = is_half_judged ? 0.5 * steps + 1 : 1;
    return static_cast<int>(std::min(std::max(needed, fewest), static_cast<double>(request_.most_substeps)));
  }

  /// The ladder, rung by rung. False: too few rungs could be run.
  bool choose_mesh() {
    const double most = static_cast<double>(request_.most_tets), given = static_cast<double>(request_.given_tets);
    const double wanted = kMeshShare * request_.error * request_.size;
    double least = 0;  // all that the rung before could have decided
    int failures = 0;
    for (std::int64_t tets = kFirstTets; tets <= request_.most_tets; tets *= kMeshRatio) {
      std::optional<SampledMotion> motion = pilot(tets, rung_steps());
      if (!motion && ++failures == kMostFailures) return false;
      if (!motion) continue;
      meshes_.add(static_cast<double>(tets), std::move(*motion));
      if (meshes_.count() < kFewestRungs) continue;
      meshes_.fit();
      const double reach = kReach * static_cast<double>(tets);
      if ((given > 0 ? given : needed_tets(wanted)) <= reach || reach >= most) break;
      least = reach;
    }
    if (meshes_.count() < kFewestRungs) return false;
    choice_.mesh_order = meshes_.order();
    take_mesh(std::max(least, needed_tets(wanted)));
    return true;
  }

  /// The same for every wanted error, so that all see the same curve.
  int rung_steps() const {
    if (!request_.dynamic) return 1;
    return request_.given_substeps > 0 ? std::min(kRungSteps, request_.given_substeps) : kRungSteps;
  }

  /// The coarsest rung whose error is small enough, or what the curve says beyond the last one.
  double needed_tets(double wanted) const {
    for (std::size_t i = 0; i < meshes_.count(); ++i)
      if (meshes_.measured(i) <= wanted) return meshes_.tets(i);
    return std::max(meshes_.tets(meshes_.count() - 1), meshes_.tets_for(wanted));
  }

  void take_mesh(double needed) {
    choice_.chosen.tets = request_.given_tets > 0 ? request_.given_tets
                          : needed < static_cast<double>(request_.most_tets)
                              ? std::min(rounded_up(needed), request_.most_tets)
                              : request_.most_tets;
    const double tets = static_cast<double>(choice_.chosen.tets);
    double error = meshes_.expected(tets);
    for (std::size_t i = 0; i < meshes_.count(); ++i)
      if (meshes_.tets(i) == tets) error = meshes_.measured(i);
    choice_.believed.mesh = error / request_.size;
  }

  /// Adds what mesh and steps are off by as the vectors they are.
  void find_cancelled() {
    if (time_motion_.empty()) return;
    ErrorParts& parts = choice_.believed;
    const SampledMotion mesh = meshes_.expected_motion(static_cast<double>(choice_.chosen.tets));
    const double mesh_size = motion_size(mesh), time_size = motion_size(time_motion_);
    if (mesh_size == 0 || time_size == 0) return;
    const double unit = parts.mesh / mesh_size;  // the curve's, or as much as was measured
    const double together = unit * motion_size(plus(mesh, parts.time / time_size / unit, time_motion_));
    parts.cancelled = parts.mesh + parts.time - together;
  }

  /// Tightened until it does on the middle mesh. A residual of equal size hides errors of longer waves on a finer mesh:
  /// they grow as h^-2. False: could not be judged.
  bool choose_tolerance() {
    const int substeps = choice_.chosen.substeps;
    if (middle_ == 0) middle_ = static_cast<std::int64_t>(meshes_.tets(1));
    const double growth =
        std::max(1.0, std::pow(static_cast<double>(choice_.chosen.tets) / static_cast<double>(middle_), 2.0 / 3));
    const bool is_given = request_.given_tolerance > 0;
    std::optional<SampledMotion> exact = pilot(middle_, substeps, kExactTolerance);
    if (!exact) exact = pilot(middle_, substeps, kTightestTolerance);
    if (!exact) return false;
    choice_.chosen.tolerance = is_given ? request_.given_tolerance : request_.loosest_tolerance;
    for (;; choice_.chosen.tolerance /= 10) {
      const std::optional<SampledMotion> loose = pilot(middle_, substeps, choice_.chosen.tolerance);
      if (loose) choice_.believed.algebra = growth * distance(*loose, *exact);
      const bool is_last = is_given || choice_.chosen.tolerance < 1.01 * kTightestTolerance;
      if (is_last) return loose.has_value();
      if (loose && choice_.believed.algebra <= kAlgebraShare * request_.error) return true;
    }
  }

  const DialRequest& request_;
  const PilotRun& run_;
  DialChoice choice_;
  MeshErrors meshes_;
  SampledMotion time_motion_;  ///< how much too long steps are off, on the middle mesh, m; only the direction counts
  std::int64_t middle_ = 0;    ///< tetrahedra; 0: not found yet
  double work_ = 0;            ///< of all pilots, tetrahedra times steps of a frame
};

}  // namespace

double attainable_error(const ErrorParts& parts) {
  return std::max({parts.total(), parts.mesh / kMeshShare, parts.time / kTimeShare, parts.algebra / kAlgebraShare});
}

std::optional<DialChoice> turn_dial(const DialRequest& request, const PilotRun& run) {
  CHECK(request.error > 0);
  CHECK(request.size > 0);
  return Dial(request, run).turn();
}

}  // namespace softreel
