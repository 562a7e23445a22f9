#include "tests/benchmark/precision/bar_statics.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "tests/benchmark/precision/bar_models.h"
#include "tests/benchmark/precision/beam_theory.h"
#include "tests/benchmark/precision/calculix.h"
#include "tests/benchmark/precision/static_answer.h"

namespace softreel::bench {
namespace {

constexpr const char* kSoftreel = "softreel";
constexpr const char* kLinear = "CalculiX C3D4, same mesh";
constexpr const char* kQuadratic = "CalculiX C3D10";
constexpr double kTolerances[] = {1e-3, 1e-6};  ///< of the force balance

WorkPoint static_point(const std::string& problem, const std::string& method, const Bar& bar) {
  WorkPoint point;
  point.problem = problem;
  point.method = point.curve = method;
  point.ours = method == kSoftreel;
  point.tets = static_cast<long>(bar.model.mesh.tets.size());
  return point;
}

SolverParams static_params(double tolerance) {
  SolverParams params = uncapped_params();
  params.force_tolerance = tolerance;
  return params;
}

Vec3 mean(const std::vector<Vec3>& vectors) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : vectors) sum += v;
  return sum / static_cast<double>(vectors.size());
}

/// A bar whose tip's deflection against its weight is asked for.
using BarOfSize = std::function<Bar(Index across)>;

/// softreel's points, and CalculiX' where it can be started. sizes: cubes across.
std::vector<WorkPoint> deflections(const std::string& problem, const BarOfSize& make, const std::vector<Index>& sizes,
                                   Index most_linear, Index most_quadratic, double truth,
                                   CalculixStatics statics = CalculixStatics::LargeDisplacement) {
  std::vector<WorkPoint> points;
  const auto add = [&](WorkPoint point, double seconds, double value) {
    point.seconds = seconds;
    point.value = value;
    point.error = std::abs(value / truth - 1);
    points.push_back(std::move(point));
  };
  for (const Index across : sizes) {
    const Bar bar = make(across);
    const std::vector<Index> tip = section_nodes(bar, bar.length);
    for (const double tolerance : kTolerances) {
      const StaticAnswer answer = time_static_answer(bar.model, static_params(tolerance));
      WorkPoint point = static_point(problem, kSoftreel, bar);
      point.tolerance = tolerance;
      add(point, answer.seconds, -mean_displacement(bar, tip, answer.positions).y());
    }
    for (const CalculixElement element : {CalculixElement::Linear, CalculixElement::Quadratic}) {
      const bool linear = element == CalculixElement::Linear;
      if (!has_calculix() || across > (linear ? most_linear : most_quadratic)) continue;
      const CalculixAnswer answer = solve_by_calculix(bar, element, tip, Vec3::Zero(), statics);
      add(static_point(problem, linear ? kLinear : kQuadratic, bar), answer.seconds, -mean(answer.displacements).y());
    }
  }
  return points;
}

std::string calculix_text() {
  if (!has_calculix()) return " CalculiX' program `ccx` is not installed here (Debian: calculix-ccx): it is left out.";
  return " CalculiX runs as a process of its own on one thread with its default solver; its time is all of that "
         "process. C3D4 are the same linear tetrahedra; C3D10 have quadratic shape functions on the same elements.";
}

/// How far softreel's tightest answers and CalculiX' are apart on the same meshes.
std::string difference_text(const std::vector<WorkPoint>& points) {
  double largest = -1;
  for (const WorkPoint& a : points)
    for (const WorkPoint& b : points)
      if (a.method == kSoftreel && a.tolerance == kTolerances[1] && b.method == kLinear && a.tets == b.tets)
        largest = std::max(largest, std::abs(a.value / b.value - 1));
  return largest < 0 ? "" : fmt::format(" On the same meshes softreel and C3D4 differ by at most {:.2g}.", largest);
}

/// The tip of the elastica under one load by one method.
struct LoadedTip {
  double seconds = 0;
  Vec3 displacement = Vec3::Zero();
};

constexpr double kLoads[] = {1, 2, 5, 10};

/// All loads together: time is their sum, error the root mean square of the tips' distances over the theory's ways.
class ElasticaSum {
 public:
  ElasticaSum(WorkPoint point, Table& table) : point_(std::move(point)), table_(table) {}

  void add(double load, const LoadedTip& tip) {
    const ElasticaTip truth = elastica_tip(load);
    const double across = -tip.displacement.y(), along = -tip.displacement.x();
    squares_ += (std::pow(across - truth.across, 2) + std::pow(along - truth.shortening, 2)) /
                (truth.across * truth.across + truth.shortening * truth.shortening);
    point_.seconds += tip.seconds;
    point_.value = across;
    table_.add({point_.method, point_.tets, point_.tolerance, load, across, truth.across, along, truth.shortening});
  }
  WorkPoint point() const {
    WorkPoint point = point_;
    point.error = std::sqrt(squares_ / std::size(kLoads));
    return point;
  }

 private:
  WorkPoint point_;
  Table& table_;
  double squares_ = 0;
};

