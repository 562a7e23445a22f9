#include "tests/benchmark/precision/motion.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "tests/benchmark/bench.h"

namespace softreel::bench {
namespace {

/// Steps to the end; returns the processor time. Throws what the stepper throws.
double move(const MotionProblem& problem, const Method& method, double step, double tolerance, Observer& observer) {
  const Threads threads(1);
  const auto steps = std::lround(problem.seconds / step);
  double seconds = 0, start = process_seconds();
  const std::unique_ptr<Stepper> stepper = method.make(problem.model, tolerance, threads);
  for (long k = 1; k <= steps; ++k) {
    const double time = static_cast<double>(k) * step;
    stepper->step(time * kFps, step);
    seconds += process_seconds() - start;
    observer.look(time, *stepper);
    start = process_seconds();
  }
  return seconds;
}

/// Index of the time that `time` is, or -1.
int index_of(const std::vector<double>& times, double time) {
  for (std::size_t i = 0; i < times.size(); ++i)
    if (std::abs(times[i] - time) < 1e-9) return static_cast<int>(i);
  return -1;
}

std::string pace_key(const std::string& method, double tolerance) {
  return fmt::format("{} {}", method, tolerance);
}

/// Elements times steps.
double work_of(const MotionProblem& problem, double step) {
  return static_cast<double>(problem.model.mesh.tets.size()) * problem.seconds / step;
}

/// Of a run that is made again for its time only.
class Blind : public Observer {
 public:
  void look(double, const Stepper&) override {}
  Finding finding() const override { return {}; }
};

class Recorder : public Observer {
 public:
  Recorder(std::vector<double> times, ShapeMap map) : map_(std::move(map)) { samples_.times = std::move(times); }
  void look(double time, const Stepper& stepper) override {
    if (index_of(samples_.times, time) >= 0) samples_.positions.push_back(map_(stepper.positions()));
  }
  Finding finding() const override { return {}; }
  const ShapeSamples& samples() const { return samples_; }

 private:
  ShapeMap map_;
  ShapeSamples samples_;
};

class ShapeObserver : public Observer {
 public:
  ShapeObserver(ShapeSamples reference, double scale, ShapeMap map, std::vector<Vec3> rest, std::vector<Index> watched)
      : reference_(std::move(reference)),
        scale_(scale),
        map_(std::move(map)),
        rest_(std::move(rest)),
        watched_(std::move(watched)) {}

  void look(double time, const Stepper& stepper) override {
    const int i = index_of(reference_.times, time);
    if (i < 0) return;
    const std::vector<Vec3> shape = map_(stepper.positions());
    const double distance = rms_distance(shape, reference_.positions[static_cast<std::size_t>(i)]);
    squares_ += distance * distance;
    ++looked_;
    value_ = 0;
    for (const Index point : watched_) {
      const auto p = static_cast<std::size_t>(point);
      value_ += (shape[p].y() - rest_[p].y()) / static_cast<double>(watched_.size());
    }
  }
  Finding finding() const override {
    if (looked_ != reference_.times.size()) return {value_, kNone, "it did not get to its end"};
    const double error = std::sqrt(squares_ / static_cast<double>(looked_)) / scale_;
    if (!std::isfinite(error)) return {value_, kNone, "positions are no numbers"};
    return {value_, error, ""};
  }

 private:
  ShapeSamples reference_;
  double scale_;
  ShapeMap map_;
  std::vector<Vec3> rest_;
  std::vector<Index> watched_;
  double squares_ = 0, value_ = kNone;
  std::size_t looked_ = 0;
};

}  // namespace

WorkPoint run_motion(const MotionProblem& problem, const Method& method, double step, double tolerance) {
  WorkPoint point;
  point.problem = problem.name;
  point.method = method.label;
  point.curve = method.curve;
  point.ours = method.ours;
  point.tets = static_cast<long>(problem.model.mesh.tets.size());
  point.step = step / method.finer;
  point.tolerance = tolerance;
  const std::unique_ptr<Observer> observer = problem.observe();
  const double start = process_seconds();
  try {
    point.seconds = move(problem, method, point.step, tolerance, *observer);
    Blind blind;
    point.seconds = steady_seconds(point.seconds, [&] { return move(problem, method, point.step, tolerance, blind); });
    const Observer::Finding finding = observer->finding();
    point.value = finding.value;
    point.error = finding.error;
    point.failure = finding.failure;
  } catch (const std::runtime_error& error) {
    point.seconds = process_seconds() - start;
    point.failure = error.what();
  }
  return point;
}

double Pace::expected(const MotionProblem& problem, const Method& method, double step, double tolerance) const {
  const auto at = seconds_.find(pace_key(method.label, tolerance));
  return at == seconds_.end() ? 0 : at->second * work_of(problem, step / method.finer);
}

void Pace::saw(const WorkPoint& point, const MotionProblem& problem) {
  seconds_[pace_key(point.method, point.tolerance)] = point.seconds / work_of(problem, point.step);
}

std::vector<WorkPoint> sweep(const MotionProblem& problem, const std::vector<Method>& methods, Pace& pace) {
  std::vector<WorkPoint> points;
  for (const Method& method : methods)
    for (const double tolerance : method.tolerances)
      for (const double step : problem.steps) {
        if (pace.expected(problem, method, step, tolerance) > problem.most_seconds) break;
        points.push_back(run_motion(problem, method, step, tolerance));
        pace.saw(points.back(), problem);
      }
  return points;
}

ShapeSamples find_samples(const MotionProblem& problem, const Method& method, double step, double tolerance,
                          const std::vector<double>& times, const ShapeMap& map) {
  Recorder recorder(times, map);
  move(problem, method, step, tolerance, recorder);
  if (recorder.samples().positions.size() != times.size())
    throw std::runtime_error(fmt::format("{}: the reference's steps miss the times to be compared", problem.name));
  return recorder.samples();
}

ShapeSamples led_on(const ShapeSamples& fine, const ShapeSamples& coarse, double edge_ratio) {
  ShapeSamples limit = fine;
  for (std::size_t t = 0; t < limit.positions.size(); ++t)
    for (std::size_t i = 0; i < limit.positions[t].size(); ++i)
      limit.positions[t][i] += (fine.positions[t][i] - coarse.positions[t][i]) / (edge_ratio - 1);
  return limit;
}

double rms_distance(const ShapeSamples& a, const ShapeSamples& b) {
  double squares = 0;
  for (std::size_t t = 0; t < a.positions.size(); ++t)
    squares += std::pow(rms_distance(a.positions[t], b.positions[t]), 2);
  return std::sqrt(squares / static_cast<double>(a.positions.size()));
}

std::unique_ptr<Observer> observe_shape(ShapeSamples reference, double scale, const ShapeMap& map,
                                        std::vector<Vec3> rest, std::vector<Index> watched) {
  return std::make_unique<ShapeObserver>(std::move(reference), scale, map, std::move(rest), std::move(watched));
}

double rms_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]).squaredNorm();
  return std::sqrt(squares / static_cast<double>(a.size()));
}

std::vector<double> halved_frames(int count) {
  std::vector<double> steps;
  for (int k = 0; k < count; ++k) steps.push_back(1 / (kFps * (1 << k)));
  return steps;
}

}  // namespace softreel::bench
