#include "tests/benchmark/dial/dial_study.h"

#include <atomic>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "tests/benchmark/bench.h"
#include "tests/benchmark/dial/plane_bar.h"
#include "tool/bodies/dial_pilots.h"
#include "tool/bodies/dial_stage.h"
#include "tool/shot/shot_load.h"

namespace softreel::bench {
namespace {

constexpr double kTruthTolerance = 1e-6;
/// Steps of a frame of the finest mesh, and those that correct them on a coarse one.
constexpr int kTruthSteps = 8, kFinestSteps = 32;
constexpr std::int64_t kCoarseTets = 4000;

/// a + factor (b - c), point by point.
SampledMotion moved_on(SampledMotion a, const SampledMotion& b, const SampledMotion& c, double factor) {
  for (std::size_t f = 0; f < a.size(); ++f)
    for (std::size_t i = 0; i < a[f].size(); ++i) a[f][i] += factor * (b[f][i] - c[f][i]);
  return a;
}

/// The only body of a shot, run in any cut, on one thread; nothing is stored.
class OneBody {
 public:
  explicit OneBody(const std::string& path)
      : shot_(load_shot(path, {{"solver.error", "1%"}})),
        context_{threads_, log_, times_, cache_, cancelled_},
        loaded_(load_body(shot_.bodies.front(), context_)),
        constraints_(resolve_constraints(shot_, shot_.bodies.front(), loaded_, log_)),
        pilots_(shot_, shot_.bodies.front(), loaded_, constraints_, context_) {}

  bool is_dynamic() const { return !is_static(shot_); }
  double size() const { return used_bounds(loaded_.surface).diagonal(); }

  DialRequest request(double error, std::int64_t most_tets) const {
    Shot asked = shot_;
    asked.dial = {error, most_tets};
    return dial_request(asked, asked.bodies.front(), loaded_, context_);
  }

  std::optional<SampledMotion> try_run(const Discretization& cut) { return pilots_.run(cut); }

  SampledMotion run_plane_bar(int across, int substeps) const {
    return pilots_.run_on(fill_to_planes(loaded_.surface, constraints_, across), {0, substeps, kTruthTolerance});
  }

  SampledMotion run(const Discretization& cut) {
    if (auto motion = pilots_.run(cut)) return std::move(*motion);
    throw std::runtime_error(
        fmt::format("{} tetrahedra, {} steps a frame: {}", cut.tets, cut.substeps, pilots_.problem()));
  }

 private:
  Shot shot_;
  Threads threads_{1};
  Log log_;
  StageTimes times_;
  Cache cache_{(std::filesystem::temp_directory_path() / "softreel_bench_dial").string(), Cache::Storing::Wanted, log_};
  std::atomic<bool> cancelled_ = false;
  RunContext context_;
  LoadedBody loaded_;
  BodyConstraints constraints_;
  DialPilots pilots_;
};

struct Truth {
  SampledMotion motion;
  double doubt = 0;
};

Truth find_truth(OneBody& body, const DialProblem& problem) {
  const int steps = body.is_dynamic() ? kTruthSteps : 1;
  const bool is_bar = problem.across > 0;
  const SampledMotion fine =
      is_bar ? body.run_plane_bar(problem.across, steps) : body.run({problem.fine_tets, steps, kTruthTolerance});
  const SampledMotion coarse = is_bar ? body.run_plane_bar(problem.across / 2, steps)
                                      : body.run({problem.fine_tets / 8, steps, kTruthTolerance});
  SampledMotion motion = moved_on(fine, fine, coarse, 1 / (std::pow(2, is_bar ? kBarOrder : 1) - 1));
  const double doubt = motion_distance(motion, fine) / body.size();
  if (body.is_dynamic())
    motion = moved_on(std::move(motion), body.run({kCoarseTets, kFinestSteps, kTruthTolerance}),
                      body.run({kCoarseTets, kTruthSteps, kTruthTolerance}), 1);
  return {std::move(motion), doubt};
}

}  // namespace

Honesty judge(const DialTurn& turn, double doubt) {
  constexpr double kFactor = 2;
  const double believed = turn.choice.believed.total(), least = turn.truth - doubt, most = turn.truth + doubt;
  if (believed >= most / kFactor && believed <= kFactor * least) return Honesty::Within;
  return believed < least / kFactor || believed > kFactor * most ? Honesty::Outside : Honesty::Undecided;
}

const char* name_of(Honesty honesty) {
  switch (honesty) {
    case Honesty::Within:
      return "yes";
    case Honesty::Outside:
      return "no";
    case Honesty::Undecided:
      break;
  }
  return "undecided";
}

DialStudy study_dial(const DialProblem& problem) {
  OneBody body(fmt::format("{}/tests/benchmark/dial/{}.toml", SOFTREEL_SOURCE_DIR, problem.name));
  const Truth truth = find_truth(body, problem);
  DialStudy study{{}, truth.doubt};
  for (const double error : problem.errors) {
    DialTurn turn;
    turn.asked = error;
    double start = thread_seconds();
    const auto choice =
        turn_dial(body.request(error, problem.most_tets), [&](const Discretization& cut) { return body.try_run(cut); });
    turn.pilot_seconds = thread_seconds() - start;
    if (!choice) throw std::runtime_error(problem.name + ": no pilots could be run");
    turn.choice = *choice;
    start = thread_seconds();
    const SampledMotion motion = body.run(choice->chosen);
    turn.seconds = thread_seconds() - start;
    turn.truth = motion_distance(motion, truth.motion) / body.size();
    study.turns.push_back(std::move(turn));
  }
  return study;
}

}  // namespace softreel::bench
