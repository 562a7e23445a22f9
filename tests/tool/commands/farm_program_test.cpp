/// softreel farm with a stand-in for Slurm, which runs what it is given at once, and the parts of render that a farm
/// uses.
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;
namespace fs = std::filesystem;

/// Runs each task at once unless FOLDER/hold is there; says no while FOLDER/refuse names the job's step.
constexpr const char* kSbatch = R"bash(#!/bin/bash
folder=$(dirname "$0")
printf '%s\n' "$*" >>"$folder/submitted"
script=${!#}
if [ -e "$folder/refuse" ] && [[ $script == *$(cat "$folder/refuse")* ]]; then
  echo "sbatch: error: no such partition" >&2
  exit 1
fi
job=$(($(cat "$folder/last" 2>/dev/null || echo 0) + 1))
echo $job >"$folder/last"
echo $job
[ -e "$folder/hold" ] && exit 0
tasks=0
for word in "$@"; do case $word in --array=0-*) tasks=${word#--array=0-} ;; --output=*) log=${word#--output=} ;; esac; done
for ((i = 0; i <= tasks; ++i)); do
  here=${log//%j/$job}
  here=${here//%A/$job}
  here=${here//%a/$i}
  SLURM_JOB_ID=$job SLURM_ARRAY_JOB_ID=$job SLURM_ARRAY_TASK_ID=$i SLURM_CPUS_PER_TASK=1 SLURMD_NODENAME=node1 \
    bash "$script" >"$here" 2>&1
done
exit 0
)bash";

class Farm : public ::testing::Test {
 protected:
  void start(const std::string& name) {
    folder_ = shot_folder(name);
    std::string shot = read_text(folder_ + "/shot.toml");
    shot.replace(shot.find("movie = false"), 13, "movie = true");
    write_text(folder_ + "/shot.toml", shot);
    slurm_ = folder_ + "/slurm";
    fs::create_directories(slurm_);
    program("sbatch", kSbatch);
    program("squeue", "#!/bin/bash\ncat \"$(dirname \"$0\")/queue\" 2>/dev/null\nexit 0\n");
    program("scancel", "#!/bin/bash\necho \"$*\" >>\"$(dirname \"$0\")/cancelled\"\n");
  }
  void program(const std::string& name, const std::string& text) {
    write_text(slurm_ + "/" + name, text);
    fs::permissions(slurm_ + "/" + name, fs::perms::owner_all);
  }
  Outcome farm(const std::string& options = "") {
    return run(fmt::format("export PATH={1}:$PATH; softreel farm {0}/shot.toml --output {0}/out {2}", folder_, slurm_,
                           options));
  }
  Outcome render(const std::string& options, const std::string& output = "out") {
    return run(fmt::format("softreel render {0}/shot.toml --quiet --output {0}/{1} {2}", folder_, output, options));
  }
  std::string submitted() { return exists(slurm_ + "/submitted") ? read_text(slurm_ + "/submitted") : ""; }
  void expect_result_of_render() {
    ASSERT_EQ(render("", "alone").status, 0);
    for (const char* name : {"ball.0001.png", "ball.0002.png", "ball.0003.png", "ball.0004.png", "ball.mp4"}) {
      ASSERT_TRUE(exists(folder_ + "/out/" + name)) << name;
      EXPECT_EQ(read_text(folder_ + "/out/" + name), read_text(folder_ + "/alone/" + name)) << name;
    }
  }
  json tasks(int status) {
    const Outcome outcome = farm("--status --json");
    EXPECT_EQ(outcome.status, status) << outcome.out << outcome.err;
    return json::parse(outcome.out)["shots"][0]["tasks"];
  }

  std::string folder_, slurm_;
};

TEST_F(Farm, FramesAndMovieMadeApartAreThoseOfTheWholeShot) {
  start("parts");
  ASSERT_EQ(render("--only frames --frames 3-4").status, 0);
  ASSERT_EQ(render("--only frames --frames 1-2 --set output.contact_sheet=true").status, 0);
  for (const std::string& name : files_under(folder_ + "/out"))
    EXPECT_FALSE(name.ends_with(".mp4") || name.ends_with("sheet.png")) << name;
  ASSERT_EQ(render("--only movie").status, 0);
  expect_result_of_render();
}

TEST_F(Farm, AMovieOfMissingPicturesNamesThem) {
  start("missing");
  ASSERT_EQ(render("--only frames --frames 1-2").status, 0);
  const Outcome outcome = render("--only movie");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("frames 3-4"), std::string::npos) << outcome.err;
}

TEST_F(Farm, AMovieThatNobodyAskedForIsRefused) {
  start("unasked");
  const Outcome outcome = render("--only movie --set output.movie=false");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("output.movie"), std::string::npos) << outcome.err;
}

TEST_F(Farm, MakesWhatRenderMakes) {
  start("whole");
  const Outcome outcome = farm("--chunk 2");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  expect_result_of_render();
  for (const json& task : tasks(0)) EXPECT_EQ(task["state"], "done") << task;
}

TEST_F(Farm, SaysThatNothingIsToBeDoneAndSubmitsNothing) {
  start("nothing");
  ASSERT_EQ(render("").status, 0);
  const Outcome outcome = farm();
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.err.find("nothing to do"), std::string::npos) << outcome.err;
  EXPECT_EQ(submitted(), "");
}

