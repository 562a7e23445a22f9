/// Points of error against work, their fronts, their orders, and what of them the report shows.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "tests/benchmark/report/report.h"

namespace softreel::bench {

inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// One run of one method.
struct WorkPoint {
  std::string problem, method;
  std::string curve;  ///< of the plot; methods of one curve show their common front
  bool ours = false;
  long tets = 0;
  double step = kNone;       ///< s; kNone in statics
  double tolerance = kNone;  ///< of the linear solve, or of the force balance where a step iterates
  double seconds = 0;        ///< processor time from the mesh to the answer
  double value = kNone;      ///< the quantity that the problem asks for
  double error = kNone;      ///< relative; kNone: the run failed
  std::string failure;       ///< why it failed
};

/// Seconds of a run that took `first`: a short one, which one look at the clock does not measure, is made again by
/// `again` (which returns its seconds) until there are three times, of which this is the middle one.
double steady_seconds(double first, const std::function<double()>& again);

/// The points that no other point beats in both time and error, by rising time; each better than the one before by a
/// hundredth of its error or more. Failed ones are none.
std::vector<WorkPoint> pareto_front(std::vector<WorkPoint> points);

/// Slope of log error over log size by least squares: the order, if size is a mesh width or a time step.
double fitted_order(std::span<const double> sizes, std::span<const double> errors);

/// A fitted order beside the one that theory expects.
struct OrderRow {
  std::string problem, method;
  std::string in;  ///< what the error is a power of: "mesh width", "time step"
  double order = kNone, expected = kNone;
};

/// Order in the mesh width, tets^(-1/3), over a method's three finest meshes, each with its least error.
OrderRow order_in_mesh(const std::vector<WorkPoint>& points, const std::string& method, double expected);

/// Order in the time step over a method's three shortest steps, at its finest mesh and tightest tolerance.
OrderRow order_in_step(const std::vector<WorkPoint>& points, const std::string& method, double expected);

/// What one problem adds to the report.
struct ProblemResult {
  std::string name, title;
  std::string text;  ///< what is computed, its truth, and what is to be known of the methods
  std::vector<WorkPoint> points;
  std::vector<OrderRow> orders;
  std::vector<Table> tables;
};

/// Columns problem, method, tets, step, tolerance, cpu seconds, value, error.
Table point_table(const std::string& name, const std::string& title, const std::vector<WorkPoint>& points);

/// Least processor time of each problem and curve to errors of at most 10 %, 1 % and 0.1 %, of the runs that were made.
Table cost_table(const std::string& name, const std::vector<WorkPoint>& points);

/// Each method's front.
std::vector<WorkPoint> fronts_of_methods(const std::vector<WorkPoint>& points);

/// A plot of the fronts of all curves.
Plot front_plot(const std::string& name, const std::string& title, const std::vector<WorkPoint>& points);

}  // namespace softreel::bench