Bar elastica_bar(Index across) {
  Bar bar = make_clamped_bar(across, 50, 0.02, {1e6, 0, 1000, 0, 0}, Clamped::LowEnd);
  bar.model.gravity.setZero();
  return bar;
}

Vec3 elastica_force(const Bar& bar, double load) {
  const Beam beam{bar.length, bar.width, bar.model.materials.front().youngs_modulus, 0, 1000};
  return Vec3(0, -load * beam.youngs_modulus * beam.inertia() / (beam.length * beam.length), 0);
}

void add_elastica(ProblemResult& result, Index across, double tolerance, RotationMethod rotation) {
  Bar bar = elastica_bar(across);
  const std::vector<Index> tip = section_nodes(bar, bar.length);
  WorkPoint start = static_point(result.name, rotation == RotationMethod::None ? "small strain" : kSoftreel, bar);
  start.tolerance = tolerance;
  ElasticaSum sum(start, result.tables.front());
  SolverParams params = static_params(tolerance);
  params.rotation = rotation;
  for (const double load : kLoads) {
    bar.model.pulls = {make_dead_load(bar, tip, elastica_force(bar, load))};
    const StaticAnswer answer = time_static_answer(bar.model, params);
    sum.add(load, {answer.seconds, mean_displacement(bar, tip, answer.positions)});
  }
  result.points.push_back(sum.point());
}

void add_elastica_by_calculix(ProblemResult& result, Index across, CalculixElement element) {
  const Bar bar = elastica_bar(across);
  const std::vector<Index> tip = section_nodes(bar, bar.length);
  ElasticaSum sum(static_point(result.name, element == CalculixElement::Linear ? kLinear : kQuadratic, bar),
                  result.tables.front());
  for (const double load : kLoads) {
    const CalculixAnswer answer = solve_by_calculix(bar, element, tip, elastica_force(bar, load));
    sum.add(load, {answer.seconds, mean(answer.displacements)});
  }
  result.points.push_back(sum.point());
}

}  // namespace

ProblemResult measure_cantilever(bool quick) {
  constexpr double kGravity = 1e-3;
  const Beam beam;
  const BarOfSize make = [&](Index across) {
    Bar bar = make_clamped_bar(across, 10, beam.width, {beam.youngs_modulus, beam.poisson_ratio, beam.density, 0, 0},
                               Clamped::LowEnd);
    bar.model.gravity = Vec3(0, -kGravity, 0);
    return bar;
  };
  ProblemResult result{"cantilever", "Cantilever under a faint weight: tip against Timoshenko's beam", "", {}, {}, {}};
  result.text =
      "Length 1 m, section 0.1 x 0.1 m, E = 1e6 Pa, nu = 0 (so that the clamp adds no stress of its own), weight so "
      "small that all is linear. Truth: w = q L^4 / (8 E I) + q L^2 / (2 kappa G A), kappa = 10 (1 + nu) / (12 + 11 "
      "nu) = 5/6 (Cowper 1966); a clamp that keeps the section from warping makes the bar a little stiffer than that." +
      calculix_text();
  if (has_calculix()) result.text += " Here it solves its linear equations once.";
  const std::vector<Index> sizes =
      quick ? std::vector<Index>{1, 2, 3, 4, 6} : std::vector<Index>{1, 2, 3, 4, 6, 8, 12, 16};
  result.points = deflections(result.name, make, sizes, quick ? 3 : 6, quick ? 2 : 3, timoshenko_tip(beam, kGravity),
                              CalculixStatics::Linear);
  result.text += difference_text(result.points);
  result.orders.push_back(order_in_mesh(result.points, kSoftreel, 2));
  return result;
}

ProblemResult measure_elastica(bool quick) {
  ProblemResult result{
      "elastica", "Elastica, P L^2 / (E I) = 1, 2, 5, 10: tip against an inextensible beam", "", {}, {}, {}};
  result.text =
      "Length 1 m, section 0.02 x 0.02 m (slenderness 50), E = 1e6 Pa, nu = 0. Truth: the elastica by shooting, which "
      "gives the numbers of Mattiasson 1981 to his last digit. What it leaves out moves the tip by 3 (a/L)^2 / 5 = "
      "2.4e-4 of w at small loads (shear) and by up to 3.3e-4 L (stretch under 10). The dead load is a pull with a "
      "limited force towards a target 1e4 m away: its direction errs by 1e-4. Time and error are those of the four "
      "loads together, each from rest." +
      calculix_text();
  result.tables.push_back({"precision_elastica_tips",
                           "Elastica: the tip under each load",
                           {"method", "tets", "tolerance", "P L^2 / (E I)", "w / L", "theory", "u / L", "theory"},
                           {}});
  const std::vector<Index> sizes = quick ? std::vector<Index>{1, 2} : std::vector<Index>{1, 2, 4, 6};
  for (const Index across : sizes) {
    for (const double tolerance : kTolerances) add_elastica(result, across, tolerance, RotationMethod::Consistent);
    if (across <= 4) add_elastica(result, across, kTolerances[0], RotationMethod::None);
    if (has_calculix() && across <= 2) add_elastica_by_calculix(result, across, CalculixElement::Linear);
    if (has_calculix() && across == 1 && !quick) add_elastica_by_calculix(result, across, CalculixElement::Quadratic);
  }
  if (!quick) result.orders.push_back(order_in_mesh(result.points, kSoftreel, 2));
  return result;
}

