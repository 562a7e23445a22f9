#include "tool/cache/cache.h"

#include <charconv>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include "core/base/error.h"
#include "core/base/timer.h"
#include "tool/cache/atomic_file.h"

namespace softreel {
namespace fs = std::filesystem;
namespace {

/// A file is a header of fixed length and the payload. The header: "softreel cache 2 CHECKSUM SECONDS\n", the checksum
/// (of payload, seconds, and where the file belongs, so that one is no other) in 32 digits, the seconds in 12
/// characters.
constexpr std::string_view kMagic = "softreel cache 2 ";
constexpr std::size_t kChecksumSize = 32, kSecondsSize = 12;
constexpr std::size_t kHeaderSize = kMagic.size() + kChecksumSize + 1 + kSecondsSize + 1;

StageKey checksum_of(const std::string& place, std::string_view seconds, std::span<const std::uint8_t> payload) {
  return KeyHasher("cache file").add(place).add(seconds).add(hash_bytes(payload)).key();
}

/// place: "STAGE/KEY"
std::string header_of(const std::string& place, const Bytes& payload, double seconds) {
  const std::string text = fmt::format("{:>12.6g}", seconds);
  return fmt::format("{}{} {}\n", kMagic, checksum_of(place, text, payload), text);
}

std::string_view seconds_text(std::string_view header) {
  return header.substr(kHeaderSize - 1 - kSecondsSize, kSecondsSize);
}

/// Why the bytes are not a sound cache file; empty if they are.
std::string damage_of(const std::string& place, const Bytes& file) {
  if (file.size() < kHeaderSize) return "it is cut short";
  if (std::memcmp(file.data(), kMagic.data(), kMagic.size()) != 0) return "it has another format";
  const std::string_view header(reinterpret_cast<const char*>(file.data()), kHeaderSize);
  if (header.substr(kMagic.size(), kChecksumSize) !=
      checksum_of(place, seconds_text(header), std::span(file).subspan(kHeaderSize)))
    return "its checksum does not fit";
  return {};
}

double seconds_of(std::string_view header) {
  std::string_view text = seconds_text(header);
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  double seconds = 0;
  std::from_chars(text.data(), text.data() + text.size(), seconds);
  return seconds;
}

/// Results that were used last go last when the cache is cut to size.
void mark_used(const std::string& path) {
  ::utimensat(AT_FDCWD, path.c_str(), nullptr, 0);
}

/// A file that outputs link to keeps its date: it is theirs too. Removing it would free nothing anyway.
void mark_file_used(const std::string& path) {
  std::error_code none;
  if (fs::hard_link_count(path, none) <= 1) mark_used(path);
}

}  // namespace

Cache::Cache(std::string folder, Storing storing, const Log& log)
    : folder_(std::move(folder)), storing_(storing), log_(log) {
  say_older_formats();
}

std::string Cache::format_folder() const {
  return (fs::path(folder_) / std::to_string(kCacheFormat)).string();
}

void Cache::say_older_formats() const {
  std::error_code none;
  if (fs::exists(format_folder(), none) || older_results(folder_).empty()) return;
  log_.warn(
      fmt::format("{}: holds results of another format; this softreel reads format {}, so they are computed again. "
                  "softreel clean removes the old ones.",
                  folder_, kCacheFormat));
}

std::vector<fs::path> older_results(const std::string& folder) {
  std::vector<fs::path> folders{fs::path(folder) / "tetrahedra", fs::path(folder) / "simulation"};
  for (int format = 1; format < kCacheFormat; ++format)
    for (const char* stage : {"tetrahedra", "simulation", "picture"})
      folders.push_back(fs::path(folder) / std::to_string(format) / stage);
  std::vector<fs::path> files;
  for (const fs::path& stage : folders) {
    std::error_code none;
    for (fs::directory_iterator entry(stage, none), end; !none && entry != end; entry.increment(none)) {
      const std::string name = entry->path().filename().string();
      const bool is_key =
          name.size() == kChecksumSize && name.find_first_not_of("0123456789abcdef") == std::string::npos;
      std::string magic(std::string_view("softreel cache ").size(), '\0');
      if (is_key &&
          std::ifstream(entry->path(), std::ios::binary)
              .read(magic.data(), static_cast<std::streamsize>(magic.size())) &&
          magic == "softreel cache ")
        files.push_back(entry->path());
    }
  }
  return files;
}

std::string Cache::path(const std::string& stage, const StageKey& key) const {
  return (fs::path(format_folder()) / stage / key).string();
}

std::string Cache::file_path(const StageKey& checksum) const {
  return (fs::path(format_folder()) / "files" / checksum).string();
}

bool Cache::has(const std::string& stage, const StageKey& key) const {
  std::error_code none;
  return fs::is_regular_file(path(stage, key), none);
}

std::optional<double> Cache::seconds(const std::string& stage, const StageKey& key) const {
  std::ifstream in(path(stage, key), std::ios::binary);
  std::string header(kHeaderSize, '\0');
  if (!in.read(header.data(), kHeaderSize) || !header.starts_with(kMagic)) return std::nullopt;
  return seconds_of(header);
}

std::string Cache::damage(const std::string& stage, const StageKey& key) const {
  std::error_code none;
  if (!fs::exists(path(stage, key), none)) return {};
  try {
    return damage_of(stage + "/" + key, read_file(path(stage, key)));
  } catch (const Error& error) {
    return error.what();
  }
}

void Cache::say_damage(const std::string& path, const std::string& reason) const {
  const std::lock_guard lock(said_mutex_);
  if (said_.insert(path).second)
    log_.warn(fmt::format("{}: damaged cache file ({}); it is computed again.", path, reason));
}

std::optional<Cache::Stored> Cache::load(const std::string& stage, const StageKey& key) const {
  const std::string file_path = path(stage, key);
  std::error_code none;
  if (!fs::exists(file_path, none)) return std::nullopt;
  Bytes file;
  std::string reason;
  try {
    file = read_file(file_path);
    reason = damage_of(stage + "/" + key, file);
  } catch (const Error& error) {
    // Another process may have removed it meanwhile.
    if (!fs::exists(file_path, none)) return std::nullopt;
    reason = error.what();
  }
  if (!reason.empty()) {
    say_damage(file_path, reason);
    return std::nullopt;
  }
  mark_used(file_path);
  Stored stored;
  stored.seconds = seconds_of({reinterpret_cast<const char*>(file.data()), kHeaderSize});
  file.erase(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(kHeaderSize));
  stored.bytes = std::move(file);
  return stored;
}

void Cache::store_or_say(const std::function<void()>& work) const {
  if (storing_ == Storing::Required) return work();
  if (unwritable_) return;
  try {
    work();
  } catch (const Error& error) {
    if (!unwritable_.exchange(true))
      log_.warn(fmt::format("The cache cannot be written, so the next run will have to compute again: {}",
                            std::string(error.what())));
  }
}

void Cache::store(const std::string& stage, const StageKey& key, const Bytes& bytes, double seconds) const {
  store_or_say([&] {
    const std::string header = header_of(stage + "/" + key, bytes, seconds);
    std::error_code none;
    if (fs::is_directory(path(stage, key), none)) fs::remove_all(path(stage, key), none);  // it stands in the way
    AtomicFile file(path(stage, key));
    file.write(std::span(reinterpret_cast<const std::uint8_t*>(header.data()), header.size()));
    file.write(bytes);
    file.commit(AtomicFile::Flush::Later);
    stored_bytes_ += static_cast<std::int64_t>(bytes.size());
  });
}

std::optional<FileLock> Cache::try_claim(const std::string& stage, const StageKey& key) const {
  const std::string lock_path = (fs::path(format_folder()) / "locks" / (stage + "." + key)).string();
  std::optional<FileLock> lock = FileLock::try_take(lock_path);
  if (lock) lock = std::move(*lock).remove_at_end(lock_path);
  return lock;
}

Cache::Produced Cache::produce(const std::string& stage, const StageKey& key, const std::function<void()>& wait,
                               const std::function<Bytes()>& make) const {
  const auto stored_result = [&]() -> std::optional<Produced> {
    std::optional<Stored> stored = load(stage, key);
    if (!stored) return std::nullopt;
    return Produced{std::move(stored->bytes), true, stored->seconds};
  };
  if (auto result = stored_result()) return std::move(*result);
  std::optional<FileLock> claim;
  while (!(claim = try_claim(stage, key))) {
    wait();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (has(stage, key))  // made by the other process meanwhile
    if (auto result = stored_result()) return std::move(*result);
  const auto start = std::chrono::steady_clock::now();
  Produced result;
  result.bytes = make();
  result.seconds = seconds_since(start);
  store(stage, key, result.bytes, result.seconds);
  return result;
}

Cache::StoredFile Cache::store_file(const Bytes& bytes) const {
  StoredFile stored{hash_bytes(bytes), false};
  store_or_say([&] {
    const std::string target = file_path(stored.checksum);
    std::error_code none;
    if (fs::is_regular_file(target, none) && fs::file_size(target, none) == bytes.size() &&
        hash_bytes(read_file(target)) == stored.checksum) {
      mark_file_used(target);
    } else {
      if (fs::is_directory(target, none)) fs::remove_all(target, none);  // it stands in the way
      write_file(target, bytes);
      stored_bytes_ += static_cast<std::int64_t>(bytes.size());
    }
    stored.is_there = true;
  });
  return stored;
}

std::optional<Bytes> Cache::load_file(const StageKey& checksum) const {
  const std::string source = file_path(checksum);
  std::error_code none;
  if (!fs::is_regular_file(source, none)) return std::nullopt;
  try {
    Bytes bytes = read_file(source);
    if (hash_bytes(bytes) == checksum) {
      mark_file_used(source);
      return bytes;
    }
    say_damage(source, "its checksum does not fit");
  } catch (const Error& error) {
    if (fs::exists(source, none)) say_damage(source, error.what());
  }
  return std::nullopt;
}

}  // namespace softreel
