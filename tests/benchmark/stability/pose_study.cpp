#include "tests/benchmark/stability/pose_study.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "tests/benchmark/stability/body_picture.h"
#include "tests/benchmark/stability/held_pose.h"
#include "tests/benchmark/stability/methods.h"

namespace softreel::bench {
namespace {

std::string name_of(Dilatation dilatation) {
  return dilatation == Dilatation::Capped ? "capped" : "linear";
}

std::vector<double> stretches_for(bool quick) {
  if (quick) return {1.5, 3, 4, 6, 10, 20};
  return {1.25, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5, 6, 8, 10, 12, 14, 16, 18, 20};
}

/// The pose nearest to `stretch`; null if there is none.
const HeldPose* pose_at(const std::vector<HeldPose>& poses, double stretch) {
  const HeldPose* nearest = nullptr;
  for (const HeldPose& pose : poses)
    if (nearest == nullptr || std::abs(pose.asked - stretch) < std::abs(nearest->asked - stretch)) nearest = &pose;
  return nearest;
}

void add_row_picture(Report& report, const BarBody& bar, const std::vector<const HeldPose*>& poses,
                     const std::string& name, const std::string& caption) {
  const BodyModel model = make_cantilever_model(bar);
  std::vector<PosedBody> bodies;
  for (const HeldPose* pose : poses) bodies.push_back({&model.mesh, pose->positions, bodies.empty() ? kBlue : kRust});
  add_body_picture(report, in_a_row(std::move(bodies), -Vec3::UnitY(), 0.15), Vec3::UnitZ(), name, "1100x420", caption);
}

}  // namespace

void study_stretch(const BenchOptions& options, Report& report) {
  BarBody bar;
  if (options.quick) bar.cells = {5, 2, 2};
  Table table{
      "stability_stretch",
      fmt::format("Bar of {} x {} x {} cubes, E = {:g} Pa, nu = {:g}, stretched in turn, each held {} s: greatest "
                  "mean rotation change of an element at rest, {} steps a second",
                  bar.cells[0], bar.cells[1], bar.cells[2], bar.material.youngs_modulus, bar.material.poisson_ratio,
                  PosePace{}.settle, PosePace{}.steps_per_second),
      {"scheme", "dilatation", "stretch", "flutter / degrees a step"},
      {}};
  std::vector<const HeldPose*> shown;
  std::vector<std::vector<HeldPose>> kept;
  kept.reserve(2);
  for (const Dilatation dilatation : {Dilatation::Capped, Dilatation::Linear}) {
    Plot plot{"stability_stretch_" + name_of(dilatation),
              "Flutter of a stretched bar at rest, dilatation stress " + name_of(dilatation),
              "stretch",
              "rotation change / degrees a step",
              false,
              false,
              {}};
    for (const Scheme& scheme : kSchemes) {
      SolverParams params = params_of(scheme);
      params.dilatation = dilatation;
      Verdict verdict;
      std::vector<HeldPose> poses = stretch_bar(bar, params, stretches_for(options.quick), {}, verdict);
      Series series{scheme.name, {}, {}, scheme.rotation == RotationMethod::Consistent, false};
      for (const HeldPose& pose : poses) {
        table.add({scheme.name, name_of(dilatation), pose.asked, pose.flutter});
        series.x.push_back(pose.asked);
        series.y.push_back(pose.flutter);
      }
      plot.series.push_back(std::move(series));
      if (!verdict.survived()) report.say(fmt::format("{}, {}: {}", scheme.name, name_of(dilatation), verdict.failure));
      if (&scheme == &kSchemes[0]) {
        kept.push_back(std::move(poses));
        shown.push_back(pose_at(kept.back(), 6));
      }
    }
    report.add(plot);
  }
  if (shown.size() == 2 && shown[0] != nullptr && shown[1] != nullptr)
    add_row_picture(
        report, bar, shown, "stability_stretch.png",
        fmt::format("Stretched six times by the default rotation: with the cap (blue, {:.3g} degrees a step) "
                    "and without it (red, {:.3g}). The paper's figure 4.",
                    shown[0]->flutter, shown[1]->flutter));
  report.add(table);
}

namespace {

/// How far bars of some shapes are stretched or compressed in turn, and the table of where they still come to rest.
struct Reach {
  const char* table;
  const char* caption;
  std::vector<std::array<int, 3>> shapes;  ///< cubes
  std::vector<double> stretches;           ///< from the mildest
};

void study_reach(const Reach& reach, Report& report) {
  struct Stepping {
    const char* name;
    Linearize linearize;
    int steps_per_second;
    Integrator integrator = Integrator::Euler;
  };
  constexpr Stepping kSteppings[] = {{"one solve, 24 a second", Linearize::Auto, 24},
                                     {"one solve, 96 a second", Linearize::Auto, 96},
                                     {"iterated, 24 a second", Linearize::Iterated, 24},
                                     {"BDF2, 24 a second", Linearize::Auto, 24, Integrator::Bdf2},
                                     {"BDF2, 96 a second", Linearize::Auto, 96, Integrator::Bdf2}};
  Table table{reach.table, reach.caption, {"cubes", "E / Pa"}, {}};
  for (const Stepping& stepping : kSteppings) table.columns.emplace_back(stepping.name);
  for (const std::array<int, 3>& cells : reach.shapes)
    for (const double modulus : {1e5, 1e6, 1e7, 1e8}) {
      BarBody bar;
      bar.cells = cells;
      bar.material.youngs_modulus = modulus;
      std::vector<Cell> row{fmt::format("{} x {} x {}", cells[0], cells[1], cells[2]), modulus};
      for (const Stepping& stepping : kSteppings) {
        SolverParams params;
        params.linearize = stepping.linearize;
        params.integrator = stepping.integrator;
        Verdict verdict;
        double calm = 0;
        for (const HeldPose& pose :
             stretch_bar(bar, params, reach.stretches, {stepping.steps_per_second, 4}, verdict)) {
          if (pose.flutter > kFlutter) break;
          calm = pose.asked;
        }
        row.emplace_back(calm);
      }
      table.add(std::move(row));
    }
  report.add(table);
}

}  // namespace

void study_one_solve(const BenchOptions& options, Report& report) {
  using Shapes = std::vector<std::array<int, 3>>;
  const Shapes slender = options.quick ? Shapes{{8, 2, 2}} : Shapes{{8, 4, 4}, {8, 2, 2}, {20, 2, 2}, {40, 2, 2}},
               stout = options.quick ? Shapes{{4, 4, 4}} : Shapes{{4, 4, 4}, {6, 6, 6}, {4, 8, 8}};
  study_reach(
      {"stability_one_solve",
       "Largest of the stretches 1.1, 1.25, 1.5, 2, 3, 4, 8, 20 up to which a bar of the default rotation, with "
       "the cap, comes to rest (0: not even the first)",
       slender,
       {1.1, 1.25, 1.5, 2, 3, 4, 8, 20}},
      report);
  study_reach({"stability_compressed",
               "The same for blocks that are pressed together: least of the lengths 0.9, 0.8, 0.7, 0.6, 0.5, 0.4 over "
               "that at rest (0: not even the first)",
               stout,
               {0.9, 0.8, 0.7, 0.6, 0.5, 0.4}},
              report);
}

void study_twist(const BenchOptions& options, Report& report) {
  BarBody bar;
  bar.cells = options.quick ? std::array<int, 3>{40, 2, 2} : std::array<int, 3>{160, 2, 2};
  const int turns = options.quick ? 4 : 10;
  const double stretch = 1.5;
  Table table{"stability_twist",
              fmt::format("Bar of {} x {} x {} cubes, stretched {:g} times, turned at its far end by one turn a second "
                          "and held 4 s after each: turns between its ends, counted section by section",
                          bar.cells[0], bar.cells[1], bar.cells[2], stretch),
              {"scheme", "turns commanded", "turns held", "motion left / degrees a step"},
              {}};
  Plot plot{"stability_twist", "Turns that a twisted bar holds", "turns commanded", "turns held", false, false, {}};
  std::vector<std::vector<HeldPose>> last;
  for (const Scheme& scheme : kSchemes) {
    if (options.quick && scheme.linearize == Linearize::Iterated) continue;
    Verdict verdict;
    std::vector<HeldPose> poses = twist_bar(bar, params_of(scheme), turns, stretch, {24, 4}, verdict);
    Series series{scheme.name, {}, {}, scheme.rotation == RotationMethod::Consistent, false};
    for (const HeldPose& pose : poses) {
      table.add({scheme.name, pose.asked, pose.held, pose.flutter});
      series.x.push_back(pose.asked);
      series.y.push_back(pose.held);
    }
    plot.series.push_back(std::move(series));
    const bool is_shown = scheme.rotation == RotationMethod::Qr || &scheme == &kSchemes[0];
    if (is_shown && !poses.empty()) last.push_back({poses.back()});
  }
  report.add(plot);
  std::vector<const HeldPose*> shown;
  for (const auto& poses : last) shown.push_back(&poses.front());
  if (shown.size() == 2)
    add_row_picture(report, bar, shown, "stability_twist.png",
                    fmt::format("After {} turns of the right end: the default rotation (blue) holds {:.0f} of them, qr "
                                "(red) {:.0f}. The paper's figure 5 shows large deformations like these.",
                                turns, shown[0]->held, shown[1]->held));
  report.add(table);
}

}  // namespace softreel::bench
