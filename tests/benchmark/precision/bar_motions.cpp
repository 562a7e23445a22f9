#include "tests/benchmark/precision/bar_motions.h"

#include <cmath>

#include "core/elasticity/mass.h"
#include "tests/benchmark/precision/beam_theory.h"
#include "tests/benchmark/precision/static_answer.h"

namespace softreel::bench {
namespace {

constexpr double kGravity = 9.81;
constexpr ElementMaterial kFlesh{1e6, 0.4, 1000, 0, 0};  ///< of the targets' bar, without its damping

Bar targets_bar(Index across, double damping_mass) {
  ElementMaterial material = kFlesh;
  material.damping_mass = damping_mass;
  Bar bar = make_clamped_bar(across, 4, 0.25, material, Clamped::LowEnd);
  bar.model.gravity = Vec3(0, -kGravity, 0);
  return bar;
}

/// Frequency of a swing about a shifted place, from the first kZeros zeros of the first mode's velocity: of slow and
/// fast methods the same part of the swing.
class FrequencyObserver : public Observer {
 public:
  FrequencyObserver(const Bar& bar, double truth) : truth_(truth) {
    const NodalMasses masses = lump_masses(bar.model.mesh, bar.model.materials);
    for (std::size_t i = 0; i < bar.model.mesh.nodes.size(); ++i) {
      const double s = bar.model.mesh.nodes[i].x() / bar.length;
      weights_.push_back(s > 0 ? masses.mass[i] * s * s * (6 - 4 * s + s * s) : 0.0);
    }
  }
  void look(double time, const Stepper& stepper) override {
    double velocity = 0;
    const auto velocities = stepper.velocities();
    for (std::size_t i = 0; i < weights_.size(); ++i) velocity += weights_[i] * velocities[i].y();
    if (velocity * last_velocity_ < 0 && zeros_ < kZeros) {
      const double zero = last_time_ + (time - last_time_) * last_velocity_ / (last_velocity_ - velocity);
      if (zeros_ == 0) first_zero_ = zero;
      last_zero_ = zero;
      ++zeros_;
    }
    last_time_ = time;
    last_velocity_ = velocity;
  }
  Finding finding() const override {
    if (zeros_ < kZeros) return {kNone, kNone, "it did not swing to and fro"};
    const double frequency = (kZeros - 1) / (2 * (last_zero_ - first_zero_));
    return {frequency, std::abs(frequency / truth_ - 1), ""};
  }

 private:
  static constexpr int kZeros = 3;
  double truth_;
  std::vector<double> weights_;
  double last_time_ = 0, last_velocity_ = 0, first_zero_ = 0, last_zero_ = 0;
  int zeros_ = 0;
};

class TipObserver : public Observer {
 public:
  TipObserver(Bar bar, double truth) : bar_(std::move(bar)), tip_(section_nodes(bar_, bar_.length)), truth_(truth) {}
  void look(double, const Stepper& stepper) override {
    value_ = mean_displacement(bar_, tip_, stepper.positions()).y();
  }
  Finding finding() const override {
    if (!std::isfinite(value_)) return {kNone, kNone, "positions are no numbers"};
    return {value_, std::abs(value_ / truth_ - 1), ""};
  }

 private:
  Bar bar_;
  std::vector<Index> tip_;
  double truth_, value_ = kNone;
};

}  // namespace

MotionProblem vibration_problem(Index across) {
  const Beam beam;
  Bar bar = make_clamped_bar(across, 10, beam.width, {beam.youngs_modulus, beam.poisson_ratio, beam.density, 0, 0},
                             Clamped::LowEnd);
  bar.model.gravity = Vec3(0, -1e-4 * kGravity, 0);
  // Two and a quarter periods by theory: a method may be slower by a third and still show its third zero.
  MotionProblem problem{"vibration", bar.model, 4.5, halved_frames(5), 10, {}};
  problem.observe = [bar, truth = timoshenko_frequency(beam)] {
    return std::make_unique<FrequencyObserver>(bar, truth);
  };
  return problem;
}

MotionProblem drop_problem(Index across, int halvings) {
  Bar bar = targets_bar(across, 0.1);
  // 3 t^2 - 2 t^3 over T seconds starts with the acceleration 6 d / T^2: here that of free fall, so that nothing of the
  // body is shaken at the start.
  constexpr double kCaught = 10;  // frame
  Transform below;
  below.translate.y() = -kGravity * (kCaught / kFps) * (kCaught / kFps) / 6;
  bar.model.pins[0].track = {{{0, Transform{}, Ease::Smooth}, {kCaught, below, Ease::Smooth}}};
  MotionProblem problem{"drop", bar.model, 14 / kFps, halved_frames(halvings), 10, {}};
  const ShapeMap all = [](std::span<const Vec3> positions) {
    return std::vector<Vec3>(positions.begin(), positions.end());
  };
  const std::vector<double> times{4 / kFps, 7 / kFps, kCaught / kFps, 14 / kFps};
  const Method exact{"reference", "", true, "", {kNone}, 1, [](const BodyModel& model, double, const Threads& threads) {
                       return make_softreel(model, scheme_params(Integrator::Newmark, Linearize::Iterated, 1e-7),
                                            threads);
                     }};
  const ShapeSamples reference = find_samples(problem, exact, problem.steps.back() / 4, kNone, times, all);
  problem.observe = [bar, reference, all] {
    return observe_shape(reference, bar.length, all, bar.model.mesh.nodes, section_nodes(bar, bar.length));
  };
  return problem;
}

MotionProblem settling_problem(Index across) {
  const Bar bar = targets_bar(across, 16);
  SolverParams params = uncapped_params();
  params.force_tolerance = 1e-9;
  const double truth =
      mean_displacement(bar, section_nodes(bar, bar.length), find_static_answer(bar.model, params).positions).y();
  MotionProblem problem{"settling", bar.model, 2, halved_frames(4), 10, {}};
  problem.observe = [bar, truth] { return std::make_unique<TipObserver>(bar, truth); };
  return problem;
}

}  // namespace softreel::bench
