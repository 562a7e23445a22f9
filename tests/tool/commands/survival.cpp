#include "tests/tool/commands/survival.h"

#include <algorithm>
#include <regex>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace softreel::testing {
namespace {

/// Dot-files and everything in dot-folders.
bool is_hidden(const std::string& name) {
  return name.starts_with('.') || name.find("/.") != std::string::npos;
}

/// A file's bytes; of a manifest, what it says of the files' content: times and settings aside.
std::string content(const std::string& path) {
  if (!path.ends_with(".manifest.json")) return read_text(path);
  const auto manifest = nlohmann::json::parse(read_text(path));
  std::string text;
  for (const auto& [name, entry] : manifest["files"].items())
    text += fmt::format("{} {} {}\n", name, entry["key"].get<std::string>(), entry["checksum"].get<std::string>());
  return text;
}

}  // namespace

nlohmann::json render_in_peace(const std::string& folder, const std::string& output, const std::string& options,
                               const std::string& command) {
  const Outcome outcome =
      run_abused(fmt::format("{} {}/shot.toml --output {} --quiet --json {}", command, folder, output, options), {});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.status == 0 ? nlohmann::json::parse(outcome.out) : nlohmann::json();
}

std::vector<std::string> final_files(const std::string& folder) {
  std::vector<std::string> names = exists(folder) ? files_under(folder) : std::vector<std::string>();
  std::erase_if(names, [](const std::string& name) {
    return is_hidden(name) || name.ends_with(".report.json") || name.ends_with(".resolved.toml");
  });
  return names;
}

void expect_equal_final_files(const std::string& a, const std::string& b) {
  const auto names = final_files(a);
  ASSERT_FALSE(names.empty()) << a;
  ASSERT_EQ(names, final_files(b)) << a << " against " << b;
  for (const std::string& name : names)
    EXPECT_TRUE(content(a + "/" + name) == content(b + "/" + name)) << a << " against " << b << ": " << name;
}

std::set<std::string> name_forms(const std::string& folder) {
  static const std::regex kDigits("[0-9a-f]+");
  std::set<std::string> forms;
  for (const std::string& name : files_under(folder)) forms.insert(std::regex_replace(name, kDigits, "#"));
  return forms;
}

std::map<std::string, std::string> pictures_in(const std::string& folder) {
  std::map<std::string, std::string> pictures;
  for (const std::string& name : final_files(folder))
    if (name.ends_with(".png")) pictures[name] = read_text(folder + "/" + name);
  return pictures;
}

}  // namespace softreel::testing
