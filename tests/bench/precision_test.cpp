/// The work-precision benchmark in short: orders in mesh width and time step, and answers near those of theory.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "tests/benchmark/precision/bar_motions.h"
#include "tests/benchmark/precision/beam_theory.h"
#include "tests/benchmark/precision/calculix.h"
#include "tests/benchmark/precision/static_answer.h"

namespace softreel::bench {
namespace {

/// Theory alone.
TEST(BeamTheory, GivesMattiassonsElastica) {
  // Mattiasson 1981: tip over length under P L^2 / (E I) = 1, 2, 5, 10.
  const std::map<double, ElasticaTip> published{
      {1, {0.30172, 0.05643}}, {2, {0.49346, 0.16064}}, {5, {0.71379, 0.38763}}, {10, {0.81061, 0.55500}}};
  for (const auto& [load, tip] : published) {
    EXPECT_NEAR(elastica_tip(load).across, tip.across, 5.1e-6) << load;
    EXPECT_NEAR(elastica_tip(load).shortening, tip.shortening, 5.1e-6) << load;
  }
}

TEST(BeamTheory, AgreesWithLinearTheoryUnderASmallLoad) {
  EXPECT_NEAR(elastica_tip(1e-3).across, 1e-3 / 3, 1e-9);
}

TEST(BeamTheory, NearsEulerAndBernoulliForSlenderBeams) {
  Beam beam;
  beam.width = 0.001;
  EXPECT_NEAR(timoshenko_frequency(beam) / euler_bernoulli_frequency(beam), 1, 1e-5);
  // Shear and rotary inertia take off a share that grows with the square of the thickness.
  beam.width = 0.05;
  const double thin = 1 - timoshenko_frequency(beam) / euler_bernoulli_frequency(beam);
  beam.width = 0.1;
  const double thick = 1 - timoshenko_frequency(beam) / euler_bernoulli_frequency(beam);
  EXPECT_NEAR(thick / thin, 4, 0.1);
  EXPECT_GT(thin, 0);
}

TEST(BeamTheory, KnowsTheTorsionOfASquare) {
  EXPECT_NEAR(square_torsion_factor(), 0.1406, 5e-5);
}

/// Error of the tip of a cantilever under a faint weight.
double timoshenko_error(Index across) {
  constexpr double kGravity = 1e-3;
  const Beam beam;
  Bar bar = make_clamped_bar(across, 10, beam.width, {beam.youngs_modulus, beam.poisson_ratio, beam.density, 0, 0},
                             Clamped::LowEnd);
  bar.model.gravity = Vec3(0, -kGravity, 0);
  const StaticAnswer answer = find_static_answer(bar.model, uncapped_params());
  const double tip = -mean_displacement(bar, section_nodes(bar, bar.length), answer.positions).y();
  return 1 - tip / timoshenko_tip(beam, kGravity);
}

TEST(Precision, NearsTimoshenkosCantileverWithTheSecondOrder) {
  const double coarse = timoshenko_error(3), fine = timoshenko_error(6);
  // Linear tetrahedra are too stiff in bending: the error has this sign on every mesh.
  EXPECT_GT(fine, 0);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
  // What the second order leaves over is small: extrapolated, the theory's tip.
  EXPECT_NEAR(fine - (coarse - fine) / 3, 0, 0.01);
}

TEST(Precision, AgreesWithCalculixOnTheSameMeshWhereStrainsAreSmall) {
  if (!has_calculix()) GTEST_SKIP() << "ccx is not installed";
  Bar bar = make_clamped_bar(3, 4, 0.25, {1e6, 0.4, 1000, 0, 0}, Clamped::LowEnd);
  const std::vector<Index> tip = section_nodes(bar, bar.length);
  const auto calculix_tip = [&](CalculixStatics statics) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& u : solve_by_calculix(bar, CalculixElement::Linear, tip, Vec3::Zero(), statics).displacements)
      sum += u;
    return Vec3(sum / static_cast<double>(tip.size()));
  };
  // The materials differ by what is quadratic in the strain: a tenth of the load, a hundredth of the difference or so.
  std::vector<double> differences;
  for (const double gravity : {9.81, 0.981}) {
    bar.model.gravity = Vec3(0, -gravity, 0);
    const Vec3 ours = mean_displacement(bar, tip, find_static_answer(bar.model, uncapped_params()).positions);
    differences.push_back((ours - calculix_tip(CalculixStatics::LargeDisplacement)).norm() / ours.norm());
  }
  EXPECT_LT(differences[0], 0.02);
  EXPECT_LT(differences[1], 1e-3);
  EXPECT_LT(differences[1], 0.2 * differences[0]);
  bar.model.gravity *= 1e-3;
  const Vec3 large = calculix_tip(CalculixStatics::LargeDisplacement), linear = calculix_tip(CalculixStatics::Linear);
  EXPECT_LT((large - linear).norm(), 1e-3 * linear.norm());
}

