/// What a task's script does on a node: run by bash, with a stand-in for softreel.
#include "tool/farm/task_script.h"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/tool/farm/shell.h"
#include "tool/farm/farm_record.h"
#include "tool/farm/slurm.h"

namespace softreel {
namespace {

using namespace softreel::testing;
namespace fs = std::filesystem;

const std::vector<std::string> kSlurm{"SLURM_ARRAY_JOB_ID=12", "SLURM_ARRAY_TASK_ID=1", "SLURM_JOB_ID=14",
                                      "SLURM_CPUS_PER_TASK=3", "SLURMD_NODENAME=node7"};

class TaskScript : public ::testing::Test {
 protected:
  void start(const std::string& folder) { shot_ = stand_in_shot(farm_folder(folder)); }
  ShellOutcome run(const FarmJob& job) { return run_bash(slurm_script(shot_, job, {2, 1e9, 600}), {}, kSlurm); }
  ShellOutcome run_frames() { return run({FarmStep::Frames, 0, {{1, 4}, {5, 8}}, {0}}); }
  TaskRecord said(const std::string& task) { return parse_task_record(text_of(record_path(shot_, task))); }
  /// The task ends with status 2 and one line that names the node and this; softreel does not run.
  void expect_refusal(const std::string& named) {
    const ShellOutcome outcome = run_frames();
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(std::count(outcome.said.begin(), outcome.said.end(), '\n'),
              1 + std::count(named.begin(), named.end(), '\n') + std::count(shot_.name.begin(), shot_.name.end(), '\n'))
        << outcome.said;
    EXPECT_NE(outcome.said.find(named), std::string::npos) << outcome.said;
    EXPECT_NE(outcome.said.find("node7"), std::string::npos) << outcome.said;
    EXPECT_TRUE(arguments_of(shot_).empty());
  }

