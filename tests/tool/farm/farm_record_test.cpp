#include "tool/farm/farm_record.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace softreel {
namespace {

FarmRecord some_record() {
  FarmRecord record;
  record.engine = "slurm";
  record.user = 1007;
  record.shot = {"name \"x\"", "/s/shot.toml",   "/s/out", "/s/cache",      "/s/out/.farm/name", "farm-01",
                 "/s/work",    {"a=\n'", "b=c"}, 2.5,      "/bin/softreel", "softreel 1",        "abc"};
  record.frames = {-3, 96};
  record.settings.partition = "long";
  record.settings.sbatch = {"--nice=4", ""};
  record.settings.chunk = 5;
  record.tasks = {{FarmStep::Simulate, {-3, 96}, "7", "simulate-7.log"}, {FarmStep::Movie, {-3, 96}, "9", "m.log"}};
  return record;
}

TEST(FarmRecord, ComesBackAsItWasWritten) {
  const FarmRecord record = some_record();
  const FarmRecord read = parse_farm_record(to_json(record), "submission.json");
  EXPECT_EQ(to_json(read), to_json(record));
  EXPECT_EQ(read.shot.sets, record.shot.sets);
  EXPECT_EQ(read.shot.cache_limit_gb, 2.5);
  EXPECT_EQ(read.settings.sbatch, record.settings.sbatch);
  ASSERT_EQ(read.tasks.size(), 2U);
  EXPECT_EQ(read.tasks[1].step, FarmStep::Movie);
  EXPECT_EQ(read.frames, record.frames);
  EXPECT_EQ(read.user, 1007U);
}

TEST(FarmRecord, WhatIsNoRecordIsRefusedByName) {
  for (const char* text : {"", "{", "[]", "{\"format\": 2}", "{\"format\": 1}"}) {
    try {
      parse_farm_record(text, "/s/submission.json");
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      EXPECT_EQ(std::string(error.what()).find("/s/submission.json"), 0U) << error.what();
    }
  }
}

TEST(FarmRecord, RefusesTextThatJsonCannotCarry) {
  FarmRecord record = some_record();
  record.shot.output = "/s/\xFF";
  EXPECT_THROW(to_json(record), Error);
}

TEST(FarmRecord, HalfAWordOfATaskDoesNotCount) {
  const std::string whole = "failed\nnode1\n3\nframes-1_2.log\n2030-01-01T00:00:00Z\n1_2\n";
  const TaskRecord record = parse_task_record(whole);
  EXPECT_EQ(record.state, "failed");
  EXPECT_EQ(record.node, "node1");
  EXPECT_EQ(record.status, 3);
  EXPECT_EQ(record.job, "1_2");
  for (std::size_t size = 0; size + 1 < whole.size(); ++size)
    EXPECT_TRUE(parse_task_record(whole.substr(0, size)).state.empty()) << size;
  EXPECT_TRUE(parse_task_record("failed\nnode1\nx\nlog\ntime\njob\n").state.empty());
}

}  // namespace
}  // namespace softreel
