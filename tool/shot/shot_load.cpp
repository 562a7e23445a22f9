#include "tool/shot/shot_load.h"

#include <filesystem>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/shot/schema_tables.h"
#include "tool/shot/shot_layers.h"

namespace softreel {
namespace {

/// More than this says nothing new.
constexpr std::size_t kShownProblems = 20;

std::string first_problems(const std::vector<std::string>& problems) {
  std::string out;
  for (std::size_t i = 0; i < problems.size() && i < kShownProblems; ++i) out += (i == 0 ? "" : "\n") + problems[i];
  if (problems.size() > kShownProblems)
    out += fmt::format("\n{} more problems are not shown.", problems.size() - kShownProblems);
  return out;
}

}  // namespace

Shot load_shot(const std::string& path, const std::vector<Override>& overrides) {
  return parse_shot(path, load_layers(path, overrides));
}

Shot parse_shot(const std::string& path, const TomlValue& document) {
  Shot shot;
  shot.path = path;
  shot.settings.name = std::filesystem::path(path).stem().string();
  std::vector<std::string> problems;
  try {
    read_table(shot_table(), {"", nullptr, &problems}, document, shot);
  } catch (const Error& error) {
    problems.emplace_back(error.what());
  }
  if (!problems.empty()) throw input_error(first_problems(problems));
  return shot;
}

}  // namespace softreel
