#include "tool/farm/slurm.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/tool/farm/shell.h"
#include "tool/farm/slurm_queue.h"

namespace softreel {
namespace {

using namespace softreel::testing;

FarmShot some_shot() {
  FarmShot shot;
  shot.name = "barrel";
  shot.output = "/srv/out";
  shot.records = "/srv/out/.farm/barrel";
  return shot;
}

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

const FarmJob kFrames{FarmStep::Frames, 0, {{1, 4}, {5, 8}, {9, 10}}, {0}};

TEST(Slurm, SubmitsChunksAsAnArrayWithLimits) {
  const std::vector<std::string> command =
      sbatch_command(some_shot(), kFrames, {4, 3.5 * 1073741824.0, 601}, {}, {}, "frames.sh");
  EXPECT_EQ(command.front(), "sbatch");
  EXPECT_EQ(command.back(), "frames.sh");
  EXPECT_TRUE(contains(command, "--array=0-2"));
  EXPECT_TRUE(contains(command, "--cpus-per-task=4"));
  EXPECT_TRUE(contains(command, "--mem=3584M"));
  EXPECT_TRUE(contains(command, "--time=11")) << "a limit that is not whole minutes is rounded up";
  EXPECT_TRUE(contains(command, "--requeue"));
}

TEST(Slurm, NoDependentJobWaitsForWhatFailed) {
  const std::vector<std::string> command = sbatch_command(some_shot(), kFrames, {}, {}, {"12", "9_3"}, "frames.sh");
  EXPECT_TRUE(contains(command, "--dependency=afterok:12:9_3"));
  EXPECT_TRUE(contains(command, "--kill-on-invalid-dep=yes"));
  const std::vector<std::string> free = sbatch_command(some_shot(), kFrames, {}, {}, {}, "frames.sh");
  for (const std::string& word : free) EXPECT_EQ(word.find("dep"), std::string::npos) << word;
}

TEST(Slurm, WaitsForWhatTheUserSaysBesideItsOwnJobs) {
  const auto command_of = [](const std::vector<std::string>& words, const std::vector<std::string>& after) {
    FarmSettings settings;
    settings.sbatch = words;
    return sbatch_command(some_shot(), kFrames, {}, settings, after, "frames.sh");
  };
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{{"--dependency=afterany:7"},
                                                                                     {"--dep=afterany:7"},
                                                                                     {"--dependency", "afterany:7"},
                                                                                     {"-d", "afterany:7"},
                                                                                     {"-dafterany:7"}}) {
    const std::vector<std::string> command = command_of(words, {"12"});
    EXPECT_TRUE(contains(command, "--dependency=afterok:12,afterany:7")) << words.front();
    EXPECT_FALSE(contains(command, words.front()));
    EXPECT_TRUE(contains(command_of(words, {}), "--dependency=afterany:7")) << words.front();
  }
  EXPECT_TRUE(contains(command_of({"--deadline=now", "--nice"}, {"12"}), "--deadline=now"));
  EXPECT_THROW(command_of({"--dependency=afterok:7?afterok:8"}, {}), Error);
}

TEST(Slurm, PassesOnWhatTheUserSays) {
  FarmSettings settings;
  settings.partition = "long jobs";
  settings.account = "film";
  settings.constraint = "avx512&bigmem";
  settings.sbatch = {"--nice=100", "--comment=it's $HOME"};
  const std::vector<std::string> command = sbatch_command(some_shot(), kFrames, {}, settings, {}, "frames.sh");
  for (const char* word :
       {"--partition=long jobs", "--account=film", "--constraint=avx512&bigmem", "--nice=100", "--comment=it's $HOME"})
    EXPECT_TRUE(contains(command, word)) << word;
}

TEST(Slurm, LogsLieWhereSlurmWritesThem) {
  FarmShot shot = some_shot();
  shot.records = "/srv/100%/.farm/barrel";
  const std::vector<std::string> command = sbatch_command(shot, kFrames, {}, {}, {}, "frames.sh");
  EXPECT_TRUE(contains(command, "--output=/srv/100%%/.farm/barrel/logs/frames-%A_%a.log"));
  EXPECT_EQ(slurm_log(kFrames, slurm_task(kFrames, "12", 2)), "frames-12_2.log");
  const FarmJob simulate{FarmStep::Simulate, 0, {{1, 10}}, {}};
  EXPECT_TRUE(contains(sbatch_command(shot, simulate, {}, {}, {}, "s.sh"),
                       "--output=/srv/100%%/.farm/barrel/logs/simulate-%j.log"));
  EXPECT_EQ(slurm_log(simulate, slurm_task(simulate, "12", 0)), "simulate-12.log");
  shot.records = "/srv/back\\slash";
  EXPECT_THROW(sbatch_command(shot, kFrames, {}, {}, {}, "frames.sh"), Error);
}

TEST(Slurm, NamesOfJobsBreakNoLine) {
  FarmShot shot = some_shot();
  shot.name = kNasty;
  for (const std::string& word : sbatch_command(shot, kFrames, {}, {}, {}, "frames.sh"))
    EXPECT_EQ(word.find('\n'), std::string::npos) << word;
}

TEST(Slurm, FindsTheNumberOfAJobBesideWarnings) {
  EXPECT_EQ(submitted_job("17\n"), "17");
  EXPECT_EQ(submitted_job("sbatch: warning: 3 is a crowd\n18;cluster\n"), "18");
  EXPECT_THROW(submitted_job(""), Error);
  EXPECT_THROW(submitted_job("Submitted batch job\n"), Error);
}

TEST(Slurm, ReadsTheQueue) {
  const Queue queue =
      parse_queue("12_0|RUNNING|node1|None\n12_1|PENDING||Resources\ngarbage\n13|TIMEOUT|node2|TimeLimit\n");
  ASSERT_EQ(queue.size(), 3U);
  EXPECT_EQ(queue.at("12_0").node, "node1");
  EXPECT_EQ(queue.at("12_1").reason, "Resources");
  EXPECT_TRUE(is_live(queue.at("12_0")));
  EXPECT_TRUE(is_live(queue.at("12_1")));
  EXPECT_FALSE(is_live(queue.at("13")));
  EXPECT_TRUE(parse_queue("").empty());
}

TEST(Slurm, KnowsWhatWaitsForEver) {
  for (const char* reason : {"PartitionTimeLimit", "DependencyNeverSatisfied", "JobHeldUser", "BadConstraints",
                             "launch failed requeued held"})
    EXPECT_TRUE(is_hopeless({"PENDING", "", reason})) << reason;
  for (const char* reason : {"Resources", "Priority", "Dependency", "BeginTime", "None", "QOSMaxJobsPerUserLimit"})
    EXPECT_FALSE(is_hopeless({"PENDING", "", reason})) << reason;
  EXPECT_FALSE(is_hopeless({"RUNNING", "node1", "None"}));
}

}  // namespace
}  // namespace softreel
