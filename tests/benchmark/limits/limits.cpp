#include "tests/benchmark/limits/limits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "tests/benchmark/limits/bending_bar.h"
#include "tests/benchmark/limits/cost_curve.h"

namespace softreel::bench {
namespace {

constexpr std::array kRemedies{TetRemedy::None, TetRemedy::Quadratic, TetRemedy::NodalPressure, TetRemedy::NodalStrain};
/// The error that meshes are asked for in the last table.
constexpr double kWantedError = 0.01;

struct Plan {
  std::vector<double> poisson_ratios;
  std::map<TetRemedy, std::vector<Index>> across;  ///< cubes across the bar
  int degree = 0;                                  ///< of the reference
};

Plan plan_of(bool quick) {
  if (quick)
    return {{0.3, 0.499},
            {{TetRemedy::None, {2, 3, 4, 6, 8}},
             {TetRemedy::Quadratic, {1, 2, 3}},
             {TetRemedy::NodalPressure, {2, 3, 4, 5}},
             {TetRemedy::NodalStrain, {2, 3, 4, 5}}},
            4};
  return {{0.3, 0.45, 0.49, 0.499},
          {{TetRemedy::None, {2, 3, 4, 5, 6, 8, 10}},
           {TetRemedy::Quadratic, {1, 2, 3, 4, 5}},
           {TetRemedy::NodalPressure, {2, 3, 4, 5, 6}},
           {TetRemedy::NodalStrain, {2, 3, 4, 5, 6}}},
          5};
}

struct Sample {
  Index across = 0;
  BarAnswer bar;
  double error = 0;  ///< of the tip, relative
};

/// All of one Poisson's ratio.
struct Study {
  double poisson_ratio = 0;
  double true_tip = 0, tip_doubt = 0;  ///< m; the doubt is what the last degree of the reference changed
  std::map<TetRemedy, std::vector<Sample>> samples;

