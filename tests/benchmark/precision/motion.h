/// A body moved through time by each method, step and tolerance, and what comes of it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/benchmark/precision/methods.h"

namespace softreel::bench {

/// Frames a second: constraints are keyed in frames.
inline constexpr double kFps = 24;

/// Looks at a motion after each of its steps; not timed.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void look(double time, const Stepper& stepper) = 0;
  struct Finding {
    double value = kNone;
    double error = kNone;  ///< relative
    std::string failure;   ///< why there is no error
  };
  virtual Finding finding() const = 0;
};

struct MotionProblem {
  std::string name;
  BodyModel model;
  double seconds = 0;         ///< that the motion lasts
  std::vector<double> steps;  ///< s, each half of the one before or less; frames are multiples of all of them
  double most_seconds = 10;   ///< processor time of a run; a setting that is expected to take more is left out
  std::function<std::unique_ptr<Observer>()> observe = {};
};

/// One run; a short one is repeated for its time (steady_seconds). tolerance: kNone for a method that has none.
WorkPoint run_motion(const MotionProblem& problem, const Method& method, double step, double tolerance);

/// Processor times to expect of runs, from those of the same method that were made: in proportion to elements and
/// steps.
class Pace {
 public:
  /// s; 0 if the method with this tolerance was not seen yet.
  double expected(const MotionProblem& problem, const Method& method, double step, double tolerance) const;
  void saw(const WorkPoint& point, const MotionProblem& problem);

 private:
  std::map<std::string, double> seconds_;  ///< of one element and step, per method and tolerance
};

/// Every method at every tolerance and step, from the longest step on. pace: of the problem's other meshes too.
std::vector<WorkPoint> sweep(const MotionProblem& problem, const std::vector<Method>& methods, Pace& pace);

/// Positions at given times, compared to a reference: the error is the root mean square distance of all points and
/// times over `scale`, the value the mean y displacement of `watched` at the last time.
struct ShapeSamples {
  std::vector<double> times;                 ///< s
  std::vector<std::vector<Vec3>> positions;  ///< per time
};

/// What of a stepper's nodes is compared: all of them, or the surface they carry.
using ShapeMap = std::function<std::vector<Vec3>(std::span<const Vec3> positions)>;

/// The samples of a motion that a reference method makes. Throws std::runtime_error if it fails.
ShapeSamples find_samples(const MotionProblem& problem, const Method& method, double step, double tolerance,
                          const std::vector<double>& times, const ShapeMap& map);

/// Where meshes of ever shorter edges lead by first order: the two have edges of 1 and `edge_ratio` > 1.
ShapeSamples led_on(const ShapeSamples& fine, const ShapeSamples& coarse, double edge_ratio);

/// Root mean square over points and times, m.
double rms_distance(const ShapeSamples& a, const ShapeSamples& b);

/// rest, watched: of the mapped points.
std::unique_ptr<Observer> observe_shape(ShapeSamples reference, double scale, const ShapeMap& map,
                                        std::vector<Vec3> rest, std::vector<Index> watched);

/// Distance of two shapes: root mean square over points, m.
double rms_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

/// Steps of a frame over 1, 2, 4 ... 2^(count - 1).
std::vector<double> halved_frames(int count);

}  // namespace softreel::bench
