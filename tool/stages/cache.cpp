#include "tool/stages/cache.h"

#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/stages/atomic_file.h"

namespace softreel {
namespace {

/// A file is this line, the checksum of the payload in 32 digits, a line feed, and the payload.
constexpr std::string_view kMagic = "softreel cache 1\n";
constexpr std::size_t kHeaderSize = kMagic.size() + 33;

/// Why the bytes are not a sound cache file; empty if they are.
std::string damage(const std::vector<std::uint8_t>& file) {
  if (file.size() < kHeaderSize) return "it is cut short";
  if (std::memcmp(file.data(), kMagic.data(), kMagic.size()) != 0) return "it has another format";
  const std::string stored(file.begin() + static_cast<std::ptrdiff_t>(kMagic.size()),
                           file.begin() + static_cast<std::ptrdiff_t>(kHeaderSize - 1));
  if (stored != hash_bytes(std::span(file).subspan(kHeaderSize))) return "its checksum does not fit";
  return {};
}

}  // namespace

std::string Cache::path(const std::string& stage, const StageKey& key) const {
  return (std::filesystem::path(folder_) / stage / key).string();
}

bool Cache::has(const std::string& stage, const StageKey& key) const {
  return std::filesystem::is_regular_file(path(stage, key));
}

std::optional<std::vector<std::uint8_t>> Cache::load(const std::string& stage, const StageKey& key) const {
  if (!has(stage, key)) return std::nullopt;
  std::vector<std::uint8_t> file;
  std::string reason;
  try {
    file = read_file(path(stage, key));
    reason = damage(file);
  } catch (const Error& error) {
    reason = error.what();
  }
  if (reason.empty()) {
    file.erase(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(kHeaderSize));
    return file;
  }
  log_.warn(fmt::format("{}: damaged cache file ({}); it is computed again.", path(stage, key), reason));
  return std::nullopt;
}

void Cache::store(const std::string& stage, const StageKey& key, const std::vector<std::uint8_t>& bytes) const {
  const std::string header = fmt::format("{}{}\n", kMagic, hash_bytes(bytes));
  AtomicFile file(path(stage, key));
  file.write(std::span(reinterpret_cast<const std::uint8_t*>(header.data()), header.size()));
  file.write(bytes);
  file.commit();
}

}  // namespace softreel