  FarmShot shot_;
};

TEST_F(TaskScript, GivesSoftreelTheFramesOfItsTask) {
  start("plain");
  EXPECT_EQ(run_frames().status, 0);
  const std::vector<std::string> arguments = arguments_of(shot_);
  ASSERT_GE(arguments.size(), 2U);
  EXPECT_EQ(arguments[0], "render");
  EXPECT_EQ(argument_after(arguments, "--only"), "frames");
  EXPECT_EQ(argument_after(arguments, "--frames"), "5-8");
  EXPECT_EQ(argument_after(arguments, "--threads"), "3");
  EXPECT_EQ(argument_after(arguments, "--output"), shot_.output);
  EXPECT_EQ(argument_after(arguments, "--cache"), shot_.cache);
  EXPECT_NE(std::find(arguments.begin(), arguments.end(), shot_.shot), arguments.end());
}

TEST_F(TaskScript, PathsAndValuesArriveAsTheyAreWhateverIsInThem) {
  std::string folder = kNasty;
  std::replace(folder.begin(), folder.end(), '/', '_');
  start(folder);
  shot_.sets = {"shot.name=" + kNasty, "body.mesh=a b", "x='", "y=\n\n"};
  ASSERT_EQ(run_frames().status, 0) << run_frames().said;
  const std::vector<std::string> arguments = arguments_of(shot_);
  std::vector<std::string> sets;
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i)
    if (arguments[i] == "--set") sets.push_back(arguments[i + 1]);
  EXPECT_EQ(sets, shot_.sets);
  EXPECT_EQ(argument_after(arguments, "--output"), shot_.output);
  EXPECT_EQ(text_of(shot_.program + ".directory"), shot_.directory + "\n");
  EXPECT_FALSE(fs::exists(shot_.directory + "/boom")) << "a part of a name was run";
  EXPECT_EQ(said("frames-5-8").state, "done");
}

TEST_F(TaskScript, SimulatesAllFramesInOneTaskAndMakesTheMovieOfAll) {
  start("others");
  EXPECT_EQ(run({FarmStep::Simulate, 0, {{1, 9}}, {}}).status, 0);
  EXPECT_EQ(arguments_of(shot_)[0], "simulate");
  EXPECT_EQ(argument_after(arguments_of(shot_), "--frames"), "1-9");
  shot_.cache_limit_gb = 3;
  EXPECT_EQ(run({FarmStep::Movie, 0, {{1, 8}}, {0}}).status, 0);
  EXPECT_EQ(argument_after(arguments_of(shot_), "--only"), "movie");
  EXPECT_EQ(argument_after(arguments_of(shot_), "--cache-limit"), "3");
  EXPECT_EQ(run_frames().status, 0);
  EXPECT_EQ(argument_after(arguments_of(shot_), "--cache-limit"), "") << "others still need what it would remove";
}

TEST_F(TaskScript, SaysHowItFares) {
  start("record");
  EXPECT_EQ(run_frames().status, 0);
  const TaskRecord done = said("frames-5-8");
  EXPECT_EQ(done.state, "done");
  EXPECT_EQ(done.node, "node7");
  EXPECT_EQ(done.job, "12_1");
  EXPECT_EQ(done.log, slurm_log({FarmStep::Frames, 0, {{1, 4}, {5, 8}}, {}}, "12_1"));
  EXPECT_EQ(done.status, 0);
}

TEST_F(TaskScript, AFailureKeepsItsStatusAndNamesItsLog) {
  start("failure");
  write(shot_.program + ".status", "7");
  const ShellOutcome outcome = run_frames();
  EXPECT_EQ(outcome.status, 7);
  for (const std::string& part :
       {std::string("node7"), std::string("status 7"), log_folder(shot_) + "/frames-12_1.log"})
    EXPECT_NE(outcome.said.find(part), std::string::npos) << outcome.said;
  EXPECT_EQ(said("frames-5-8").state, "failed");
  EXPECT_EQ(said("frames-5-8").status, 7);
  fs::remove(shot_.program + ".status");
  EXPECT_EQ(run_frames().status, 0);
  EXPECT_EQ(said("frames-5-8").state, "done") << "the second try wins";
}

TEST_F(TaskScript, ANodeThatDoesNotSeeAFolderSaysWhich) {
  start("no_cache");
  fs::rename(shot_.cache, shot_.cache + "_elsewhere");
  expect_refusal(shot_.cache);
  EXPECT_EQ(said("frames-5-8").state, "failed");
  start("no_output");
  fs::rename(shot_.output, shot_.output + "_elsewhere");
  expect_refusal(shot_.output);
  start("no_work");
  fs::rename(shot_.directory, shot_.directory + "_elsewhere");
  const ShellOutcome outcome = run_frames();  // bash has a word of its own for this one
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.said.find(shot_.directory), std::string::npos) << outcome.said;
}

TEST_F(TaskScript, ANodeThatSeesAnotherFolderOfTheSameNameSaysSo) {
  start("other_cache");
  fs::remove(cache_token_path(shot_));
  expect_refusal(shot_.cache);
  start("other_output");
  fs::remove(shot_.records + "/" + shot_.token);
  expect_refusal(shot_.output);
}

TEST_F(TaskScript, ANodeWithoutTheShotOrTheProgramSaysSo) {
  start("no_shot");
  fs::remove(shot_.shot);
  expect_refusal(shot_.shot);
  start("no_program");
  fs::rename(shot_.program, shot_.program + "_elsewhere");
  expect_refusal(shot_.program);
}

TEST_F(TaskScript, AnotherVersionOrBuildIsNotUsed) {
  start("version");
  shot_.version = "softreel 9.8.70";
  expect_refusal("softreel 9.8.7 ");
  start("build");
  write(shot_.program, text_of(shot_.program) + "# another build\n");
  expect_refusal(shot_.program);
}

TEST_F(TaskScript, SaysWhyAProgramDoesNotStart) {
  start("start");
  write(shot_.program, "#!/bin/bash\necho libsomething.so.1 is missing\nexit 127\n");
  const ShellOutcome outcome = run_frames();
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.said.find("libsomething.so.1 is missing"), std::string::npos) << outcome.said;
}

}  // namespace
}  // namespace softreel
