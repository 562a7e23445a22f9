/// Batches as they may end, made up, for tests of their reports.
#pragma once

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tool/batch/batch_result.h"

namespace softreel::testing {

/// Everything that a name or a message can do to markup.
inline const std::string kHostileText = "a<b> & \"c\" 'd' ]]> \x01 \xff\xfe </pre></testcase> \xC3\xA9 \n\ttwo";

/// One job in each state, with nasty words; the failed ones by status 1, by status 2 and by a signal.
inline BatchResult sample_batch() {
  BatchResult batch;
  const auto add = [&](JobState state, int status, int signal, const std::string& message) {
    BatchJob job;
    job.shot = "shots/" + kHostileText + ".toml";
    job.name = "job" + std::to_string(batch.jobs.size());
    job.variant = batch.jobs.size() % 2 == 0 ? kHostileText : "";
    if (!job.variant.empty()) job.swept = {"a.field_of=" + kHostileText, "b=2"};
    job.arguments = {"render", job.shot, "--set", "x='" + kHostileText};
    JobResult result;
    result.state = state;
    result.status = status;
    result.signal = signal;
    result.message = message;
    result.attempts = state == JobState::NotStarted || state == JobState::UpToDate ? 0 : 1;
    result.seconds = 1.25;
    result.plan.known = true;
    result.warnings = {kHostileText};
    batch.jobs.push_back(job);
    batch.results.push_back(result);
  };
  add(JobState::Done, 0, 0, "");
  add(JobState::UpToDate, 0, 0, "");
  add(JobState::Failed, 1, 0, kHostileText);
  add(JobState::Failed, 2, 0, "shot.toml:3: wrong\n  Accepted: right.");
  add(JobState::Failed, 0, SIGABRT, "It was ended by signal 6 (SIGABRT).");
  add(JobState::Interrupted, 0, 0, "");
  add(JobState::NotStarted, 0, 0, "");
  batch.seconds = 3.5;
  batch.bytes = 8e9;
  batch.command = "softreel batch " + kHostileText;
  return batch;
}

/// Runs one of tests/*.py on a text; what it prints, as JSON. A complaint of it fails the test.
inline nlohmann::json checked(const std::string& script, const std::string& text) {
  namespace fs = std::filesystem;
  const std::string path =
      (fs::temp_directory_path() / ("softreel_batch_" + std::to_string(::getpid()) + "." + script)).string();
  std::ofstream(path, std::ios::binary) << text;
  const std::string command =
      "python3 '" SOFTREEL_SOURCE_DIR "/tests/" + script + "' '" + path + "' >'" + path + ".out'";
  EXPECT_EQ(std::system(command.c_str()), 0) << script;
  std::ostringstream out;
  out << std::ifstream(path + ".out").rdbuf();
  fs::remove(path);
  fs::remove(path + ".out");
  return nlohmann::json::parse(out.str(), nullptr, false);
}

}  // namespace softreel::testing
