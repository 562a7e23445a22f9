#include "tests/benchmark/dial/dial.h"

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/benchmark/dial/dial_study.h"

namespace softreel::bench {
namespace {

std::vector<DialProblem> problems(bool quick) {
  const std::string bends = "A bar held at one end bends under its weight, in equilibrium";
  const std::string falls = "The same bar, stiffer, dropped: 18 frames of its swing";
  const std::string twists = "A bar twisted by half a turn, in equilibrium at 45, 90, 135 and 180 degrees";
  const std::string moves = "The creature, pressed down and pulled up by its head: 18 frames";
  if (quick)
    return {{"static_bar", bends, 16, 0, 40000, {0.05, 0.01}},
            {"falling_bar", falls, 12, 0, 20000, {0.05, 0.02}},
            {"twist", twists, 12, 0, 20000, {0.05, 0.01}},
            {"creature", moves, 0, 64000, 20000, {0.05, 0.02}}};
  const std::vector<double> errors{0.05, 0.02, 0.01, 0.005};
  return {{"static_bar", bends, 20, 0, 250000, errors},
          {"falling_bar", falls, 24, 0, 100000, errors},
          {"twist", twists, 16, 0, 150000, errors},
          {"creature", moves, 0, 256000, 60000, {0.05, 0.02, 0.01}}};
}

Table new_table() {
  return {"dial",
          "Each turn of the dial; errors in % of the diagonal of the body's box",
          {"problem", "asked", "tetrahedra", "steps a frame", "tolerance", "mesh", "time", "solver", "believed", "true",
           "believed / true", "within a factor of 2", "asked is in reach", "order of mesh", "order of steps", "pilots",
           "finest pilot", "pilots cpu s", "run cpu s"},
          {}};
}

void add_rows(const DialProblem& problem, const DialStudy& study, Table& table) {
  for (const DialTurn& turn : study.turns) {
    const DialChoice& choice = turn.choice;
    const ErrorParts& parts = choice.believed;
    table.add({problem.name, 100 * turn.asked, static_cast<long>(choice.chosen.tets),
               static_cast<long>(choice.chosen.substeps), choice.chosen.tolerance, 100 * parts.mesh, 100 * parts.time,
               100 * parts.algebra, 100 * parts.total(), 100 * turn.truth, turn.ratio(),
               std::string(name_of(judge(turn, study.truth_doubt))), std::string(choice.reached ? "yes" : "no"),
               choice.mesh_order, choice.step_order, static_cast<long>(choice.pilots),
               static_cast<long>(choice.finest_pilot), turn.pilot_seconds, turn.seconds});
  }
}

Plot new_plot() {
  Plot plot{"dial",
            "Error believed against true error, and the band of a factor of two",
            "true error / % of the box's diagonal",
            "believed error / % of the box's diagonal",
            true,
            true,
            {}};
  const std::vector<double> ends{0.1, 5};
  for (const auto& [label, factor] :
       {std::pair("believed = true", 1.0), std::pair("twice", 2.0), std::pair("half", 0.5)})
    plot.series.push_back({label, ends, {factor * ends[0], factor * ends[1]}, factor == 1, false});
  return plot;
}

Series series_of(const DialProblem& problem, const DialStudy& study) {
  Series series{problem.name, {}, {}, false, true};
  for (const DialTurn& turn : study.turns) {
    series.x.push_back(100 * turn.truth);
    series.y.push_back(100 * turn.choice.believed.total());
  }
  return series;
}

/// What of a study is judged to be so, in words; empty: nothing.
std::string turns_that_are(Honesty honesty, const DialProblem& problem, const DialStudy& study) {
  std::string text;
  for (const DialTurn& turn : study.turns)
    if (judge(turn, study.truth_doubt) == honesty)
      text += fmt::format(" {} at {:g} %: believed {:.2g} %, true {:.2g} % (doubt {:.2g} %), a factor of {:.2g}.",
                          problem.name, 100 * turn.asked, 100 * turn.choice.believed.total(), 100 * turn.truth,
                          100 * study.truth_doubt, turn.ratio());
  return text;
}

}  // namespace

void run_dial(const BenchOptions& options, Report& report) {
  report.say(
      "`solver.error` asks for an error of the motion: root mean square distance of the surface's vertices from where "
      "ever finer meshes and steps would take them, in the worst frame, over the diagonal of the body's box. softreel "
      "chooses tetrahedra, steps and tolerance by pilots on coarse meshes and says the error it believes its run to "
      "have. Wanted: within a factor of 2 of the true one. Shots: `tests/benchmark/dial/*.toml`, for example `softreel "
      "simulate tests/benchmark/dial/twist.toml --set solver.error=1%`. Integrator BDF2, one thread; "
      "pilots of a second turn find their meshes made.");
  report.say(fmt::format(
      "Truth, bars: tetrahedra of cubes whose planes lie where the pins end, made by this benchmark and led "
      "on from two sizes by an assumed order of {:g}, since the error of softreel's own meshes is mostly "
      "that a pin holds whole tetrahedra and so ends up to an edge further than was selected. Truth, "
      "creature: softreel's own finer meshes led on by first order, which shares what pins do to them. "
      "Steps of an eighth of a frame, corrected by steps of a 32nd. A belief is within a factor of 2, or "
      "outside, only if it is wherever the truth may be: it may be wrong by as much as it was led on.",
      kBarOrder));
  Table table = new_table();
  Plot plot = new_plot();
  int turns = 0;
  std::map<Honesty, int> counts;
  std::string missed, undecided, doubts;
  for (const DialProblem& problem : problems(options.quick)) {
    const DialStudy study = study_dial(problem);
    add_rows(problem, study, table);
    plot.series.push_back(series_of(problem, study));
    for (const DialTurn& turn : study.turns) {
      ++turns;
      ++counts[judge(turn, study.truth_doubt)];
    }
    missed += turns_that_are(Honesty::Outside, problem, study);
    undecided += turns_that_are(Honesty::Undecided, problem, study);
    doubts += fmt::format(" {}: {:.2g} %.", problem.name, 100 * study.truth_doubt);
    report.say(problem.title + ".");
    fmt::print("  {}\n", problem.name);
    std::fflush(stdout);
  }
  report.add(plot);
  report.add(table);
  report.say(fmt::format("{} of {} beliefs are surely within a factor of 2 of the truth, {} surely outside; of {} the "
                         "truth is not known well enough to say.",
                         counts[Honesty::Within], turns, counts[Honesty::Outside], counts[Honesty::Undecided]) +
             (missed.empty() ? "" : " Outside:" + missed) + (undecided.empty() ? "" : " Undecided:" + undecided));
  report.say("How far the truth is led on beyond its finest mesh, which bounds what it can be wrong by:" + doubts);
}

}  // namespace softreel::bench
