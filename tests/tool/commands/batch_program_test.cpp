/// Batches that nothing disturbs: what runs, what is left out, what is refused, and the reports.
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

/// A folder with shot.toml and second.toml, which have other names and other light.
std::string two_shots(const std::string& name) {
  const std::string folder = shot_folder(name);
  std::string second = sphere_shot();
  second.replace(second.find("\"ball\""), 6, "\"second\"");
  second.replace(second.find("zenith = [0.6"), 13, "zenith = [0.9");
  write_text(folder + "/second.toml", second);
  return folder;
}

Outcome batch(const std::string& folder, const std::string& more) {
  return run(fmt::format("cd {} && softreel batch {}", folder, more));
}

json report_of(const Outcome& outcome) {
  json report = json::parse(outcome.out, nullptr, false);
  EXPECT_TRUE(report.is_object()) << outcome.out << outcome.err;
  return report;
}

/// tests/SCRIPT on a file; what it prints.
json checked(const std::string& script, const std::string& path) {
  const Outcome outcome = run(fmt::format("python3 '{}/tests/{}' {}", SOFTREEL_SOURCE_DIR, script, path));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return json::parse(outcome.out, nullptr, false);
}

TEST(Batch, OneFailingShotStopsNoOther) {
  const std::string folder = two_shots("batch");
  write_text(folder + "/bad.toml", sphere_shot("[rendr]\n"));
  std::string unmovable = sphere_shot();
  unmovable.replace(unmovable.find("sphere.obj"), 10, "nowhere.obj");
  unmovable.replace(unmovable.find("\"ball\""), 6, "\"unmovable\"");
  write_text(folder + "/unmovable.toml", unmovable);
  const Outcome outcome =
      batch(folder, "bad.toml shot.toml unmovable.toml second.toml --output out --frames 1-2 --json");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("2 of 4 jobs failed"), std::string::npos) << outcome.err;
  const json report = report_of(outcome);
  const std::vector<std::string> states{"failed", "done", "failed", "done"};
  for (std::size_t i = 0; i < states.size(); ++i) EXPECT_EQ(report["jobs"][i]["state"], states[i]) << i;
  EXPECT_EQ(report["jobs"][0]["status"], 2);
  EXPECT_NE(report["jobs"][0]["message"].get<std::string>().find("rendr"), std::string::npos);
  EXPECT_NE(report["jobs"][2]["message"].get<std::string>().find("nowhere.obj"), std::string::npos);
  EXPECT_TRUE(exists(folder + "/out/ball.0002.png"));
  EXPECT_TRUE(exists(folder + "/out/second.0002.png"));
  const json suite = checked("check_junit.py", folder + "/out/batch.junit.xml");
  EXPECT_EQ(suite["counts"], (json{{"tests", 4}, {"failures", 2}, {"errors", 0}, {"skipped", 0}}));
  const json page = checked("check_page.py", folder + "/out/batch.html");
  EXPECT_EQ(page["counts"]["svg"], 2) << "energies of what was simulated";
  EXPECT_EQ(page["counts"]["img"], 4) << "a cover and a sheet of what was rendered";
  EXPECT_EQ(json::parse(read_text(folder + "/out/batch.json")), report);
}

TEST(Batch, ASweepRendersAllCombinationsInFoldersOfTheirOwnAndFillsOnce) {
  const std::string folder = shot_folder("sweep");
  const Outcome outcome =
      batch(folder,
            "shot.toml --output out --frames 1-2 --json --jobs 3 --sweep "
            "material.soft.youngs_modulus=1e4,4e4 --sweep 'gravity.acceleration=[0,-9.81,0],[0, 0, 0]'");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = report_of(outcome);
  ASSERT_EQ(report["jobs"].size(), 4U);
  std::set<std::string> pictures;
  int filled = 0;
  for (const json& job : report["jobs"]) {
    EXPECT_EQ(job["state"], "done");
    EXPECT_EQ(job["output"], "out/" + job["variant"].get<std::string>());
    const std::string place = folder + "/" + job["output"].get<std::string>();
    pictures.insert(read_text(place + "/ball.0002.png"));
    const json bodies = json::parse(read_text(place + "/ball.report.json"))["bodies"];
    filled += bodies[0]["tets_from_cache"].get<bool>() ? 0 : 1;
  }
  EXPECT_TRUE(exists(folder + "/out/material.soft.youngs_modulus=1e4,gravity.acceleration=0_0_0/ball.0001.png"));
  EXPECT_EQ(pictures.size(), 4U) << "each variant looks different";
  EXPECT_EQ(filled, 1) << "all have the same tetrahedra: one job made them";
  EXPECT_EQ(files_under(folder + "/out/.cache/2/tetrahedra").size(), 1U);
}