ProblemResult measure_torsion(bool quick) {
  constexpr double kTurn = 0.02;
  ProblemResult result{"torsion", "Torsion of a square bar: stiffness against Saint-Venant", "", {}, {}, {}};
  result.text =
      "Length 0.6 m, section 0.1 x 0.1 m, E = 1e6 Pa, nu = 0.3; the high end is turned by 0.02 rad. Value: torque over "
      "G a^4 and twist per length; truth 0.140577. The torque is 2 W / 0.02 with the elastic energy W, the twist that "
      "between the sections at 0.2 and 0.4 m, two widths from the ends that cannot warp.";
  for (const Index across : quick ? std::vector<Index>{2, 4, 6, 8} : std::vector<Index>{2, 4, 6, 8, 12, 16}) {
    Bar bar = make_clamped_bar(across, 6, 0.1, {1e6, 0.3, 1000, 0, 0}, Clamped::BothEnds);
    bar.model.gravity.setZero();
    Transform turn;
    turn.rotate.x() = kTurn;
    bar.model.pins[1].track = {{{0, turn, Ease::Constant}}};
    const double shear = bar.model.materials.front().lame_mu();
    for (const double tolerance : kTolerances) {
      const StaticAnswer answer = time_static_answer(bar.model, static_params(tolerance));
      const auto twist_at = [&](double x) { return section_twist(bar, section_nodes(bar, x), answer.positions); };
      WorkPoint point = static_point(result.name, kSoftreel, bar);
      point.tolerance = tolerance;
      point.seconds = answer.seconds;
      point.value = 2 * answer.elastic_energy / kTurn / (shear * std::pow(bar.width, 4)) /
                    ((twist_at(0.4) - twist_at(0.2)) / 0.2);
      point.error = std::abs(point.value / square_torsion_factor() - 1);
      result.points.push_back(point);
    }
  }
  result.orders.push_back(order_in_mesh(result.points, kSoftreel, 2));
  return result;
}

ProblemResult measure_weighed_bar(bool quick) {
  constexpr double kGravity = 9.81;
  const auto bar_under = [](double gravity) {
    return [gravity](Index across) {
      Bar bar = make_clamped_bar(across, 4, 0.25, {1e6, 0.4, 1000, 0, 0}, Clamped::LowEnd);
      bar.model.gravity = Vec3(0, -gravity, 0);
      return bar;
    };
  };
  const auto tip_of = [](const Bar& bar) {
    return -mean_displacement(bar, section_nodes(bar, bar.length),
                              find_static_answer(bar.model, static_params(1e-6)).positions)
                .y();
  };
  // Richardson's extrapolation, by the second order that the other bars show.
  const Index coarse = quick ? 8 : 12, fine = quick ? 12 : 20;
  const double ratio = static_cast<double>(fine) / coarse;
  const auto converged = [&](double gravity) {
    const double a = tip_of(bar_under(gravity)(coarse)), b = tip_of(bar_under(gravity)(fine));
    return b + (b - a) / (ratio * ratio - 1);
  };
  const double whole = converged(kGravity), tenth = converged(0.1 * kGravity);
  ProblemResult result{"bar", "The bar of the targets under its weight: tip against its converged value", "", {}, {},
                       {}};
  const std::vector<Index> sizes = quick ? std::vector<Index>{2, 3, 4, 6} : std::vector<Index>{2, 3, 4, 6, 8, 12};
  result.points = deflections(result.name, bar_under(kGravity), sizes, 6, quick ? 2 : 3, whole);
  const std::vector<WorkPoint> faint =
      deflections("bar, a tenth of its weight", bar_under(0.1 * kGravity), sizes, 6, quick ? 2 : 3, tenth);
  result.tables.push_back(
      point_table("precision_bar_tenth", "The same bar under a tenth of its weight, where strains are small", faint));
  result.text = fmt::format(
      "1 x 0.25 x 0.25 m, one end clamped in its plane, E = 1e6 Pa, nu = 0.4, 1000 kg/m^3, 9.81 m/s^2. Truth: "
      "softreel's own tip, extrapolated (Richardson, order 2) from {} and {} cubes across: {:.5f} m, and {:.6f} m "
      "under a tenth of the weight. At full weight strains reach 12 % at the clamp, and CalculiX' material, linear in "
      "Green's strain, is another one; under a tenth the two materials are the same.",
      coarse, fine, whole, tenth);
  result.text += calculix_text();
  result.text += difference_text(result.points);
  if (const std::string faint_text = difference_text(faint); !faint_text.empty())
    result.text += " Under a tenth of the weight:" + faint_text;
  result.orders.push_back(order_in_mesh(result.points, kSoftreel, 2));
  return result;
}

}  // namespace softreel::bench
