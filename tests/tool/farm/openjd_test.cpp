/// The template against the rules of the specification, 2023-09: chapters are its.
#include "tool/farm/openjd.h"

#include <filesystem>
#include <regex>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "tests/tool/farm/shell.h"
#include "tool/farm/farm_record.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

json template_of(const FarmShot& shot, const std::vector<FarmJob>& jobs) {
  return json::parse(openjd_template(shot, jobs, std::vector<FarmNeeds>(jobs.size(), {2, 3e9, 600})));
}

std::vector<FarmJob> some_jobs() {
  return plan_jobs({FrameChunk{1, 9}, {1, 2, 3, 4, 5, 6, 7, 8}, FrameChunk{1, 8}}, 2, 3);
}

bool has_control(const std::string& text) {
  for (const char c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) return true;
  return false;
}

/// Replaces each reference by its value; what is unknown is noted as a failure.
std::string resolved(const std::string& text, const std::map<std::string, std::string>& values) {
  static const std::regex reference(R"(\{\{\s*([A-Za-z_][A-Za-z0-9_.]*)\s*\}\})");
  std::string result, literal;
  auto at = text.begin();
  for (std::sregex_iterator match(text.begin(), text.end(), reference), end; match != end; ++match) {
    literal.append(at, text.begin() + match->position());
    result.append(at, text.begin() + match->position());
    at = text.begin() + match->position() + match->length();
    const auto value = values.find((*match)[1]);
    EXPECT_NE(value, values.end()) << (*match)[1] << " is defined nowhere";
    if (value != values.end()) result += value->second;
  }
  literal.append(at, text.end());
  result.append(at, text.end());
  EXPECT_EQ(literal.find("{{"), std::string::npos) << "braces that are no reference: " << literal;
  return result;
}

std::map<std::string, std::string> job_values(const json& root) {
  std::map<std::string, std::string> values;
  for (const json& parameter : root["parameterDefinitions"])
    values["Param." + parameter["name"].get<std::string>()] = parameter["default"];
  return values;
}

const std::regex kIdentifier("[A-Za-z_][A-Za-z0-9_]{0,63}");

TEST(OpenJd, TheRootHasWhatItMustAndNothingElse) {  // 1.1
  const json root = template_of(stand_in_shot(farm_folder("root")), some_jobs());
  EXPECT_EQ(root["specificationVersion"], "jobtemplate-2023-09");
  const std::set<std::string> known{"specificationVersion", "name", "description", "parameterDefinitions", "steps"};
  for (const auto& [name, value] : root.items()) EXPECT_EQ(known.count(name), 1U) << name;
  const std::string name = root["name"];
  EXPECT_GE(name.size(), 1U);
  EXPECT_LE(name.size(), 128U);
  EXPECT_FALSE(has_control(name));
  EXPECT_EQ(resolved(name, {}), name) << "the name refers to nothing";
  EXPECT_GE(root["steps"].size(), 1U);
}

TEST(OpenJd, ParametersAreIdentifiersOfKnownTypesWithinTheirLimits) {  // 2.2, 2.5, 7.1
  const json root = template_of(stand_in_shot(farm_folder("parameters")), some_jobs());
  std::set<std::string> names;
  for (const json& parameter : root["parameterDefinitions"]) {
    EXPECT_TRUE(std::regex_match(parameter["name"].get<std::string>(), kIdentifier)) << parameter["name"];
    EXPECT_TRUE(names.insert(parameter["name"]).second) << parameter["name"];
    EXPECT_EQ(parameter["type"], "PATH");
    EXPECT_TRUE(parameter["objectType"] == "FILE" || parameter["objectType"] == "DIRECTORY");
    EXPECT_LE(parameter["default"].get<std::string>().size(), 1024U);
  }
  EXPECT_GE(names.size(), 1U);
  EXPECT_LE(names.size(), 50U);
}

TEST(OpenJd, StepsHaveNamesOfTheirOwnAndDependOnEarlierOnes) {  // 3, 3.1, 3.2
  const json root = template_of(stand_in_shot(farm_folder("steps")), some_jobs());
  std::set<std::string> names;
  for (const json& step : root["steps"]) {
    const std::string name = step["name"];
    EXPECT_TRUE(name.size() >= 1 && name.size() <= 64 && !has_control(name)) << name;
    if (step.contains("dependencies")) {
      EXPECT_GE(step["dependencies"].size(), 1U);
      for (const json& dependency : step["dependencies"])
        EXPECT_EQ(names.count(dependency["dependsOn"]), 1U) << dependency;
    }
    EXPECT_TRUE(names.insert(name).second) << name << " is there twice";
  }
  EXPECT_EQ(root["steps"].size(), 4U) << "simulate, two arrays of frames, movie";
  EXPECT_EQ(root["steps"].back()["dependencies"].size(), 2U);
}

TEST(OpenJd, RequirementsAndTasksAreWithinTheirLimits) {  // 3.3, 3.4
  const json root = template_of(stand_in_shot(farm_folder("needs")), some_jobs());
  std::set<std::string> chunks;
  for (const json& step : root["steps"]) {
    const json& needs = step["hostRequirements"];
    for (const json& amount : needs["amounts"]) {
      EXPECT_TRUE(
          std::regex_match(amount["name"].get<std::string>(), std::regex("amount(\\.[A-Za-z_][A-Za-z0-9_]*)+")));
      EXPECT_GT(amount["min"].get<double>(), 0);
    }
    for (const json& attribute : needs["attributes"]) {
      EXPECT_TRUE(
          std::regex_match(attribute["name"].get<std::string>(), std::regex("attr(\\.[A-Za-z_][A-Za-z0-9_]*)+")));
      for (const json& value : attribute["anyOf"])
        EXPECT_TRUE(std::regex_match(value.get<std::string>(), std::regex("[A-Za-z_][A-Za-z0-9_-]{0,99}")));
    }
    if (!step.contains("parameterSpace")) continue;
    for (const json& parameter : step["parameterSpace"]["taskParameterDefinitions"]) {
      EXPECT_TRUE(std::regex_match(parameter["name"].get<std::string>(), kIdentifier));
      EXPECT_EQ(parameter["type"], "STRING");
      EXPECT_GE(parameter["range"].size(), 1U);
      EXPECT_LE(parameter["range"].size(), kMostOpenJdTasks);
      for (const json& value : parameter["range"]) EXPECT_TRUE(chunks.insert(value).second) << value;
    }
  }
  EXPECT_EQ(chunks, (std::set<std::string>{"1-2", "3-4", "5-6", "7-8"}));
}