TEST(Batch, RunsOnlyWhatIsMissingAndSaysSo) {
  const std::string folder = two_shots("again");
  const std::string command = "shot.toml second.toml --output out --frames 1-3 --json";
  ASSERT_EQ(batch(folder, command).status, 0);
  const Outcome again = batch(folder, command);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.err.find("2 of 2 jobs are up to date"), std::string::npos) << again.err;
  const json report = report_of(again);
  for (const json& job : report["jobs"]) {
    EXPECT_EQ(job["state"], "up to date");
    EXPECT_EQ(job["attempts"], 0);
  }
  const json page = checked("check_page.py", folder + "/out/batch.html");
  EXPECT_EQ(page["counts"]["svg"], 2) << "the page still shows the energies of the run that made the frames";
  run(fmt::format("rm {}/out/ball.0002.png", folder));
  write_text(folder + "/out/second.0001.png", "damaged");
  const json mended = report_of(batch(folder, command));
  EXPECT_EQ(mended["jobs"][0]["state"], "done");
  EXPECT_EQ(mended["jobs"][0]["traced"], 0) << "the cache has it";
  EXPECT_EQ(mended["jobs"][1]["state"], "done");
  const json longer = report_of(batch(folder, "shot.toml second.toml --output out --frames 1-4 --json"));
  EXPECT_EQ(longer["jobs"][0]["traced"], 1);
  EXPECT_EQ(longer["jobs"][1]["traced"], 1);
  EXPECT_EQ(longer["jobs"][0]["simulated"].get<int>() + longer["jobs"][1]["simulated"].get<int>(), 1)
      << "their motion is the same: one job simulates the frame";
}

TEST(Batch, AJobWithPicturesOfFramesThatItsShotNoLongerHasIsNotUpToDate) {
  const std::string folder = shot_folder("longer_before");
  ASSERT_EQ(batch(folder, "shot.toml --output out").status, 0);
  const std::string shorter = "shot.toml --output out --set shot.frames=[1,2] --json";
  EXPECT_EQ(report_of(batch(folder, shorter))["jobs"][0]["state"], "done");
  EXPECT_FALSE(exists(folder + "/out/ball.0003.png"));
  EXPECT_EQ(report_of(batch(folder, shorter))["jobs"][0]["state"], "up to date");
}

TEST(Batch, DryRunListsJobsWithMemoryTimeAndWhatIsThereAndWritesNothing) {
  const std::string folder = two_shots("dry_batch");
  ASSERT_EQ(run(fmt::format("cd {} && softreel render shot.toml --output out --quiet", folder)).status, 0);
  const std::vector<std::string> before = files_under(folder);
  const Outcome dry = batch(folder, "shot.toml second.toml --output out --dry-run");
  EXPECT_EQ(dry.status, 0) << dry.err;
  for (const char* part : {"ball    up to date", "second  simulate 0 of 4, trace 4 of 4; memory ", ", time ", "in all"})
    EXPECT_NE(dry.out.find(part), std::string::npos) << part << "\n" << dry.out;
  const json report = report_of(batch(folder, "shot.toml second.toml --output out --dry-run --json"));
  EXPECT_TRUE(report["jobs"][0]["expected"]["complete"].get<bool>());
  EXPECT_EQ(report["jobs"][1]["expected"]["trace"]["missing"], 4);
  EXPECT_GT(report["jobs"][1]["expected"]["bytes"].get<double>(), 1e6);
  EXPECT_EQ(files_under(folder), before);
}

TEST(Batch, RefusesBeforeAnythingRuns) {
  const std::string folder = two_shots("refused");
  const auto refused = [&](const std::string& more, const std::vector<std::string>& parts) {
    const Outcome outcome = batch(folder, more + " --output out");
    EXPECT_EQ(outcome.status, 2) << more << outcome.err;
    for (const std::string& part : parts)
      EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\n" << outcome.err;
    EXPECT_FALSE(exists(folder + "/out")) << more;
  };
  refused("shot.toml shot.toml", {"same files", "out/ball.####.png", "shot.name"});
  refused("shot.toml second.toml --set shot.name=one", {"shot.toml and second.toml", "same files"});
  refused("shot.toml --sweep material.soft.youngs_modulos=1,2", {"youngs_modulus"});
  refused("shot.toml --sweep material.sift.youngs_modulus=1,2", {"--sweep", "soft"});
  refused("shot.toml --sweep material.soft.poisson_ratio=0.3,0.7", {"--sweep", "0.7", "0 to 0.499"});
  refused("shot.toml --set body.ball.tetz=5", {"tets"});
  refused("shot.toml --set material.soft.density=-5 --sweep body.tets=700,800",
          {"softreel: --set: material.soft.density = -5", "above 0"});
  refused("shot.toml --set material.sift.density=5 --sweep body.tets=700,800",
          {"softreel: --set: material.sift", "soft"});
  refused("shot.toml --set material.soft.density=5 --sweep body.tets=700,-8",
          {"softreel: --sweep: body.ball.tets = -8"});
  refused("shot.toml --set body.tets=900 --sweep body.tets=700,800", {"--set"});
  refused("shot.toml --set body.ball.tets=900 --sweep body.tets=700,800", {"body.tets is also given by --set"});
  refused("shot.toml --sweep body.tets=700,800 --sweep body.ball.tets=900,950",
          {"body.tets and body.ball.tets are one field"});
  refused("shot.toml --sweep solver.threads=1,2", {"solver.threads", "--threads"});
  refused("shot.toml --sweep output.directory=a,b", {"output.directory", "--output"});
  refused("shot.toml --memory nan", {"--memory"});
  refused("shot.toml --jobs 0", {"--jobs"});
}