TEST(Calculix, SolvesOnceWhereAllIsLinearAndTakesTheWholeLoadAtOnceWhereItIsNot) {
  EXPECT_EQ(calculix_step(CalculixStatics::Linear).find("NLGEOM"), std::string::npos);
  EXPECT_NE(calculix_step(CalculixStatics::LargeDisplacement).find("NLGEOM"), std::string::npos);
  for (const CalculixStatics statics : {CalculixStatics::Linear, CalculixStatics::LargeDisplacement})
    EXPECT_NE(calculix_step(statics).find("*STATIC\n1., 1.\n"), std::string::npos);
}

TEST(Methods, EveryoneWhoSolvesOneSystemAStepByIterationTriesTheSameTolerances) {
  const std::vector<double> ours = softreel_schemes().front().tolerances;
  ASSERT_GT(ours.size(), 1U);
  int iterative = 0;
  for (const Method& method : rival_methods())
    if (method.label.starts_with("CG + ")) {
      ++iterative;
      EXPECT_EQ(method.tolerances, ours) << method.label;
    }
  EXPECT_EQ(iterative, 2);
}

/// Distance of the tip from the elastica over its way.
double elastica_error(Index across, double load) {
  Bar bar = make_clamped_bar(across, 50, 0.02, {1e6, 0, 1000, 0, 0}, Clamped::LowEnd);
  const std::vector<Index> tip = section_nodes(bar, bar.length);
  const Beam beam{bar.length, bar.width, 1e6, 0, 1000};
  bar.model.gravity.setZero();
  bar.model.pulls = {
      make_dead_load(bar, tip, Vec3(0, -load * beam.youngs_modulus * beam.inertia() / (beam.length * beam.length), 0))};
  const Vec3 way = mean_displacement(bar, tip, find_static_answer(bar.model, uncapped_params()).positions);
  const ElasticaTip theory = elastica_tip(load);
  return std::hypot(-way.y() - theory.across, -way.x() - theory.shortening) /
         std::hypot(theory.across, theory.shortening);
}

TEST(Precision, NearsTheElasticaUnderALoadThatBendsTheBarByMoreThanARightAngle) {
  const double coarse = elastica_error(1, 10), middle = elastica_error(2, 10), fine = elastica_error(4, 10);
  EXPECT_LT(middle, 0.4 * coarse);
  EXPECT_GT(std::log2(middle / fine), 1.7);
  EXPECT_LT(fine, 0.03);
}

TEST(Precision, NearsSaintVenantsTorsionWithTheSecondOrder) {
  const auto error = [](Index across) {
    constexpr double kTurn = 0.02;
    Bar bar = make_clamped_bar(across, 6, 0.1, {1e6, 0.3, 1000, 0, 0}, Clamped::BothEnds);
    bar.model.gravity.setZero();
    Transform turn;
    turn.rotate.x() = kTurn;
    bar.model.pins[1].track = {{{0, turn, Ease::Constant}}};
    const StaticAnswer answer = find_static_answer(bar.model, uncapped_params());
    const auto twist_at = [&](double x) { return section_twist(bar, section_nodes(bar, x), answer.positions); };
    const double torque = 2 * answer.elastic_energy / kTurn, twist = (twist_at(0.4) - twist_at(0.2)) / 0.2;
    return torque / (bar.model.materials.front().lame_mu() * std::pow(bar.width, 4) * twist) / square_torsion_factor() -
           1;
  };
  const double coarse = error(4), fine = error(8);
  EXPECT_GT(fine, 0);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2);
}

