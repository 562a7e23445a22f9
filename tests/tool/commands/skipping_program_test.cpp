/// Each edit runs the stages that it concerns and no other: counted from the program's own report.
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

/// What a run did, in the words of its report.
struct Work {
  bool filled = false;
  int computed = 0, loaded = 0, traced = 0, developed = 0, linked = 0, recalled = 0, kept = 0;
  int files_written = 0, files_kept = 0;
  double saved_seconds = 0;
};

class Skipping : public ::testing::Test {
 protected:
  void start(const std::string& name, const std::string& more = "") { folder_ = shot_folder(name, more); }

  Work run_shot(const std::string& options = "", const std::string& command = "render",
                const std::string& out = "out") {
    const Outcome outcome = run(fmt::format("softreel {} {}/shot.toml --output {}/{} --quiet --json {}", command,
                                            folder_, folder_, out, options));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const json report = json::parse(outcome.out);
    const json &pictures = report["pictures"], &simulation = report["simulation"], &files = report["files"];
    return {!report["bodies"][0]["tets_from_cache"].get<bool>(),
            simulation["computed"],
            simulation["loaded"],
            pictures["traced"],
            pictures["developed"],
            pictures["linked"],
            pictures["recalled"],
            pictures["kept"],
            files["written"],
            files["kept"],
            pictures["saved_seconds"].get<double>() + simulation["saved_seconds"].get<double>()};
  }
  std::string picture(int frame, const std::string& out = "out") const {
    return read_text(fmt::format("{}/{}/ball.{:04}.png", folder_, out, frame));
  }

  std::string folder_;
};

TEST_F(Skipping, TheFirstRunDoesEverythingAndTheSecondNothing) {
  start("again");
  const Work first = run_shot();
  EXPECT_TRUE(first.filled);
  EXPECT_EQ(first.computed, 4);
  EXPECT_EQ(first.traced, 4);
  EXPECT_EQ(first.saved_seconds, 0);
  const Work second = run_shot();
  EXPECT_FALSE(second.filled);
  EXPECT_EQ(second.computed, 0);
  EXPECT_EQ(second.loaded, 0) << "finished pictures need no simulated state";
  EXPECT_EQ(second.kept, 4);
  EXPECT_GT(second.saved_seconds, 0);
}

TEST_F(Skipping, EachRotationOfTheElementsIsSimulatedAndKeptApart) {
  start("rotations");
  for (const int runs : {1, 2})
    for (const char* name : {"consistent", "energy", "paper", "polar_smooth", "qr", "none"}) {
      const Work work = run_shot(fmt::format("--set solver.rotation={}", name), "simulate");
      EXPECT_EQ(work.computed > 0, runs == 1) << name;
    }
}

/// Simulated frames in a cache folder.
std::vector<std::string> stored_states(const std::string& cache) {
  std::vector<std::string> names = files_under(cache);
  std::erase_if(names, [](const std::string& name) { return name.find("/simulation/") == std::string::npos; });
  return names;
}

TEST_F(Skipping, AStoredFrameIsContinuedWithTheSameBitsByEveryIntegrator) {
  start("integrators");
  int number = 0;
  for (const char* name : {"euler", "bdf2", "newmark", "newmark --set solver.step_error=1e-4"}) {
    const std::string parts = fmt::format("{}/parts{}", folder_, number),
                      whole = fmt::format("{}/whole{}", folder_, number++);
    const std::string set = fmt::format("--set solver.integrator={} --set solver.substeps=2 --cache ", name);
    EXPECT_EQ(run_shot(set + parts + " --frames 1-2", "simulate").computed, 2) << name;
    const Work rest = run_shot(set + parts, "simulate");
    EXPECT_EQ(rest.computed, 2) << name;
    EXPECT_EQ(rest.loaded, 2) << name;
    EXPECT_EQ(run_shot(set + whole, "simulate").computed, 4) << name;
    const std::vector<std::string> states = stored_states(whole);
    EXPECT_EQ(states.size(), 4u);
    EXPECT_EQ(stored_states(parts), states);
    for (const std::string& state : states)
      EXPECT_TRUE(stored_content(parts + "/" + state) == stored_content(whole + "/" + state)) << name << " " << state;
  }
}

/// The simulation's part of the JSON report.
json simulation_of(const std::string& folder, const std::string& options) {
  const Outcome outcome =
      run(fmt::format("softreel simulate {}/shot.toml --output {}/out --quiet --json {}", folder, folder, options));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return json::parse(outcome.out)["simulation"];
}