TEST_F(Farm, AShotThatIsDoneStopsNoOther) {
  start("several");
  std::string other = read_text(folder_ + "/shot.toml");
  other.replace(other.find("name = \"ball\""), 13, "name = \"other\"");
  write_text(folder_ + "/other.toml", other);
  ASSERT_EQ(render("").status, 0);
  const Outcome outcome = farm(folder_ + "/other.toml --wait --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json shots = json::parse(outcome.out)["shots"];
  ASSERT_EQ(shots.size(), 2U);
  EXPECT_EQ(shots[0]["done"], true);
  EXPECT_TRUE(shots[0]["tasks"].empty()) << "nothing of it was submitted";
  EXPECT_EQ(shots[1]["done"], true);
  EXPECT_FALSE(shots[1]["tasks"].empty());
  EXPECT_TRUE(exists(folder_ + "/out/other.mp4"));
}

TEST_F(Farm, ADryRunShowsScriptsAndWritesNothing) {
  start("dry");
  const Outcome outcome = farm("--dry-run --chunk 1 --partition night --sbatch=--nice=7");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part : {"sbatch", "--array=0-3", "--partition=night", "--nice=7", "--kill-on-invalid-dep=yes",
                           "#!/bin/bash", "render --only frames", "render --only movie", "(simulate "})
    EXPECT_NE(outcome.out.find(part), std::string::npos) << part;
  EXPECT_FALSE(exists(folder_ + "/out"));
  EXPECT_EQ(submitted(), "");
}

TEST_F(Farm, FramesThatStandForThemselvesWaitForTheTetrahedraOnly) {
  start("independent");
  const std::string how = "--set shot.mode='\"static\"' --set shot.independent=true ";
  ASSERT_EQ(farm(how + "--chunk 2").status, 0);
  const std::string simulate = read_text(folder_ + "/out/.farm/ball/scripts/simulate.sh");
  EXPECT_NE(simulate.find("chunks=(1-1)"), std::string::npos);
  ASSERT_EQ(render(how, "alone").status, 0);
  for (const char* name : {"ball.0002.png", "ball.0004.png", "ball.mp4"})
    EXPECT_EQ(read_text(folder_ + "/out/" + name), read_text(folder_ + "/alone/" + name)) << name;
}

TEST_F(Farm, AnErrorDialIsTurnedByTheFirstTask) {
  start("dial");
  const std::string how = "--set solver.error='\"20%\"' ";
  const Outcome outcome = farm(how + "--chunk 2");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("--memory and --time"), std::string::npos) << "sizes are not known yet: " << outcome.err;
  for (const json& task : tasks(0)) EXPECT_EQ(task["state"], "done") << task;
}

TEST_F(Farm, AFailingTaskIsNamedWithItsLogAndARetryMakesOnlyWhatIsMissing) {
  start("retry");
  ASSERT_EQ(render("--only frames --frames 1-3").status, 0);
  write_text(slurm_ + "/hold", "");
  ASSERT_EQ(farm("--chunk 2").status, 0);
  // The node of the task of frame 4 sees another cache.
  const std::string records = folder_ + "/out/.farm/ball";
  const Outcome task = run(fmt::format(
      "rm {0}/out/.cache/.farm-*; SLURM_JOB_ID=2 SLURM_ARRAY_JOB_ID=2 SLURM_ARRAY_TASK_ID=0 bash {1}/scripts/frames.sh "
      ">{1}/logs/frames-2_0.log 2>&1",
      folder_, records));
  EXPECT_EQ(task.status, 2);
  const Outcome status = farm("--status");
  EXPECT_EQ(status.status, 1);
  for (const std::string& part :
       {std::string("frame 4 failed"), records + "/logs/frames-2_0.log", folder_ + "/out/.cache"})
    EXPECT_NE(status.out.find(part), std::string::npos) << status.out;
  fs::remove(slurm_ + "/hold");
  fs::remove(slurm_ + "/submitted");
  const Outcome again = farm("--retry");
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.err.find("frames 4 in 1 task"), std::string::npos) << again.err;
  expect_result_of_render();
}

