#include "tool/report/version.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <fmt/format.h>
#include <toml++/impl/version.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/base/library_version.h"
#include "core/base/parallel.h"
#include "render/image/image_library_versions.h"
#include "tool/cache/json_text.h"
#include "tool/cache/process.h"
#include "tool/shot/preset_library.h"

namespace softreel {
namespace {

namespace fs = std::filesystem;

std::string three_numbers(int major, int minor, int patch) {
  return fmt::format("{}.{}.{}", major, minor, patch);
}

/// 10203 stands for 1.2.3.
std::string unpacked(unsigned number) {
  return fmt::format("{}.{}.{}", number / 10000, number / 100 % 100, number % 100);
}

std::vector<LibraryVersion> libraries() {
  std::vector<LibraryVersion> all{
      {"Eigen", three_numbers(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION), false},
      {"fmt", unpacked(FMT_VERSION), false},
      {"CLI11", CLI11_VERSION, false},
      {"nlohmann-json",
       three_numbers(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH), false},
      {"toml++", three_numbers(TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH), false},
      {"xxHash", unpacked(XXH_versionNumber()), true},
      {"oneTBB", thread_library_version(), true}};
  for (const ImageLibraryVersion& one : image_library_versions())
    all.push_back({one.name, one.version, one.at_run_time});
  return all;
}

/// A part that is a module beside the program (core/base/part.h); it is looked for and not loaded.
PartVersion module_part(const char* name, const char* purpose, bool is_built_in, const char* version) {
  PartVersion part{name, purpose, is_built_in ? version : "", "", is_built_in, is_built_in};
#if SOFTREEL_LAZY_PARTS
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  const fs::path file =
      (program.parent_path() / "../lib/softreel" / fmt::format("softreel_part_{}.so", name)).lexically_normal();
  part.is_found = is_built_in && !failed && fs::exists(file, failed);
  if (part.is_found) part.file = file.string();
#endif
  return part;
}

/// The first line that ffmpeg says of itself.
PartVersion find_ffmpeg() {
  PartVersion part{"ffmpeg", "movies", "", "", false, false};
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder.empty() ? "." : folder) / "ffmpeg";
    if (access(file.c_str(), X_OK) != 0) continue;
    part.file = file.string();
    break;
  }
  std::string said;
  if (part.file.empty() || run_process({part.file, "-version"}, &said) != 0) return part;
  part.is_found = true;
  constexpr std::string_view kBefore = "ffmpeg version ";
  if (said.starts_with(kBefore))
    part.version = said.substr(kBefore.size(), said.find(' ', kBefore.size()) - kBefore.size());
  return part;
}

std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name"))
      if (const std::size_t colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
  return "unknown";
}

/// The set that all sources are compiled for (tool/cmake/warnings.cmake): the same code runs on every machine, so that
/// the bits are the same.
constexpr const char* kInstructionSet =
#if defined(__AVX512F__)
    "x86-64-v4";
#elif defined(__AVX2__) && defined(__FMA__) && defined(__BMI2__)
    "x86-64-v3";
#else
    "baseline of the compiler";
#endif

#ifdef __clang__
constexpr const char* kCompiler = __VERSION__;  // says whose it is
#else
constexpr const char* kCompiler = "g++ " __VERSION__;
#endif

const char* yes_or_no(bool value) {
  return value ? "yes" : "no";
}

}  // namespace

std::string version_text() {
  return fmt::format("softreel {} ({}, Eigen {}.{}.{})", SOFTREEL_VERSION, kCompiler, EIGEN_WORLD_VERSION,
                     EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
}

std::string short_version() {
  return fmt::format("softreel {}", SOFTREEL_VERSION);
}

VersionFacts version_facts() {
  VersionFacts facts;
  facts.version = SOFTREEL_VERSION;
  facts.compiler = kCompiler;
  facts.libraries = libraries();
  facts.parts = {
      module_part("embree", "path tracing", SOFTREEL_BUILT_EMBREE, SOFTREEL_EMBREE_VERSION),
      module_part("egl", "preview", SOFTREEL_BUILT_EGL, ""),
      module_part("assimp", "mesh files other than OBJ, PLY, OFF, STL", SOFTREEL_BUILT_ASSIMP, SOFTREEL_ASSIMP_VERSION),
      module_part("openvdb", "export of level sets", SOFTREEL_BUILT_OPENVDB, ""), find_ffmpeg()};
  facts.instruction_set = kInstructionSet;
  facts.has_avx512 = __builtin_cpu_supports("avx512f") != 0;
  facts.processor = processor_name();
  facts.threads = Threads(0).count();
  facts.presets = preset_folder();
  return facts;
}

std::string to_text(const VersionFacts& facts) {
  std::string text =
      fmt::format("softreel {}\n  built by {}, for {}\n", facts.version, facts.compiler, facts.instruction_set);
  text += fmt::format("  processor: {}; AVX-512: {} (used by Embree only)\n  threads: {}\n", facts.processor,
                      yes_or_no(facts.has_avx512), facts.threads);
  text += "  libraries:";
  for (const LibraryVersion& one : facts.libraries)
    text += fmt::format(" {} {}{}", one.name, one.version, &one == &facts.libraries.back() ? "\n" : ",");
  text += "  parts, loaded when first used:\n";
  for (const PartVersion& part : facts.parts) {
    const bool is_program = part.name == "ffmpeg";
    const char* state = part.is_found      ? "found"
                        : is_program       ? "not found"
                        : part.is_built_in ? "MISSING"
                                           : "not built in";
    text += fmt::format("    {:<7} {}{}{}; for {}\n", part.name, part.version.empty() ? "" : part.version + " ", state,
                        part.file.empty() ? "" : " at " + part.file, part.purpose);
  }
  return text + fmt::format("  presets: {}", facts.presets.empty() ? "not found" : facts.presets);
}

std::string to_json(const VersionFacts& facts) {
  nlohmann::ordered_json json = {
      {"softreel", facts.version},    {"compiler", facts.compiler}, {"instruction_set", facts.instruction_set},
      {"processor", facts.processor}, {"avx512", facts.has_avx512}, {"threads", facts.threads},
      {"presets", facts.presets}};
  for (const LibraryVersion& one : facts.libraries)
    json["libraries"][one.name] = {{"version", one.version}, {"at_run_time", one.at_run_time}};
  for (const PartVersion& part : facts.parts)
    json["parts"][part.name] = {{"purpose", part.purpose},
                                {"version", part.version},
                                {"built_in", part.is_built_in},
                                {"found", part.is_found},
                                {"file", part.file}};
  return json_text(json);
}

}  // namespace softreel