TEST(Batch, TheLogFileHasTheMessagesOfTheBatchAndOfItsJobs) {
  const std::string folder = two_shots("logged");
  std::string bad = sphere_shot();
  bad.replace(bad.find("sphere.obj"), 10, "nowhere.obj");
  bad.replace(bad.find("\"ball\""), 6, "\"bad\"");
  write_text(folder + "/bad.toml", bad);
  EXPECT_EQ(batch(folder, "shot.toml second.toml bad.toml --output out --frames 1 --quiet --log-file all.log").status,
            1);
  std::istringstream lines(read_text(folder + "/all.log"));
  std::set<std::string> processes;
  std::string all;
  for (std::string time, process, rest; lines >> time >> process && std::getline(lines, rest); all += rest + "\n")
    if (time.starts_with("20")) processes.insert(process);
  EXPECT_EQ(processes.size(), 3U) << "the batch and the two jobs that ran";
  for (const char* part : {"info: batch: 3 jobs", "info: done    ball", "info: done    second", "debug: stage",
                           "warning: FAILED  bad", "nowhere.obj", "error: 1 of 3 jobs failed"})
    EXPECT_NE(all.find(part), std::string::npos) << part << "\n" << all;
}

TEST(Batch, AJobLargerThanAllMemoryRunsAloneWithANote) {
  const std::string folder = two_shots("alone");
  const Outcome outcome = batch(folder, "shot.toml second.toml --output out --frames 1 --json --memory 1e-6 --jobs 2");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("note: ball is expected to need"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("runs alone"), std::string::npos) << outcome.err;
  const json report = report_of(outcome);
  for (const json& job : report["jobs"]) EXPECT_TRUE(job["alone"].get<bool>());
}

TEST(Batch, FailFastStartsNoMoreJobs) {
  const std::string folder = two_shots("fail_fast");
  // It loads, and stops at the first step: no solve in one iteration reaches such a tolerance.
  const std::string impossible = "--set solver.max_iterations=1 --set solver.tolerance=1e-12";
  const auto states = [&](const std::string& more) {
    std::vector<std::string> all;
    const Outcome outcome =
        batch(folder, fmt::format("shot.toml second.toml --output out --json --jobs 1 {} {}", impossible, more));
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    const json report = report_of(outcome);
    for (const json& job : report["jobs"]) all.push_back(job["state"]);
    return all;
  };
  EXPECT_EQ(states("--fail-fast"), (std::vector<std::string>{"failed", "not started"}));
  EXPECT_EQ(states("--keep-going"), (std::vector<std::string>{"failed", "failed"}));
}

TEST(Batch, OnATerminalThereIsALineForEachJobAndOneForAll) {
  const std::string folder = two_shots("terminal");
  const Outcome outcome = run(fmt::format(
      "cd {} && script -qec '\"{}\" batch shot.toml second.toml --output out --jobs 2 --set render.samples=64' log",
      folder, SOFTREEL_PROGRAM));
  ASSERT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  const std::string log = read_text(folder + "/log");
  EXPECT_NE(log.find("\033[3A"), std::string::npos) << "three lines were drawn over";
  EXPECT_NE(log.find("0 of 2 done, 2 running, 0 waiting"), std::string::npos) << log;
  const std::string end = log.substr(log.rfind("\033[J"));
  EXPECT_EQ(end.find("running,"), std::string::npos) << "nothing of the display stays:\n" << end;
}

TEST(Batch, ElsewhereThereAreNoControlCharacters) {
  const std::string folder = two_shots("no_terminal");
  const Outcome outcome = batch(folder, "shot.toml second.toml --output out --frames 1");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err.find('\033'), std::string::npos);
  for (const char* part : {"start   ball", "done    ball", "start   second", "done    second"})
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\n" << outcome.err;
  EXPECT_EQ(batch(folder, "shot.toml second.toml --output out --frames 1 --quiet").err, "");
}

}  // namespace
}  // namespace softreel