TEST_F(Farm, ARefusedRetryLeavesTheRecordAsItWas) {
  start("refused_retry");
  write_text(slurm_ + "/hold", "");
  ASSERT_EQ(farm("--chunk 2 --set render.samples=3").status, 0);
  write_text(folder_ + "/out/.farm/ball/tasks/frames-1-2",
             "failed\nnode9\n7\nframes-2_0.log\n2026-01-01T00:00:00Z\n2_0\n");
  write_text(slurm_ + "/refuse", "frames.sh");
  const Outcome refused = farm("--retry --partition nigth");
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.err.find("no such partition"), std::string::npos) << refused.err;
  fs::remove(slurm_ + "/refuse");
  fs::remove(slurm_ + "/submitted");
  const json known = tasks(1);
  EXPECT_EQ(known.size(), 4U) << "they are lost, and known";
  EXPECT_NE(known.dump().find("node9"), std::string::npos) << "what one said of itself is there: " << known;
  const Outcome again = farm("--retry");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(submitted().find("nigth"), std::string::npos) << submitted();
  EXPECT_NE(read_text(folder_ + "/out/.farm/ball/scripts/frames.sh").find("render.samples=3"), std::string::npos);
}

TEST_F(Farm, ARetryAddsItsValuesToThoseOfTheSubmission) {
  start("added");
  ASSERT_EQ(farm("--engine openjd --set render.samples=3 --set output.exposure=1").status, 0);
  const Outcome again = farm("--retry --set output.exposure=2");
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.err.find("as it was submitted: --set 'render.samples=3';"), std::string::npos) << again.err;
  const json sets = json::parse(read_text(folder_ + "/out/.farm/ball/submission.json"))["shot"]["sets"];
  EXPECT_EQ(sets, json({"render.samples=3", "output.exposure=2"}));
}

TEST_F(Farm, SaysWhyAJobWasRefusedEvenIfNoneCanBeTakenBack) {
  start("stubborn");
  write_text(slurm_ + "/hold", "");
  write_text(slurm_ + "/refuse", "frames.sh");
  program("scancel", "#!/bin/bash\necho 'no contact to the controller' >&2\nexit 1\n");
  const Outcome outcome = farm();
  EXPECT_EQ(outcome.status, 1);
  for (const char* part : {"no such partition", "Still in the queue: 1", "no contact"})
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << " in " << outcome.err;
}

TEST_F(Farm, ATemplateOfOneShotIsNoQueueForAnother) {
  start("engines");
  std::string shot = read_text(folder_ + "/shot.toml");
  shot.replace(shot.find("name = \"ball\""), 13, "name = \"egg\"");
  write_text(folder_ + "/egg.toml", shot);
  const auto with_slurm = [&](const std::string& words) {
    return run(fmt::format("export PATH={1}:$PATH; softreel farm {2} --output {0}/out", folder_, slurm_, words));
  };
  ASSERT_EQ(with_slurm(folder_ + "/egg.toml --engine openjd").status, 0);
  ASSERT_EQ(farm().status, 0);
  const Outcome both = with_slurm(fmt::format("{0}/shot.toml {0}/egg.toml --engine slurm", folder_));
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_TRUE(exists(folder_ + "/out/egg.mp4"));
}

TEST_F(Farm, ClosingLinesAndOptionsSurviveAShell) {
  start("a blank");
  write_text(slurm_ + "/hold", "");
  const std::string where =
      fmt::format("export PATH='{1}':$PATH; softreel farm '{0}/shot.toml' --output '{0}/out' ", folder_, slurm_);
  ASSERT_EQ(run(where).status, 0);
  const Outcome status = run(where + "--status");
  EXPECT_EQ(status.status, 1);
  EXPECT_NE(status.out.find(fmt::format("softreel farm '{0}/shot.toml' --output '{0}/out' --retry", folder_)),
            std::string::npos)
      << status.out;
  EXPECT_EQ(run(where + "--status --chunk 3").status, 2);
  EXPECT_EQ(run(where + "--dry-run --json").status, 2);
}

