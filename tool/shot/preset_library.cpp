#include "tool/shot/preset_library.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.h"
#include "core/base/nearest_name.h"

namespace softreel {
namespace {

namespace fs = std::filesystem;

bool is_library(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "materials", ignored);
}

/// Names of the TOML files directly in a folder.
std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& file : fs::directory_iterator(folder, ignored))
    if (file.path().extension() == ".toml") names.push_back(file.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// others: what else the option takes.
std::string file_of(const char* option, const std::string& name, const fs::path& folder, const char* others = "") {
  const std::vector<std::string> names = names_in(folder);
  if (std::find(names.begin(), names.end(), name) != names.end()) return (folder / (name + ".toml")).string();
  const std::string nearest = nearest_name(name, names);
  throw input_error(fmt::format("{} {}: the library in {} has none of this name.\n  Accepted: {}{}.{}", option, name,
                                folder.string(), fmt::join(names, ", "), others,
                                nearest.empty() ? "" : fmt::format(" Did you mean {}?", nearest)));
}

std::string library_or_throw(const char* option, const std::string& name) {
  std::string folder = preset_folder();
  if (folder.empty())
    throw input_error(
        fmt::format("{} {}: the library of presets is not beside this program.\n  Accepted: the folder presets of "
                    "softreel. Name it in the environment variable SOFTREEL_PRESETS.",
                    option, name));
  return folder;
}

}  // namespace

std::string preset_folder() {
  if (const char* named = std::getenv("SOFTREEL_PRESETS"); named != nullptr && *named != '\0') {
    if (is_library(named)) return named;
    throw input_error(
        fmt::format("SOFTREEL_PRESETS={}: this folder holds no materials.\n  Accepted: the folder presets of softreel. "
                    "Correct the variable, or unset it.",
                    named));
  }
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed).parent_path();
  if (failed) return {};
  for (const char* place : {"../share/softreel/presets", "../../presets"})
    if (is_library(program / place)) return (program / place).lexically_normal().string();
  return {};
}

std::vector<std::string> library_materials() {
  const std::string folder = preset_folder();
  return folder.empty() ? std::vector<std::string>() : names_in(fs::path(folder) / "materials");
}

std::vector<std::string> library_presets() {
  const std::string folder = preset_folder();
  return folder.empty() ? std::vector<std::string>() : names_in(folder);
}

std::string material_file(const std::string& name) {
  return file_of("--material", name, fs::path(library_or_throw("--material", name)) / "materials");
}

std::string quality_file(const std::string& name) {
  constexpr const char* kOthers = ", or the path of a file of fields that ends in .toml";
  std::error_code ignored;
  if (name.ends_with(".toml") && fs::exists(name, ignored)) return name;
  return file_of("--quality", name, fs::path(library_or_throw("--quality", name)) / "quality", kOthers);
}

std::string preset_file(const std::string& name) {
  std::error_code ignored;
  if (name.ends_with(".toml") && fs::is_regular_file(name, ignored)) return name;
  return file_of("--like", fs::path(name).stem().string(), library_or_throw("--like", name));
}

}  // namespace softreel
