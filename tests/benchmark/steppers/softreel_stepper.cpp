#include <stdexcept>

#include <fmt/format.h>

#include "tests/benchmark/steppers/stepper.h"

namespace softreel::bench {
namespace {

class SoftreelStepper : public Stepper {
 public:
  SoftreelStepper(BodyModel model, const SolverParams& params, const Threads& threads)
      : simulator_(std::move(model), params, threads, log_, times_) {}

  void step(double frame, double seconds) override {
    const StepReport report = simulator_.step(frame, seconds);
    if (!report.ok())
      throw std::runtime_error(fmt::format("softreel: frame {:g} could not be solved: {}", frame, report.culprit));
  }
  std::span<const Vec3> positions() const override { return simulator_.state().positions; }
  std::span<const Vec3> velocities() const override { return simulator_.state().velocities; }

 private:
  Log log_;
  StageTimes times_;
  Simulator simulator_;
};

}  // namespace

std::unique_ptr<Stepper> make_softreel(BodyModel model, const SolverParams& params, const Threads& threads) {
  return std::make_unique<SoftreelStepper>(std::move(model), params, threads);
}

}  // namespace softreel::bench
