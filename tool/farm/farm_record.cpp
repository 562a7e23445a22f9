#include "tool/farm/farm_record.h"

#include <array>
#include <charconv>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "tool/cache/json_text.h"

namespace softreel {
namespace {

using nlohmann::ordered_json;

constexpr int kFormat = 1;

ordered_json shot_json(const FarmShot& shot) {
  return {{"name", shot.name},           {"shot", shot.shot},       {"output", shot.output},
          {"cache", shot.cache},         {"records", shot.records}, {"token", shot.token},
          {"directory", shot.directory}, {"sets", shot.sets},       {"cache_limit_gb", shot.cache_limit_gb},
          {"program", shot.program},     {"version", shot.version}, {"checksum", shot.checksum}};
}

FarmShot read_shot(const ordered_json& json) {
  FarmShot shot;
  json.at("name").get_to(shot.name);
  json.at("shot").get_to(shot.shot);
  json.at("output").get_to(shot.output);
  json.at("cache").get_to(shot.cache);
  json.at("records").get_to(shot.records);
  json.at("token").get_to(shot.token);
  json.at("directory").get_to(shot.directory);
  json.at("sets").get_to(shot.sets);
  json.at("cache_limit_gb").get_to(shot.cache_limit_gb);
  json.at("program").get_to(shot.program);
  json.at("version").get_to(shot.version);
  json.at("checksum").get_to(shot.checksum);
  return shot;
}

ordered_json settings_json(const FarmSettings& settings) {
  return {{"name", settings.name},       {"chunk", settings.chunk},   {"cpus", settings.cpus},
          {"memory", settings.memory},   {"time", settings.time},     {"partition", settings.partition},
          {"account", settings.account}, {"sbatch", settings.sbatch}, {"constraint", settings.constraint},
          {"program", settings.program}};
}

FarmSettings read_settings(const ordered_json& json) {
  FarmSettings settings;
  json.at("name").get_to(settings.name);
  json.at("chunk").get_to(settings.chunk);
  json.at("cpus").get_to(settings.cpus);
  json.at("memory").get_to(settings.memory);
  json.at("time").get_to(settings.time);
  json.at("partition").get_to(settings.partition);
  json.at("account").get_to(settings.account);
  json.at("sbatch").get_to(settings.sbatch);
  json.at("constraint").get_to(settings.constraint);
  json.at("program").get_to(settings.program);
  return settings;
}

FarmStep read_step(const std::string& name) {
  for (const FarmStep step : {FarmStep::Simulate, FarmStep::Frames, FarmStep::Movie})
    if (name == step_name(step)) return step;
  throw input_error(fmt::format("\"{}\" is no step", name));
}

}  // namespace

std::string to_json(const FarmRecord& record) {
  ordered_json tasks = ordered_json::array();
  for (const SubmittedTask& task : record.tasks)
    tasks.push_back({{"step", step_name(task.step)},
                     {"frames", {task.frames.first, task.frames.last}},
                     {"job", task.job},
                     {"log", task.log}});
  const ordered_json json{{"format", kFormat},
                          {"engine", record.engine},
                          {"user", record.user},
                          {"shot", shot_json(record.shot)},
                          {"frames", {record.frames.first, record.frames.last}},
                          {"settings", settings_json(record.settings)},
                          {"tasks", tasks}};
  return record_text(json, 1, record.shot.shot, "the record of a submission");
}

FarmRecord parse_farm_record(const std::string& text, const std::string& path) {
  try {
    const ordered_json json = ordered_json::parse(text);
    if (json.at("format").get<int>() != kFormat) throw input_error("its format is another one");
    FarmRecord record;
    json.at("engine").get_to(record.engine);
    json.at("user").get_to(record.user);
    record.shot = read_shot(json.at("shot"));
    record.frames = {json.at("frames").at(0).get<int>(), json.at("frames").at(1).get<int>()};
    record.settings = read_settings(json.at("settings"));
    for (const ordered_json& task : json.at("tasks"))
      record.tasks.push_back({read_step(task.at("step").get<std::string>()),
                              {task.at("frames").at(0).get<int>(), task.at("frames").at(1).get<int>()},
                              task.at("job").get<std::string>(),
                              task.at("log").get<std::string>()});
    return record;
  } catch (const std::exception& problem) {
    throw input_error(fmt::format(
        "{}: cannot be read as the record of a submission: {}.\n  Remove the file and submit again: what is finished "
        "stays.",
        path, problem.what()));
  }
}

TaskRecord parse_task_record(const std::string& text) {
  std::array<std::string, 6> lines;
  std::size_t begin = 0;
  for (std::string& line : lines) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) return {};
    line = text.substr(begin, end - begin);
    begin = end + 1;
  }
  TaskRecord record{lines[0], lines[1], lines[3], lines[4], lines[5], 0};
  const std::string& status = lines[2];
  const auto [stop, code] = std::from_chars(status.data(), status.data() + status.size(), record.status);
  if (code != std::errc() || stop != status.data() + status.size()) return {};
  return record;
}

}  // namespace softreel