TEST_F(Skipping, ReportsWhatWasNotSolved) {
  start("rest");
  // The pull is switched off and the body is in balance: nothing happens in frames 2 to 4.
  const std::string still = "--set 'body.ball.pull[0].active=[9,10]' ";
  const json rest = simulation_of(folder_, still + "--set shot.start=equilibrium --set solver.substeps=2");
  EXPECT_EQ(rest["computed"], 4);
  EXPECT_EQ(rest["steps"], 6);
  EXPECT_EQ(rest["steps_at_rest"], 6);
  const json unchanged = simulation_of(folder_, still + "--set shot.mode=static");
  EXPECT_EQ(unchanged["computed"], 4);
  EXPECT_EQ(unchanged["frames_unchanged"], 3);
  const json moving = simulation_of(folder_, "--set shot.mode=static");
  EXPECT_EQ(moving["frames_unchanged"], 0);
  const json controlled = simulation_of(folder_, "--set solver.step_error=1e-5");
  EXPECT_GT(controlled["steps"], 6);
  EXPECT_EQ(controlled["steps_at_rest"], 0);
}

TEST_F(Skipping, StopsWhereTheErrorOfAStepStaysTooGreat) {
  start("error");
  const Outcome outcome =
      run(fmt::format("softreel simulate {}/shot.toml --output {}/out --quiet --set "
                      "solver.step_error=1e-9 --set solver.max_substeps=4",
                      folder_, folder_));
  EXPECT_EQ(outcome.status, 1);
  for (const char* part : {"frame 2, body \"ball\"", "solver.max_substeps = 4", "Accepted: at most", "Raise one of"})
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
}

TEST_F(Skipping, ALightOrTheCameraTracesAndDoesNotSimulate) {
  start("light");
  run_shot();
  for (const char* edit : {"--set 'environment.zenith=[0.9,0.2,0.1]'", "--set camera.azimuth_deg=60",
                           "--set render.samples=3", "--set ground.size=30"}) {
    const Work work = run_shot(edit);
    EXPECT_FALSE(work.filled) << edit;
    EXPECT_EQ(work.computed, 0) << edit;
    EXPECT_EQ(work.traced, 4) << edit;
  }
}

TEST_F(Skipping, AKeyOfALookTracesTheFramesWhoseValuesItChanges) {
  start("looks");
  const std::string before = "--set 'environment.strength=[{frame=1,value=1},{frame=3,value=2}]' ";
  EXPECT_EQ(run_shot(before).traced, 4);
  const Work longer = run_shot("--set 'environment.strength=[{frame=1,value=1},{frame=3,value=2},{frame=4,value=3}]' ");
  EXPECT_EQ(longer.traced, 1);
  EXPECT_EQ(longer.kept, 3);
  const Work material =
      run_shot(before + "--set 'material.soft.base_color=[{frame=2,value=[0.7,0.6,0.5]},{frame=4,value=[1,0,0]}]'");
  EXPECT_EQ(material.computed, 0);
  const Work later =
      run_shot(before + "--set 'material.soft.base_color=[{frame=3,value=[0.7,0.6,0.5]},{frame=4,value=[1,0,0]}]'");
  EXPECT_EQ(later.traced, 1) << "frames 1, 2 and 4 have the colours that they had";
  EXPECT_EQ(later.kept, 3);
}

TEST_F(Skipping, TheLookOfAMaterialTouchesNoSimulationAndItsPhysicsDoes) {
  start("look");
  run_shot();
  const Work look = run_shot("--set material.soft.roughness=0.2");
  EXPECT_EQ(look.computed, 0);
  EXPECT_EQ(look.traced, 4);
  const Work physics = run_shot("--set material.soft.youngs_modulus=3e4");
  EXPECT_FALSE(physics.filled);
  EXPECT_EQ(physics.computed, 4);
}

TEST_F(Skipping, HardEdgesAreTracedAndNotSimulatedWhereTheMeshHasAny) {
  start("creases");
  run_shot();
  const Work smooth = run_shot("--set body.ball.crease_deg=60");
  EXPECT_EQ(smooth.traced, 0) << "no edge of the ball is as sharp as that: the pictures are those that are there";
  EXPECT_EQ(smooth.linked + smooth.developed, 4);
  const std::string round = picture(2);
  const Work hard = run_shot("--set body.ball.crease_deg=5");
  EXPECT_FALSE(hard.filled);
  EXPECT_EQ(hard.computed, 0);
  EXPECT_EQ(hard.traced, 4);
  EXPECT_NE(picture(2), round);
  EXPECT_EQ(run_shot("--set body.ball.crease_deg=180").recalled, 4) << "which is the default";
  EXPECT_EQ(picture(2), round);
}

