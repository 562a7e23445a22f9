#include "tool/farm/farm_status.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace softreel {
namespace {

const SubmittedTask kTask{FarmStep::Frames, {5, 8}, "12_1", "frames-12_1.log"};

FarmRecord record_of(std::vector<SubmittedTask> tasks) {
  FarmRecord record;
  record.engine = "slurm";
  record.shot.records = "/srv/out/.farm/barrel";
  record.tasks = std::move(tasks);
  return record;
}

TaskStatus status_of(const std::optional<Queue>& queue, bool there, const TaskRecord& said) {
  const auto statuses = find_task_statuses(
      record_of({kTask}), queue, [&](const SubmittedTask&) { return there; },
      [&](const SubmittedTask&) { return said; });
  return statuses.at(0);
}

TaskState state_of(const std::optional<Queue>& queue, bool there, const TaskRecord& said = {}) {
  return status_of(queue, there, said).state;
}

Queue entry(const std::string& state, const std::string& reason = "None") {
  return {{"12_1", {state, "node2", reason}}};
}

TEST(FarmStatus, WhatIsThereIsDoneWhateverElseIsSaid) {
  EXPECT_EQ(state_of(Queue(), true), TaskState::Done);
  EXPECT_EQ(state_of(entry("FAILED"), true, {"failed", "node2", "", "", "", 1}), TaskState::Done);
  EXPECT_EQ(state_of(std::nullopt, true), TaskState::Done);
}

TEST(FarmStatus, TheQueueSaysWhatGoesOn) {
  EXPECT_EQ(state_of(entry("RUNNING"), false), TaskState::Running);
  EXPECT_EQ(state_of(entry("COMPLETING"), false), TaskState::Running);
  EXPECT_EQ(state_of(entry("PENDING", "Priority"), false), TaskState::Waiting);
  EXPECT_EQ(state_of(entry("PENDING", "PartitionTimeLimit"), false), TaskState::Stuck);
}

TEST(FarmStatus, ATaskThatIsTriedAgainIsNoFailure) {
  EXPECT_EQ(state_of(entry("PENDING", "BeginTime"), false, {"failed", "node1", "", "", "", 9}), TaskState::Waiting);
  EXPECT_EQ(state_of(entry("PENDING", "BeginTime"), false, {"running", "node1", "", "", "", 0}), TaskState::Waiting);
}

TEST(FarmStatus, FailuresSayNodeAndWhy) {
  const TaskStatus failed = status_of(entry("FAILED"), false, {"failed", "node9", "", "", "", 3});
  EXPECT_EQ(failed.state, TaskState::Failed);
  EXPECT_EQ(failed.node, "node9");
  EXPECT_NE(failed.why.find("3"), std::string::npos);
  const TaskStatus killed = status_of(entry("OUT_OF_MEMORY"), false, {"running", "node9", "", "", "", 0});
  EXPECT_EQ(killed.state, TaskState::Failed);
  EXPECT_NE(killed.why.find("OUT_OF_MEMORY"), std::string::npos);
  EXPECT_EQ(state_of(entry("CANCELLED"), false), TaskState::Cancelled);
  const TaskStatus late = status_of(entry("TIMEOUT"), false, {"failed", "node9", "", "", "", 130});
  EXPECT_NE(late.why.find("TIMEOUT"), std::string::npos) << "not that it was interrupted: " << late.why;
}

TEST(FarmStatus, WhatVanishedIsLostNotWaiting) {
  EXPECT_EQ(state_of(Queue(), false, {"running", "node1", "", "", "", 0}), TaskState::Lost);
  EXPECT_EQ(state_of(Queue(), false), TaskState::Lost);
  EXPECT_EQ(state_of(entry("COMPLETED"), false, {"done", "node1", "", "", "", 0}), TaskState::Lost);
}

TEST(FarmStatus, WithoutASchedulerTheTasksOwnWordHolds) {
  EXPECT_EQ(state_of(std::nullopt, false), TaskState::Waiting);
  EXPECT_EQ(state_of(std::nullopt, false, {"running", "node1", "", "", "", 0}), TaskState::Running);
  EXPECT_EQ(state_of(std::nullopt, false, {"failed", "node1", "", "", "", 1}), TaskState::Failed);
}

TEST(FarmStatus, StopsWhenAllThatWaitsWaitsForWhatFailed) {
  const TaskStatus failed{kTask, TaskState::Failed, "node1", "exit status 1"};
  const TaskStatus blocked{kTask, TaskState::Waiting, "", "Dependency"};
  const TaskStatus waiting{kTask, TaskState::Waiting, "", "Resources"};
  const TaskStatus done{kTask, TaskState::Done, "", ""};
  EXPECT_TRUE(summarize({failed, blocked, done}).has_stopped());
  EXPECT_FALSE(summarize({failed, waiting}).has_stopped());
  EXPECT_FALSE(summarize({waiting, blocked}).has_stopped());
  EXPECT_FALSE(summarize({failed, {kTask, TaskState::Running, "node1", ""}}).has_stopped());
  EXPECT_TRUE(summarize({done, done}).all_done());
  EXPECT_FALSE(summarize({done, failed}).all_done());
}

TEST(FarmStatus, FailingTasksAreNamedWithTheirLogs) {
  const std::vector<TaskStatus> statuses{{kTask, TaskState::Failed, "node1", "exit status 1"}};
  const auto told = [](const SubmittedTask&) { return std::string("softreel: the disk is full"); };
  const std::string text = status_text(record_of({kTask}), statuses, told);
  for (const char* part :
       {"5-8", "node1", "exit status 1", "the disk is full", "/srv/out/.farm/barrel/logs/frames-12_1.log"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
  const auto json = nlohmann::json::parse(status_json(record_of({kTask}), statuses, told));
  EXPECT_EQ(json["done"], false);
  EXPECT_EQ(json["stopped"], true);
  EXPECT_EQ(json["tasks"][0]["state"], "failed");
  EXPECT_EQ(json["tasks"][0]["log"], "/srv/out/.farm/barrel/logs/frames-12_1.log");
}

TEST(FarmStatus, FindsTheTellingLineOfALog) {
  EXPECT_EQ(telling_line("frames 1 of 8\n\nsoftreel: shot.toml:3: is wrong\n  Accepted: right.\n"
                         "softreel farm: frames-1-2 of x failed on node n1 with status 2; log: /l\n"),
            "softreel: shot.toml:3: is wrong");
  EXPECT_EQ(telling_line("frames 1 of 8\nslurmstepd: error: *** JOB 12 CANCELLED DUE TO TIME LIMIT ***\n"),
            "slurmstepd: error: *** JOB 12 CANCELLED DUE TO TIME LIMIT ***");
  EXPECT_EQ(telling_line("softreel farm: simulate of x: node n1 does not see the cache folder /c.\n"),
            "softreel farm: simulate of x: node n1 does not see the cache folder /c.");
  EXPECT_EQ(telling_line("slurmstepd-east: error: *** JOB 13 ON east CANCELLED DUE TO TIME LIMIT ***\n"
                         "softreel: Interrupted; what is finished is kept.\n"),
            "slurmstepd-east: error: *** JOB 13 ON east CANCELLED DUE TO TIME LIMIT ***");
  EXPECT_EQ(
      telling_line("slurmstepd: error: *** JOB 13 CANCELLED DUE TO NODE FAILURE ***\nsoftreel: the disk is full\n"),
      "softreel: the disk is full")
      << "a log goes on when a task is tried again";
  EXPECT_EQ(telling_line("Segmentation fault"), "Segmentation fault");
  EXPECT_EQ(telling_line(""), "");
}

}  // namespace
}  // namespace softreel