  CostCurve by_nonzeros(TetRemedy remedy) const {
    CostCurve curve;
    for (const Sample& sample : samples.at(remedy)) {
      curve.costs.push_back(static_cast<double>(sample.bar.statics.nonzeros));
      curve.errors.push_back(sample.error);
    }
    return curve;
  }
  CostCurve by_seconds(TetRemedy remedy) const {
    CostCurve curve = by_nonzeros(remedy);
    curve.costs.clear();
    for (const Sample& sample : samples.at(remedy)) curve.costs.push_back(sample.bar.statics.solve_seconds);
    return curve;
  }
};

Study study(double poisson_ratio, const Plan& plan) {
  Study result{poisson_ratio, bend_bar_by_polynomials(plan.degree, poisson_ratio).tip, 0, {}};
  result.tip_doubt = std::abs(result.true_tip - bend_bar_by_polynomials(plan.degree - 1, poisson_ratio).tip);
  for (const TetRemedy remedy : kRemedies)
    for (const Index across : plan.across.at(remedy)) {
      Sample sample{across, bend_bar(across, remedy, poisson_ratio), 0};
      sample.error = std::abs(sample.bar.tip - result.true_tip) / result.true_tip;
      result.samples[remedy].push_back(std::move(sample));
    }
  return result;
}

/// The greatest cost that all curves reach.
double common_cost(const std::vector<CostCurve>& curves) {
  double cost = curves.front().costs.back();
  for (const CostCurve& curve : curves) cost = std::min(cost, curve.costs.back());
  return cost;
}

std::string percent(double share) {
  return fmt::format("{:.3g} %", 100 * share);
}

void add_samples(const std::vector<Study>& studies, Report& report) {
  Table table{"limits_samples",
              "Sag of the bar's free end under its weight, and what it cost",
              {"Poisson's ratio", "elements", "cubes across", "unknowns", "nonzeros", "LDLT cpu s", "tip / m",
               "tip over true tip", "error"},
              {}};
  for (const Study& study : studies)
    for (const TetRemedy remedy : kRemedies)
      for (const Sample& sample : study.samples.at(remedy))
        table.add({study.poisson_ratio, std::string(name_of(remedy)), static_cast<long>(sample.across),
                   static_cast<long>(sample.bar.statics.unknowns), static_cast<long>(sample.bar.statics.nonzeros),
                   sample.bar.statics.solve_seconds, sample.bar.tip, sample.bar.tip / study.true_tip, sample.error});
  report.add(table);
}

void add_locking(const std::vector<Study>& studies, const Plan& plan, Report& report) {
  Table table{
      "limits_locking", "Share of the true sag that linear tetrahedra reach, by Poisson's ratio", {"cubes across"}, {}};
  for (const Study& study : studies) table.columns.push_back(fmt::format("nu {:g}", study.poisson_ratio));
  const std::vector<Index>& across = plan.across.at(TetRemedy::None);
  for (std::size_t i = 0; i < across.size(); ++i) {
    std::vector<Cell> row{static_cast<long>(across[i])};
    for (const Study& study : studies)
      row.emplace_back(percent(study.samples.at(TetRemedy::None)[i].bar.tip / study.true_tip));
    table.add(std::move(row));
  }
  report.add(table);
}

/// How many times smaller than those of linear tetrahedra the errors are, at one cost.
struct Gain {
  double cost = 0, error = 0, factor = 0;
};

Gain find_gain(const Study& study, TetRemedy remedy, CostCurve (Study::*curve)(TetRemedy) const) {
  std::vector<CostCurve> curves;
  for (const TetRemedy each : kRemedies) curves.push_back((study.*curve)(each));
  const double cost = common_cost(curves), error = (study.*curve)(remedy).error_at(cost);
  return {cost, error, (study.*curve)(TetRemedy::None).error_at(cost) / error};
}

std::string wanted_cost(const Study& study, TetRemedy remedy) {
  bool extrapolated = false;
  const double cost = study.by_nonzeros(remedy).cost_for(kWantedError, extrapolated);
  return fmt::format("{:.2g}{}", cost, extrapolated ? " (extrapolated)" : "");
}

void add_remedies(const std::vector<Study>& studies, Report& report) {
  Table table{"limits_remedies",
              "What each remedy gains over linear tetrahedra at equal cost (above 1: it is better)",
              {"Poisson's ratio", "elements", "at nonzeros", "error there", "gain at equal nonzeros",
               "gain at equal LDLT seconds", "nonzeros for an error of " + percent(kWantedError)},
              {}};
  for (const Study& study : studies)
    for (const TetRemedy remedy : kRemedies) {
      const Gain gain = find_gain(study, remedy, &Study::by_nonzeros);
      table.add({study.poisson_ratio, std::string(name_of(remedy)), gain.cost, percent(gain.error), gain.factor,
                 find_gain(study, remedy, &Study::by_seconds).factor, wanted_cost(study, remedy)});
    }
  report.add(table);
}

void add_cost_plot(const Study& study, Report& report) {
  Plot plot{fmt::format("limits_cost_nu{:03.0f}", 1000 * study.poisson_ratio),
            fmt::format("Bending bar, Poisson's ratio {:g}: error of the tip against the size of the matrix",
                        study.poisson_ratio),
            "nonzeros of the matrix",
            "relative error of the tip",
            true,
            true,
            {}};
  for (const TetRemedy remedy : kRemedies) {
    const CostCurve curve = study.by_nonzeros(remedy);
    plot.series.push_back({name_of(remedy), curve.costs, curve.errors, remedy == TetRemedy::None, false});
  }
  report.add(plot);
}

void add_locking_plot(const std::vector<Study>& studies, Report& report) {
  Plot plot{"limits_locking",
            "Bending bar: error of the tip at equal matrix size, as the material nears incompressibility",
            "1 - 2 nu (incompressible to the left)",
            "relative error of the tip",
            true,
            true,
            {}};
  for (const TetRemedy remedy : kRemedies) {
    Series series{name_of(remedy), {}, {}, remedy == TetRemedy::None, false};
    for (const Study& study : studies) {
      series.x.push_back(1 - 2 * study.poisson_ratio);
      series.y.push_back(find_gain(study, remedy, &Study::by_nonzeros).error);
    }
    plot.series.push_back(std::move(series));
  }
  report.add(plot);
}

void say_problem(const std::vector<Study>& studies, Report& report) {
  double doubt = 0;
  for (const Study& study : studies) doubt = std::max(doubt, study.tip_doubt / study.true_tip);
  report.say(fmt::format(
      "A bar of 1 x 0.25 x 0.25 m (E {:g} Pa), its nodes at x = 0 clamped, bends under its weight; body-centred cubic "
      "tetrahedra as softreel makes them. Small-strain statics: locking is a matter of the strains that an element can "
      "have, and a corotated element locks as its unrotated twin does. True is the answer of boxes of high polynomial "
      "degree, fine where the clamp's edges make stress singular; its last degree changed the tip by {} at most.",
      kBarModulus, percent(doubt)));
  report.say(
      "Cost is the matrix's nonzeros, which is what an iteration of softreel's solver pays for, and for comparison the "
      "processor time of one sparse LDLT (Eigen, AMD ordering) of the same system. 10-node tetrahedra have straight "
      "edges and four points of quadrature; nodal pressure is Bonet and Burton's (1998); nodal strain is averaged as "
      "by "
      "Dohrmann et al. (2000) with the stabilisation of Puso and Solberg (2006). Finer lattices are the linear curve "
      "itself. What no column counts: 10-node elements and nodal averages would need a multigrid of their own.");
}

/// What two lattices with edges h and h / 2 say of refinement.
void say_refinement(const Study& study, Report& report) {
  const std::vector<Sample>& samples = study.samples.at(TetRemedy::None);
  const Sample& fine = samples.back();
  const auto coarse = std::find_if(samples.begin(), samples.end(),
                                   [&](const Sample& sample) { return 2 * sample.across == fine.across; });
  if (coarse == samples.end()) return;
  report.say(fmt::format(
      "Finer lattices, nu {:g}: from {} to {} cubes across, the matrix grows {:.1f} times and the error falls {:.2g} "
      "times, from {} to {}.",
      study.poisson_ratio, coarse->across, fine.across,
      static_cast<double>(fine.bar.statics.nonzeros) / static_cast<double>(coarse->bar.statics.nonzeros),
      coarse->error / fine.error, percent(coarse->error), percent(fine.error)));
}

/// Geometric mean over the studies.
double mean_gain(const std::vector<Study>& studies, TetRemedy remedy, CostCurve (Study::*curve)(TetRemedy) const) {
  double sum = 0;
  for (const Study& study : studies) sum += std::log(find_gain(study, remedy, curve).factor);
  return std::exp(sum / static_cast<double>(studies.size()));
}

void say_conclusion(const std::vector<Study>& studies, Report& report) {
  std::vector<TetRemedy> order(kRemedies.begin() + 1, kRemedies.end());
  const auto gain = [&](TetRemedy remedy) { return mean_gain(studies, remedy, &Study::by_nonzeros); };
  std::sort(order.begin(), order.end(), [&](TetRemedy a, TetRemedy b) { return gain(a) > gain(b); });
  std::string text;
  for (const TetRemedy remedy : order)
    text += fmt::format("{}{}: {:.2g} times smaller errors at equal nonzeros, {:.2g} at equal LDLT time",
                        text.empty() ? "" : "; ", name_of(remedy), gain(remedy),
                        mean_gain(studies, remedy, &Study::by_seconds));
  report.say(fmt::format("Conclusion, as geometric means over these ratios. {}.", text));
  std::string best;
  for (const Study& study : studies) {
    const auto factor = [&](TetRemedy remedy) { return find_gain(study, remedy, &Study::by_nonzeros).factor; };
    const TetRemedy first = *std::max_element(kRemedies.begin(), kRemedies.end(),
                                              [&](TetRemedy a, TetRemedy b) { return factor(a) < factor(b); });
    best += fmt::format("{} nu {:g}, {} ({:.2g} times)", best.empty() ? "" : ";", study.poisson_ratio, name_of(first),
                        factor(first));
  }
  report.say(fmt::format("The best at equal nonzeros:{}.", best));
  report.say(gain(order.front()) > 1
                 ? fmt::format("What would move the curve most at equal cost: {}.", name_of(order.front()))
                 : std::string("None of them beats linear tetrahedra on a finer lattice at equal cost."));
}

}  // namespace

void run_limits(const BenchOptions& options, Report& report) {
  const Plan plan = plan_of(options.quick);
  std::vector<Study> studies;
  for (const double poisson_ratio : plan.poisson_ratios) studies.push_back(study(poisson_ratio, plan));
  say_problem(studies, report);
  add_locking(studies, plan, report);
  add_cost_plot(studies.front(), report);
  add_cost_plot(studies.back(), report);
  add_locking_plot(studies, report);
  add_remedies(studies, report);
  say_refinement(studies.front(), report);
  say_refinement(studies.back(), report);
  say_conclusion(studies, report);
  add_samples(studies, report);
}

}  // namespace softreel::bench