TEST_F(Skipping, ViewAndExposureDevelopThePicturesAgainWithoutTracing) {
  start("exposure");
  run_shot();
  const Work work = run_shot("--set output.exposure=1.5");
  EXPECT_EQ(work.traced, 0);
  EXPECT_EQ(work.developed, 4);
  EXPECT_EQ(work.loaded, 0);
  const std::string developed = picture(3);
  run_shot("--set output.exposure=1.5", "render", "fresh");
  EXPECT_EQ(picture(3, "fresh"), developed) << "developing again must give the bits of tracing anew";
}

TEST_F(Skipping, AnEditedKeySimulatesFromTheFirstFrameItCanAffect) {
  start("key");
  run_shot();
  // The pull's keys are at frames 1 and 4; a new one at frame 3 on the same line changes nothing before, and after it
  // only what differs from the old line. Switching the pull off from frame 4 on concerns the sub-steps of frame 4.
  const Work work = run_shot("--set 'body.ball.pull[0].active=[1,3]'");
  EXPECT_EQ(work.computed, 1);
  EXPECT_EQ(work.traced, 1);
  EXPECT_EQ(work.kept, 3);
}

TEST_F(Skipping, ALongerShotContinues) {
  start("longer");
  run_shot("--set 'body.ball.pull[0].keys=[{frame=1},{frame=3,translate=[0.1,0.1,0]}]'");
  const Work work =
      run_shot("--set shot.frames='[1,6]' --set 'body.ball.pull[0].keys=[{frame=1},{frame=3,translate=[0.1,0.1,0]}]'");
  EXPECT_FALSE(work.filled);
  EXPECT_EQ(work.computed, 2);
  EXPECT_EQ(work.traced, 2);
  EXPECT_EQ(work.kept, 4);
}

TEST_F(Skipping, AnEditThatChangesNoValueDoesNothing) {
  start("novalue");
  run_shot();
  // The same selection in other words, a key on the line between two others, a comment in the mesh, another name.
  write_text(folder_ + "/sphere.obj", "# a comment\n" + read_text(folder_ + "/sphere.obj"));
  const Work work = run_shot(
      "--set 'body.ball.pin[0].select={box={min=[-1,-1,-1],max=[1,0.21,1]},unit=\"box\"}' --set "
      "solver.threads=1 --set golden.threshold=0.5");
  EXPECT_FALSE(work.filled);
  EXPECT_EQ(work.computed, 0);
  EXPECT_EQ(work.kept, 4);
}

TEST_F(Skipping, AnEditThatIsUndoneComesBackFromTheCache) {
  start("undone");
  run_shot();
  const std::string before = picture(2);
  EXPECT_EQ(run_shot("--set camera.azimuth_deg=60").traced, 4);
  EXPECT_NE(picture(2), before);
  const Work work = run_shot();
  EXPECT_EQ(work.recalled, 4);
  EXPECT_EQ(work.traced, 0);
  EXPECT_EQ(picture(2), before);
}

TEST_F(Skipping, AnotherOutputFolderSharesTheCache) {
  start("shared");
  const std::string cache = fmt::format("--cache {}/cache", folder_);
  run_shot(cache);
  const Work work = run_shot(cache, "render", "other");
  EXPECT_FALSE(work.filled);
  EXPECT_EQ(work.computed, 0);
  EXPECT_EQ(work.recalled, 4);
  EXPECT_EQ(picture(4, "other"), picture(4));
}

TEST_F(Skipping, EqualFramesAreLinkedNotTraced) {
  start("equal");
  const Work work = run_shot(
      "--set shot.mode=static --set 'body.ball.pull[0].keys=[{frame=1,translate=[0.1,0,0]}]' --set "
      "shot.independent=true");
  EXPECT_EQ(work.traced, 1);
  EXPECT_EQ(work.linked + work.developed, 3) << "developed: while the first one's picture is not encoded yet";
  EXPECT_EQ(std::filesystem::hard_link_count(folder_ + "/out/ball.0004.png"),
            std::filesystem::hard_link_count(folder_ + "/out/ball.0001.png"));
}

TEST_F(Skipping, ExposureOfEqualFramesNeedsNoSimulation) {
  start("equal_exposure");
  const std::string still = "--set shot.mode=static --set 'body.ball.pull[0].keys=[{frame=1,translate=[0.1,0,0]}]' ";
  const Work first = run_shot(still);
  EXPECT_EQ(first.traced, 1);
  // One whose picture is not encoded yet when the next frame is looked at is developed from the same pixels.
  EXPECT_EQ(first.linked + first.developed, 3);
  EXPECT_GT(std::filesystem::remove_all(folder_ + "/out/.cache/2/simulation"), 0U);
  const Work work = run_shot(still + "--set output.exposure=1.5");
  EXPECT_EQ(work.traced, 0);
  EXPECT_EQ(work.computed, 0);
}