/// Errors of a method in the last three steps of a motion, at a tight tolerance.
double step_order(const MotionProblem& problem, Integrator integrator, Linearize linearize) {
  Method method{"", "", true, "", {1e-7}, 1, [=](const BodyModel& model, double tolerance, const Threads& threads) {
                  return make_softreel(model, scheme_params(integrator, linearize, tolerance), threads);
                }};
  Pace pace;
  return order_in_step(sweep(problem, {method}, pace), "", 0).order;
}

TEST(Precision, DroppedBarShowsTheOrderOfEachScheme) {
  MotionProblem problem = drop_problem(2, 6);
  problem.steps.erase(problem.steps.begin(), problem.steps.end() - 3);
  EXPECT_NEAR(step_order(problem, Integrator::Euler, Linearize::Start), 1, 0.2);
  EXPECT_NEAR(step_order(problem, Integrator::Euler, Linearize::Iterated), 1, 0.2);
  // The pins' stop is a jump of their acceleration, which costs the second order a little of itself.
  EXPECT_GT(step_order(problem, Integrator::Bdf2, Linearize::Predictor), 1.5);
  EXPECT_GT(step_order(problem, Integrator::Bdf2, Linearize::Iterated), 1.5);
  EXPECT_GT(step_order(problem, Integrator::Newmark, Linearize::Predictor), 1.5);
  EXPECT_GT(step_order(problem, Integrator::Newmark, Linearize::Iterated), 1.5);
  // Linearised at the start, no integrator is of more than the first order in the limit (design 4.4).
  EXPECT_LT(step_order(problem, Integrator::Newmark, Linearize::Start), 1.5);
}

TEST(Precision, SettlesToTheEquilibriumOfItsMesh) {
  const MotionProblem problem = settling_problem(3);
  for (const auto& [integrator, linearize] :
       {std::pair(Integrator::Euler, Linearize::Start), std::pair(Integrator::Bdf2, Linearize::Predictor),
        std::pair(Integrator::Euler, Linearize::Iterated), std::pair(Integrator::Newmark, Linearize::Iterated)}) {
    Method method{"", "", true, "", {}, 1, [=](const BodyModel& model, double tolerance, const Threads& threads) {
                    return make_softreel(model, scheme_params(integrator, linearize, tolerance), threads);
                  }};
    const WorkPoint point = run_motion(problem, method, 1.0 / 96, 1e-6);
    EXPECT_LT(point.error, 1e-4) << point.failure;
  }
}

TEST(Precision, SwingsWithTimoshenkosFrequency) {
  Method method{"", "", true, "", {}, 1, [](const BodyModel& model, double tolerance, const Threads& threads) {
                  return make_softreel(model, scheme_params(Integrator::Bdf2, Linearize::Predictor, tolerance),
                                       threads);
                }};
  const WorkPoint coarse = run_motion(vibration_problem(2), method, 1.0 / 96, 1e-4),
                  fine = run_motion(vibration_problem(4), method, 1.0 / 96, 1e-4);
  EXPECT_LT(fine.error, 0.05) << fine.failure;
  EXPECT_GT(fine.value, timoshenko_frequency({}));  // too stiff
  EXPECT_GT(std::log2(coarse.error / fine.error), 1.8) << coarse.failure;
}

/// Moves as a whole, up and down.
class Swing : public Stepper {
 public:
  explicit Swing(std::size_t nodes) : vectors_(nodes, Vec3::Zero()) {}
  void set(double velocity) { vectors_.assign(vectors_.size(), Vec3(0, velocity, 0)); }
  void step(double, double) override {}
  std::span<const Vec3> positions() const override { return vectors_; }
  std::span<const Vec3> velocities() const override { return vectors_; }

