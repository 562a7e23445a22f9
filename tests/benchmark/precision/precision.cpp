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

/// Methods with runs that failed, or that ended farther from the truth than doing nothing: fronts do not show them.
std::string failures_of(const std::vector<WorkPoint>& points) {
  struct Count {
    int runs = 0, failed = 0, astray = 0;
    std::string why;
  };
  std::map<std::string, Count> counts;
  for (const WorkPoint& p : points) {
    Count& count = counts[p.method];
    ++count.runs;
    if (p.error > 1) ++count.astray;
    if (p.failure.empty()) continue;
    ++count.failed;
    count.why = p.failure;
  }
  std::string text;
  for (const auto& [method, count] : counts) {
    if (count.failed > 0)
      text += fmt::format(" {}: {} of {} runs failed ({}).", method, count.failed, count.runs, count.why);
    if (count.astray > 0)
      text += fmt::format(" {}: {} of {} runs end with an error above 1.", method, count.astray, count.runs);
  }
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
      "are fronts: of a method's runs over meshes, steps and tolerances those that no other of its runs beats in both. "
      "One thread each; a run under 0.1 s is made three times, its time the middle one. softreel runs with `dilatation "
      "= linear`, the material that everyone else has. Runs in motion "
      "that are expected to take longer than a few seconds (with `--quick` half a second) are left out, alike for all "
      "methods; the table of costs says - where no run that was made is so right. `precision.tsv` has all runs.");
  report.add(method_table(all_methods()));

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
  report.add(cost_table("precision_cost", all));
  report.say(
      "Orders. One far above what is expected says that the longest of the three steps was still unstable; below it, "
      "that the motion is not smooth (the drop) or that the steps are still long.");
  report.add(orders);
  write_tsv(point_table("precision", "All runs", all), report.folder() / "precision.tsv");
}

}  // namespace softreel::bench