TEST_F(Skipping, FramesBesideTheOneThatIsMadeNeedNoCache) {
  start("no_cache");
  write_text(folder_ + "/a_file", "no folder can be made here");
  const Outcome outcome =
      run(fmt::format("softreel render {0}/shot.toml --output {0}/out --cache {0}/a_file/cache --quiet --json --set "
                      "render.shutter=0.5 --set output.exr=true --set 'render.channels=[\"motion\"]'",
                      folder_));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  EXPECT_EQ(report["simulation"]["computed"], 4);
  EXPECT_EQ(report["pictures"]["traced"], 4);
  const Outcome independent =
      run(fmt::format("softreel render {0}/shot.toml --output {0}/other --cache {0}/a_file/cache --quiet --json --set "
                      "shot.mode=static --set shot.independent=true --set output.exr=true --set "
                      "'render.channels=[\"motion\"]'",
                      folder_));
  ASSERT_EQ(independent.status, 0) << independent.err;
  EXPECT_EQ(json::parse(independent.out)["simulation"]["computed"], 4);
}

TEST_F(Skipping, ExportAndPreviewNeverSimulateAgainAndWriteOnce) {
  start("export");
  run_shot("", "simulate");
  for (const char* command : {"export --format obj", "export --format ply", "preview"}) {
    const Work first = run_shot("", command);
    EXPECT_FALSE(first.filled) << command;
    EXPECT_EQ(first.computed, 0) << command;
    EXPECT_EQ(first.files_written, 4) << command;
    const Work second = run_shot("", command);
    EXPECT_EQ(second.loaded, 0) << command;
    EXPECT_EQ(second.files_written, 0) << command;
    EXPECT_EQ(second.files_kept, 4) << command;
  }
  EXPECT_EQ(run_shot("", "export --format pc2").files_written, 1);
  EXPECT_EQ(run_shot("", "export --format pc2").files_kept, 1);
  EXPECT_EQ(run_shot("--frames 2-3", "export --format pc2").files_written, 1) << "another range is another file";
}

TEST_F(Skipping, OneFrameReadsOneState) {
  start("one");
  run_shot("", "simulate");
  const Work work = run_shot("--frames 3");
  EXPECT_EQ(work.computed, 0);
  EXPECT_EQ(work.loaded, 1);
  EXPECT_EQ(work.traced, 1);
  const Work blurred = run_shot("--frames 4 --set render.shutter=0.5");
  EXPECT_EQ(blurred.loaded, 2) << "motion blur starts at the frame before";
}

TEST_F(Skipping, FramesAreRenderedWhileLaterOnesSimulate) {
  start("streams");
  const std::string out = folder_ + "/out";
  run(
      fmt::format("'{0}' render {1}/shot.toml --output {2} --quiet --set shot.frames='[1,60]' --threads 2 & pid=$!; "
                  "while [ ! -e {2}/ball.0001.png ] && kill -0 $pid 2>/dev/null; do sleep 0.002; done; kill -9 $pid; "
                  "wait $pid",
                  SOFTREEL_PROGRAM, folder_, out));
  const std::size_t simulated = files_under(out + "/.cache/2/simulation").size();
  EXPECT_GE(simulated, 2U) << "the next frame is simulated while the first is traced";
  EXPECT_LT(simulated, 60U) << "the first picture need not wait for the last state";
}

TEST_F(Skipping, MemoryDoesNotGrowWithTheNumberOfFrames) {
  start("memory");
  const auto peak_kilobytes = [] {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    return usage.ru_maxrss;
  };
  const char* motion =
      "--set 'body.ball.pull[0].keys=[{frame=1},{frame=600,translate=[0.2,0.2,0]}]' --set render.samples=1 --set "
      "body.ball.tets=3000";
  run_shot(fmt::format("{} --set shot.frames='[1,100]'", motion), "render", "short");
  const auto few = peak_kilobytes();
  run_shot(fmt::format("{} --set shot.frames='[1,600]'", motion), "render", "long");
  // The 500 more states alone are 65 MB; heaps of several threads differ by some megabytes from run to run.
  EXPECT_LT(peak_kilobytes() - few, 12'000) << "after " << few << " kB for 100 frames";
}

}  // namespace
}  // namespace softreel
