#include "tests/benchmark/precision/precision.h"

#include <cmath>
#include <cstdio>
#include <map>

#include <fmt/format.h>

#include "tests/benchmark/precision/bar_statics.h"
#include "tests/benchmark/precision/creature.h"
#include "tests/benchmark/precision/methods.h"
#include "tests/benchmark/precision/moving_bars.h"

namespace softreel::bench {
namespace {

/// Name of a problem in file names.
std::string file_name(const std::string& problem) {
  std::string name = "precision_" + problem;
  for (char& c : name)
    if (c == ' ' || c == ',') c = '_';
  return name;
}

Cell order_cell(double value) {
  return std::isfinite(value) ? Cell(std::stod(fmt::format("{:.2f}", value))) : Cell(kNone);
}

/// Runs that failed, one line a method.
std::string failures_of(const std::vector<WorkPoint>& points) {
  std::map<std::string, std::pair<int, std::string>> failed;
  for (const WorkPoint& p : points)
    if (!p.failure.empty()) {
      auto& [count, why] = failed[p.method];
      ++count;
      why = p.failure;
    }
  std::string text;
  for (const auto& [method, what] : failed)
    text += fmt::format(" {} failed {} times ({}).", method, what.first, what.second);
  return text;
}

void report_problem(const ProblemResult& result, Report& report) {
  report.say(result.title + ". " + result.text + failures_of(result.points));
  const std::string name = file_name(result.name);
  report.add(front_plot(name, result.title, result.points));
  report.add(point_table(name, result.title + ": the front of each method", fronts_of_methods(result.points)));
  for (const Table& table : result.tables) report.add(table);
  fmt::print("  {}\n", result.name);
  std::fflush(stdout);
}

}  // namespace

void run_precision(const BenchOptions& options, Report& report) {
  report.say(
      "Error against processor time, from the mesh to the answer: making the solver and its factors is in it. Curves "
      "are "
      "fronts: of a method's runs over meshes, steps and tolerances those that no other of its runs beats in both. One "
      "thread each. softreel runs with `dilatation = \"linear\"`, the material that everyone else has. `precision.tsv` "
      "has "
      "all runs.");
  std::vector<Method> methods = softreel_schemes();
  for (Method& method : softreel_variants()) methods.push_back(std::move(method));
  for (Method& method : rival_methods()) methods.push_back(std::move(method));
  report.add(method_table(methods));

  std::vector<WorkPoint> all;
  Table orders{"precision_orders",
               "Orders, fitted to the three finest meshes or shortest steps",
               {"problem", "method", "in", "order", "expected"},
               {}};
  const auto take = [&](const ProblemResult& result) {
    report_problem(result, report);
    all.insert(all.end(), result.points.begin(), result.points.end());
    for (const OrderRow& row : result.orders)
      orders.add({row.problem, row.method, row.in, order_cell(row.order), order_cell(row.expected)});
  };
  take(measure_cantilever(options.quick));
  take(measure_elastica(options.quick));
  take(measure_torsion(options.quick));
  take(measure_weighed_bar(options.quick));
  take(measure_vibration(options.quick));
  take(measure_drop(options.quick));
  take(measure_settling(options.quick));
  for (const ProblemResult& result : measure_creature(options.quick)) take(result);
  report.add(orders);
  write_tsv(point_table("precision", "All runs", all), report.folder() / "precision.tsv");
}

}  // namespace softreel::bench
