#include "tests/benchmark/stability/abuse_study.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "core/tetmesh/files/tet_mesh_file.h"
#include "tests/benchmark/stability/bar_body.h"
#include "tests/benchmark/stability/methods.h"

namespace softreel::bench {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kGain = 0.01;  ///< of the greatest energy before
constexpr int kRestSteps = 24;  ///< over which flutter is measured

/// The bar of slivers as it comes back from a file of Gmsh's format, as a user would give it.
TetMesh sliver_file(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "slivers.msh";
  const std::vector<std::uint8_t> bytes = encode_tet_mesh(sliver_bar(0.1), ".msh");
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
  return read_tet_mesh(path.string(), Log{});
}

}  // namespace

AbuseResult run_abuse(const Abuse& abuse, const SolverParams& params) {
  Rig rig(abuse.make_model(), params);
  if (abuse.start) rig.simulator.set_state(abuse.start(rig.simulator));
  Watch watch(rig.simulator);
  // Under recovery even an iterated step is one solve.
  const bool judge_recovery = params.linearize != Linearize::Iterated;
  int frame = 1;
  for (; frame <= abuse.steps; ++frame)
    if (!watch.step(frame, abuse.seconds, frame <= abuse.last_work, judge_recovery)) break;
  AbuseResult result{watch.verdict(), kNothing, abuse.free};
  if (!watch.verdict().survived() || abuse.free) return result;
  result.flutter = measure_flutter(watch, rig.simulator, frame, abuse.seconds, kRestSteps);
  result.verdict = watch.verdict();
  return result;
}

std::string in_a_word(const AbuseResult& result) {
  const Verdict& verdict = result.verdict;
  if (!verdict.survived()) return "stopped";
  std::string words;
  const auto add = [&words](const char* name, double value, double limit) {
    if (value > limit) words += fmt::format("{}{} {:.2g}", words.empty() ? "" : ", ", name, value);
  };
  add("flutter", result.flutter, kFlutter);
  add("gain", verdict.worst_gain, kGain);
  if (result.free) add("drift", std::max(verdict.linear_drift, verdict.angular_drift), kDrift);
  return words.empty() ? "calm" : words;
}

namespace {

Table summary_table() {
  Table table{
      "stability_abuse_summary",
      fmt::format("Abuse in a word: calm, or flutter above {:g} degrees a step at the end, or the energy gained "
                  "in a step above {:g} % of the greatest before, or of free bodies the drift of linear or angular "
                  "momentum above {:g} % of what the greatest kinetic energy allows (long steps of implicit Euler lose "
                  "it), or stopped by a step that could not be solved",
                  kFlutter, 100 * kGain, 100 * kDrift),
      {"test"},
      {}};
  for (const Scheme& scheme : kSchemes) table.columns.emplace_back(scheme.name);
  return table;
}

}  // namespace

void study_abuse(const BenchOptions& options, Report& report) {
  Table table{"stability_abuse",
              "Each abuse by each scheme, recovery on; momentum of free bodies over what their greatest kinetic energy "
              "allows, flutter of held ones",
              {"test", "scheme", "survived", "steps", "NaN", "steps that gained", "worst energy gain",
               "drift of linear momentum", "drift of angular momentum", "flutter / degrees a step"},
              {}};
  Table summary = summary_table();
  for (const Abuse& abuse : abuses(sliver_file(report.folder()), options.quick)) {
    std::vector<Cell> words{abuse.name};
    for (const Scheme& scheme : kSchemes) {
      const AbuseResult result = run_abuse(abuse, params_of(scheme));
      const Verdict& verdict = result.verdict;
      words.emplace_back(in_a_word(result));
      table.add({abuse.name, scheme.name, verdict.survived() ? "yes" : verdict.failure, long{verdict.steps},
                 verdict.finite ? "none" : "SEEN", long{verdict.gains}, verdict.worst_gain,
                 abuse.free ? verdict.linear_drift : kNothing, abuse.free ? verdict.angular_drift : kNothing,
                 result.flutter});
    }
    summary.add(std::move(words));
  }
  report.add(summary);
  report.add(table);
}

void study_long_runs(const BenchOptions& options, Report& report) {
  Table table{"stability_long_runs",
              "Bars of 1,008 tetrahedra, shaken and turned by their pins without end",
              {"rotation", "steps", "survived", "greatest energy of the first tenth / J", "of the last tenth / J",
               "processor time / s"},
              {}};
  constexpr int kPeriod = 48;
  for (const NamedMethod& method : kMethods) {
    const bool is_default = method.rotation == RotationMethod::Consistent;
    const int steps = options.quick ? (is_default ? 2000 : 500) : is_default ? 100000 : 10000;
    SolverParams params;
    params.rotation = method.rotation;
    Transform swung;
    swung.translate = Vec3(0.2, 0.3, 0);
    swung.rotate = Vec3(2, 0, 0.5);
    BodyModel model = make_cantilever_model({{14, 4, 3}});
    model.gravity = Vec3(0, -9.81, 0);
    model.pins[0].track = {{{0, {}, Ease::Smooth}, {kPeriod / 2, swung, Ease::Smooth}, {kPeriod, {}, Ease::Smooth}}};
    Rig rig(std::move(model), params);
    Watch watch(rig.simulator, 16);
    const double start = thread_seconds();
    double first = 0, last = 0;
    for (int k = 1; k <= steps && watch.step((k - 1) % kPeriod + 1, 1.0 / 24, true); ++k) {
      if (10 * k <= steps) first = std::max(first, watch.motion_energy());
      if (10 * k >= 9 * steps) last = std::max(last, watch.motion_energy());
    }
    table.add({method.name, long{watch.verdict().steps}, watch.verdict().survived() ? "yes" : watch.verdict().failure,
               first, last, thread_seconds() - start});
  }
  report.add(table);
}

}  // namespace softreel::bench