 private:
  std::vector<Vec3> vectors_;
};

TEST(Precision, MeasuresTheFrequencyOfOnePeriodHoweverLongItLooks) {
  constexpr double kFrequency = 0.47, kDelta = 0.01;
  const MotionProblem problem = vibration_problem(1);
  Swing swing(problem.model.mesh.nodes.size());
  for (const double periods : {1.7, 3.2}) {
    const auto observer = problem.observe();
    for (int k = 1; kFrequency * k * kDelta < periods; ++k) {
      const double time = k * kDelta;
      // After its third zero, at one and a half periods, it is another motion.
      const double late = std::max(0.0, kFrequency * time - 1.6);
      swing.set(std::sin(2 * std::numbers::pi * (kFrequency * time + late)));
      observer->look(time, swing);
    }
    EXPECT_NEAR(observer->finding().value, kFrequency, 1e-3 * kFrequency) << periods;
  }
}

TEST(Precision, GivesNoFrequencyOfLessThanThreeZeros) {
  const MotionProblem problem = vibration_problem(1);
  Swing swing(problem.model.mesh.nodes.size());
  const auto observer = problem.observe();
  for (int k = 1; k <= 3; ++k) {
    swing.set(k == 2 ? -1 : 1);
    observer->look(k, swing);
  }
  EXPECT_FALSE(observer->finding().failure.empty());
}

TEST(Precision, TimesAShortRunThreeTimesAndALongOneOnce) {
  std::vector<double> more{0.02, 0.5};
  const auto again = [&more] {
    const double seconds = more.back();
    more.pop_back();
    return seconds;
  };
  EXPECT_EQ(steady_seconds(2, again), 2);
  EXPECT_EQ(more.size(), 2U);
  EXPECT_EQ(steady_seconds(0.05, again), 0.05);
  EXPECT_TRUE(more.empty());
}

TEST(Precision, LeadsAnErrorOfFirstOrderOnToNothing) {
  const std::vector<Vec3> truth{Vec3(1, 2, 3), Vec3(-1, 0, 2)}, slope{Vec3(0.1, 0, -0.2), Vec3(0, 0.3, 0.1)};
  const auto samples_at = [&](double edge) {
    ShapeSamples samples;
    samples.times = {0, 1};
    for (const double time : samples.times) {
      std::vector<Vec3> shape;
      for (std::size_t i = 0; i < truth.size(); ++i) shape.emplace_back((1 + time) * truth[i] + edge * slope[i]);
      samples.positions.push_back(shape);
    }
    return samples;
  };
  const ShapeSamples limit = led_on(samples_at(0.4), samples_at(1), 2.5);
  EXPECT_LT(rms_distance(limit, samples_at(0)), 1e-14);
  EXPECT_NEAR(rms_distance(limit, samples_at(1)), std::sqrt((0.05 + 0.1) / 2), 1e-12);
}

TEST(Precision, FrontKeepsWhatNoOtherPointBeats) {
  const auto point = [](double seconds, double error) {
    WorkPoint p;
    p.seconds = seconds;
    p.error = error;
    return p;
  };
  const std::vector<WorkPoint> front =
      pareto_front({point(3, 0.1), point(1, 0.5), point(2, 0.6), point(4, 0.2), point(0.5, kNone)});
  ASSERT_EQ(front.size(), 2u);
  EXPECT_EQ(front[0].seconds, 1);
  EXPECT_EQ(front[1].seconds, 3);
}

TEST(Precision, FitsTheOrderOfAPower) {
  const std::vector<double> sizes{0.4, 0.2, 0.1}, errors{0.48, 0.12, 0.03};
  EXPECT_NEAR(fitted_order(sizes, errors), 2, 1e-12);
}

}  // namespace
}  // namespace softreel::bench
