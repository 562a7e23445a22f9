#include "tests/benchmark/precision/work_precision.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/benchmark/bar_problem.h"

namespace softreel::bench {
namespace {

/// Of the error before, for a point to be on the front: what is less is solver noise.
constexpr double kWorthIt = 0.99;

/// Distinct names in the order of their first use.
std::vector<std::string> names_of(const std::vector<WorkPoint>& points, std::string WorkPoint::*name) {
  std::vector<std::string> names;
  for (const WorkPoint& point : points)
    if (std::find(names.begin(), names.end(), point.*name) == names.end()) names.push_back(point.*name);
  return names;
}

std::vector<WorkPoint> points_of(const std::vector<WorkPoint>& points, std::string WorkPoint::*name,
                                 const std::string& wanted) {
  std::vector<WorkPoint> found;
  for (const WorkPoint& point : points)
    if (point.*name == wanted) found.push_back(point);
  return found;
}

/// Over the last three entries, of falling size; kNone if there are fewer.
double order_of_last(std::span<const double> sizes, std::span<const double> errors) {
  constexpr std::size_t kUsed = 3;
  if (sizes.size() < kUsed) return kNone;
  return fitted_order(sizes.last(kUsed), errors.last(kUsed));
}

}  // namespace

double steady_seconds(double first, const std::function<double()>& again) {
  constexpr double kLongEnough = 0.1;
  constexpr std::size_t kRuns = 3;
  std::vector<double> seconds{first};
  while (first < kLongEnough && seconds.size() < kRuns) seconds.push_back(again());
  return benchmark_support::median(std::move(seconds));
}

std::vector<WorkPoint> pareto_front(std::vector<WorkPoint> points) {
  std::erase_if(points, [](const WorkPoint& point) { return !std::isfinite(point.error); });
  std::stable_sort(points.begin(), points.end(),
                   [](const WorkPoint& a, const WorkPoint& b) { return a.seconds < b.seconds; });
  std::vector<WorkPoint> front;
  for (const WorkPoint& point : points)
    if (front.empty() || point.error < kWorthIt * front.back().error) front.push_back(point);
  return front;
}

double fitted_order(std::span<const double> sizes, std::span<const double> errors) {
  const auto n = static_cast<double>(sizes.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double a = std::log(sizes[i]), b = std::log(errors[i]);
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

OrderRow order_in_mesh(const std::vector<WorkPoint>& points, const std::string& method, double expected) {
  std::map<long, double> least;
  for (const WorkPoint& p : points)
    if (p.method == method && std::isfinite(p.error)) {
      const auto [at, added] = least.emplace(p.tets, p.error);
      at->second = std::min(at->second, p.error);
    }
  std::vector<double> sizes, errors;
  for (const auto& [tets, error] : least) {
    sizes.push_back(std::cbrt(1 / static_cast<double>(tets)));
    errors.push_back(error);
  }
  return {points.front().problem, method, "mesh width", order_of_last(sizes, errors), expected};
}

OrderRow order_in_step(const std::vector<WorkPoint>& points, const std::string& method, double expected) {
  long most = 0;
  double tightest = std::numeric_limits<double>::infinity();
  for (const WorkPoint& p : points)
    if (p.method == method) most = std::max(most, p.tets);
  for (const WorkPoint& p : points)
    if (p.method == method && p.tets == most && p.tolerance < tightest) tightest = p.tolerance;
  std::vector<double> sizes, errors;
  for (const WorkPoint& p : points)
    if (p.method == method && p.tets == most && p.tolerance == tightest && std::isfinite(p.error)) {
      sizes.push_back(p.step);
      errors.push_back(p.error);
    }
  return {points.front().problem, method, "time step", order_of_last(sizes, errors), expected};
}

Table point_table(const std::string& name, const std::string& title, const std::vector<WorkPoint>& points) {
  Table table{name,
              title,
              {"problem", "method", "tets", "step / s", "tolerance", "cpu seconds", "value", "relative error"},
              {}};
  for (const WorkPoint& p : points)
    table.add({p.problem, p.method, p.tets, p.step, p.tolerance, p.seconds, p.value,
               p.failure.empty() ? Cell(p.error) : Cell("failed: " + p.failure)});
  return table;
}

Table cost_table(const std::string& name, const std::vector<WorkPoint>& points) {
  Table table{name,
              "What an error costs: cpu seconds of the cheapest run that is at most so wrong",
              {"problem", "curve", "10 %", "1 %", "0.1 %", "least error"},
              {}};
  for (const std::string& problem : names_of(points, &WorkPoint::problem)) {
    const std::vector<WorkPoint> of_problem = points_of(points, &WorkPoint::problem, problem);
    for (const std::string& curve : names_of(of_problem, &WorkPoint::curve)) {
      const std::vector<WorkPoint> front = pareto_front(points_of(of_problem, &WorkPoint::curve, curve));
      if (front.empty()) continue;
      std::vector<Cell> row{problem, curve};
      for (const double error : {0.1, 0.01, 0.001}) {
        const auto at =
            std::find_if(front.begin(), front.end(), [&](const WorkPoint& point) { return point.error <= error; });
        row.emplace_back(at == front.end() ? kNone : at->seconds);
      }
      row.emplace_back(front.back().error);
      table.add(std::move(row));
    }
  }
  return table;
}

std::vector<WorkPoint> fronts_of_methods(const std::vector<WorkPoint>& points) {
  std::vector<WorkPoint> all;
  for (const std::string& method : names_of(points, &WorkPoint::method)) {
    const std::vector<WorkPoint> front = pareto_front(points_of(points, &WorkPoint::method, method));
    all.insert(all.end(), front.begin(), front.end());
  }
  return all;
}

Plot front_plot(const std::string& name, const std::string& title, const std::vector<WorkPoint>& points) {
  Plot plot{name, title, "cpu seconds", "relative error", true, true, {}};
  for (const std::string& curve : names_of(points, &WorkPoint::curve)) {
    Series series{curve, {}, {}, false, false};
    for (const WorkPoint& point : pareto_front(points_of(points, &WorkPoint::curve, curve))) {
      series.ours = point.ours;
      series.x.push_back(point.seconds);
      series.y.push_back(point.error);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

}  // namespace softreel::bench