TEST_F(Farm, WhatIsInTheQueueIsNotSubmittedTwice) {
  start("twice");
  write_text(slurm_ + "/hold", "");
  ASSERT_EQ(farm("--chunk 2").status, 0);
  write_text(slurm_ + "/queue",
             "1|RUNNING|node1|None\n2_0|PENDING||Dependency\n2_1|PENDING||Dependency\n3|PENDING||Dependency\n");
  EXPECT_EQ(farm().status, 2);
  fs::remove(slurm_ + "/submitted");
  const Outcome retry = farm("--retry");
  EXPECT_EQ(retry.status, 0);
  EXPECT_NE(retry.err.find("in the queue"), std::string::npos) << retry.err;
  EXPECT_EQ(submitted(), "");
  // One chunk failed while the other still runs: only its frames are submitted, and a movie that waits for both.
  write_text(slurm_ + "/queue",
             "1|COMPLETED|node1|None\n2_0|RUNNING|node1|None\n2_1|FAILED|node2|None\n3|PENDING||Dependency\n");
  EXPECT_EQ(farm("--retry").status, 0);
  EXPECT_NE(submitted().find("2_0"), std::string::npos) << submitted();
  EXPECT_EQ(submitted().find("2_1"), std::string::npos) << submitted();
  EXPECT_EQ(read_text(slurm_ + "/cancelled"), "3\n");
}

TEST_F(Farm, NothingStaysInTheQueueIfSlurmRefusesAJob) {
  start("refused");
  write_text(slurm_ + "/hold", "");
  write_text(slurm_ + "/refuse", "frames.sh");
  const Outcome outcome = farm();
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("no such partition"), std::string::npos) << outcome.err;
  EXPECT_EQ(read_text(slurm_ + "/cancelled"), "1\n");
  const Outcome status = farm("--status");
  EXPECT_EQ(status.status, 2) << "nothing was submitted: " << status.out;
}

TEST_F(Farm, WithoutSlurmTheMessageNamesTheWayOut) {
  start("without");
  fs::create_directories(folder_ + "/bin");
  const std::string path = "$(dirname $(command -v sha256sum))/sha256sum";
  const Outcome outcome = run(fmt::format(
      "ln -s {1} {0}/bin/sha256sum; export PATH={0}/bin; softreel farm {0}/shot.toml --output {0}/out", folder_, path));
  EXPECT_EQ(outcome.status, 1);
  for (const char* part : {"sbatch", "no Slurm", "--engine openjd"})
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
}

TEST_F(Farm, WritesATemplateWithoutAskingSlurm) {
  start("openjd");
  const Outcome outcome = farm(fmt::format("--engine openjd --template {}/job.json --chunk 3", folder_));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json job = json::parse(read_text(folder_ + "/job.json"));
  EXPECT_EQ(job["specificationVersion"], "jobtemplate-2023-09");
  EXPECT_EQ(job["steps"].size(), 3U);
  EXPECT_EQ(submitted(), "");
  for (const json& task : tasks(0)) EXPECT_EQ(task["state"], "waiting") << task;
  ASSERT_EQ(render("").status, 0);
  for (const json& task : tasks(0)) EXPECT_EQ(task["state"], "done") << "by whom it was made does not matter";
}

TEST_F(Farm, AStatusTakesTheValuesOfTheSubmissionWhereTheShotNeedsThem) {
  start("recorded");
  std::string shot = read_text(folder_ + "/shot.toml");
  shot.replace(shot.find("\"soft\""), 6, "\"sorft\"");  // the body's material, as yet unknown
  write_text(folder_ + "/shot.toml", shot);
  EXPECT_EQ(farm("--status").status, 2) << "nothing was submitted";
  ASSERT_EQ(farm("--engine openjd --set body.material=soft --set shot.name=other").status, 0);
  for (const json& task : tasks(0)) EXPECT_EQ(task["state"], "waiting") << task;
  const Outcome status = farm("--status");
  EXPECT_NE(status.out.find("farm: other in " + folder_ + "/out"), std::string::npos) << status.out;
  EXPECT_EQ(farm("--status --set body.material=hard").status, 2) << "what is given now counts";
}

TEST_F(Farm, MistakesAreSaidBeforeAnythingIsSubmitted) {
  start("mistakes");
  for (const char* options :
       {"--memory plenty", "--time soon", "--engine openjd --wait", "--template x.json", "--frames 9-10", "--chunk 0",
        "--engine pbs", "--status", "--retry", "--status --dry-run"}) {
    const Outcome outcome = farm(options);
    EXPECT_EQ(outcome.status, 2) << options << outcome.err;
    EXPECT_NE(outcome.err.find("softreel: "), std::string::npos) << outcome.err;
  }
  const Outcome twice = farm(folder_ + "/shot.toml");
  EXPECT_EQ(twice.status, 2) << twice.err;
  EXPECT_EQ(submitted(), "");
  EXPECT_FALSE(exists(folder_ + "/out"));
}

}  // namespace
}  // namespace softreel