/// Runs a step's task as a worker would: references resolved, files written, the command run with bash.
ShellOutcome run_task(const json& root, const json& step, const std::string& frames) {
  std::map<std::string, std::string> values = job_values(root);
  if (step.contains("parameterSpace")) values["Task.Param.Frames"] = frames;
  const json& file = step["script"]["embeddedFiles"][0];
  EXPECT_TRUE(std::regex_match(file["name"].get<std::string>(), kIdentifier));
  EXPECT_LE(file["filename"].get<std::string>().size(), 64U);
  EXPECT_EQ(file["type"], "TEXT");
  values["Task.File." + file["name"].get<std::string>()] = "script";
  const json& action = step["script"]["actions"]["onRun"];
  EXPECT_EQ(resolved(action["command"], values), "bash");
  EXPECT_GT(action["timeout"].get<long>(), 0);
  std::vector<std::string> arguments;
  for (const json& argument : action["args"]) {
    arguments.push_back(resolved(argument, values));
    EXPECT_FALSE(has_control(arguments.back())) << "5.2: " << arguments.back();
  }
  EXPECT_EQ(arguments.front(), "script");
  arguments.erase(arguments.begin());
  return run_bash(resolved(file["data"], values), arguments);
}

TEST(OpenJd, EveryTaskRunsSoftreelWithItsFrames) {
  FarmShot shot = stand_in_shot(farm_folder("run it's {{Param.Shot}} $(touch boom)"));
  shot.sets = {"shot.name=" + kNasty, "a={{Param.Shot}}"};
  const json root = template_of(shot, some_jobs());
  const json& steps = root["steps"];
  ASSERT_EQ(run_task(root, steps[0], "").status, 0) << run_task(root, steps[0], "").said;
  EXPECT_EQ(arguments_of(shot)[0], "simulate");
  EXPECT_EQ(argument_after(arguments_of(shot), "--frames"), "1-9");
  EXPECT_EQ(argument_after(arguments_of(shot), "--set"), shot.sets[0]) << "as it was given, whatever is in it";
  for (const std::string frames : {"1-2", "5-6"}) {
    ASSERT_EQ(run_task(root, steps[1], frames).status, 0);
    EXPECT_EQ(argument_after(arguments_of(shot), "--only"), "frames");
    EXPECT_EQ(argument_after(arguments_of(shot), "--frames"), frames);
    EXPECT_EQ(argument_after(arguments_of(shot), "--output"), shot.output);
    EXPECT_EQ(parse_task_record(text_of(record_path(shot, "frames-" + frames))).state, "done");
  }
  ASSERT_EQ(run_task(root, steps[3], "").status, 0);
  EXPECT_EQ(argument_after(arguments_of(shot), "--only"), "movie");
}

TEST(OpenJd, AFailingTaskKeepsItsStatusAndItsLog) {
  const FarmShot shot = stand_in_shot(farm_folder("fails"));
  write(shot.program, "#!/bin/bash\n[ \"$1\" = --version ] && echo softreel 9.8.7 && exit\necho it burns\nexit 5\n");
  FarmShot other = shot;
  other.checksum = run_bash("sha256sum <\"$1\"", {shot.program}).said.substr(0, 64);
  const json root = template_of(other, some_jobs());
  EXPECT_EQ(run_task(root, root["steps"][1], "1-2").status, 5);
  const TaskRecord record = parse_task_record(text_of(record_path(shot, "frames-1-2")));
  EXPECT_EQ(record.state, "failed");
  EXPECT_EQ(record.status, 5);
  EXPECT_NE(text_of(log_folder(shot) + "/" + record.log).find("it burns"), std::string::npos);
}

TEST(OpenJd, ATaskThatCannotStartSaysWhyInItsLog) {
  const FarmShot shot = stand_in_shot(farm_folder("starts_not"));
  FarmShot other = shot;
  other.checksum = std::string(64, '0');
  const json root = template_of(other, some_jobs());
  EXPECT_EQ(run_task(root, root["steps"][1], "1-2").status, 2);
  const TaskRecord record = parse_task_record(text_of(record_path(shot, "frames-1-2")));
  EXPECT_EQ(record.state, "failed");
  EXPECT_NE(text_of(log_folder(shot) + "/" + record.log).find("another build"), std::string::npos);
}

TEST(OpenJd, RefusesPathsThatATemplateCannotCarry) {
  FarmShot shot = stand_in_shot(farm_folder("refused"));
  shot.output = "/srv/two\nlines";
  EXPECT_THROW(template_of(shot, some_jobs()), Error);
  shot.output = "/srv/" + std::string(1100, 'x');
  EXPECT_THROW(template_of(shot, some_jobs()), Error);
  shot.output = "/srv/\xFF";
  EXPECT_THROW(template_of(shot, some_jobs()), Error);
}

}  // namespace
}  // namespace softreel
