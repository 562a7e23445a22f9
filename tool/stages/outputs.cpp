#include "tool/stages/outputs.h"

#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/check.h"
#include "core/base/error.h"
#include "tool/stages/atomic_file.h"

namespace softreel {
namespace fs = std::filesystem;

Outputs::Outputs(std::string folder, std::string shot_name, const Log& log)
    : folder_(std::move(folder)), shot_name_(std::move(shot_name)), log_(log) {
  if (!fs::exists(manifest_path())) return;
  try {
    const auto bytes = read_file(manifest_path());
    const auto json = nlohmann::json::parse(bytes.begin(), bytes.end());
    for (const auto& [name, entry] : json.at("files").items())
      entries_[name] = {entry.at("key").get<std::string>(), entry.at("checksum").get<std::string>()};
  } catch (const std::exception& problem) {
    entries_.clear();
    log_.warn(fmt::format("{}: damaged ({}); its files are made again.", manifest_path(), problem.what()));
  }
}

std::string Outputs::manifest_path() const {
  return (fs::path(folder_) / (shot_name_ + ".manifest.json")).string();
}

std::string Outputs::frame_path(int frame, const std::string& extension) const {
  return (fs::path(folder_) / fmt::format("{}.{:04}.{}", shot_name_, frame, extension)).string();
}

std::string Outputs::path(const std::string& extension) const {
  return (fs::path(folder_) / fmt::format("{}.{}", shot_name_, extension)).string();
}

bool Outputs::is_done(const std::string& path, const StageKey& key) const {
  const auto entry = entries_.find(fs::path(path).filename().string());
  if (entry == entries_.end() || entry->second.key != key || !fs::is_regular_file(path)) return false;
  if (hash_bytes(read_file(path)) == entry->second.checksum) return true;
  log_.warn(fmt::format("{}: damaged or changed since it was made; it is made again.", path));
  return false;
}

std::optional<std::vector<std::uint8_t>> Outputs::find_equal(const StageKey& key) const {
  for (const auto& [name, entry] : entries_) {
    const std::string path = (fs::path(folder_) / name).string();
    if (entry.key == key && is_done(path, key)) return read_file(path);
  }
  return std::nullopt;
}

void Outputs::write(const std::string& path, const StageKey& key, std::span<const std::uint8_t> bytes) {
  write_file(path, bytes);
  entries_[fs::path(path).filename().string()] = {key, hash_bytes(bytes)};
  write_manifest();
}

void Outputs::enter(const std::string& path, const StageKey& key) {
  entries_[fs::path(path).filename().string()] = {key, hash_bytes(read_file(path))};
  write_manifest();
}

std::string Outputs::checksum(const std::string& path) const {
  const auto entry = entries_.find(fs::path(path).filename().string());
  CHECK(entry != entries_.end());
  return entry->second.checksum;
}

void Outputs::write_manifest() const {
  nlohmann::json files = nlohmann::json::object();
  for (const auto& [name, entry] : entries_) files[name] = {{"key", entry.key}, {"checksum", entry.checksum}};
  const nlohmann::json manifest = {{"format", 1}, {"shot", shot_name_}, {"files", files}};
  write_file(manifest_path(), manifest.dump(1) + "\n");
}

}  // namespace softreel
