#include "tool/cache/cache_use.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tool/cache/atomic_file.h"
#include "tool/cache/picture_record.h"

namespace softreel {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kRunning = ".running";

fs::path uses_folder(const Cache& cache) {
  return fs::path(cache.format_folder()) / "uses";
}

/// Held exclusively while files are removed, shared while a claim is made: no claim is overlooked.
std::string removal_lock(const Cache& cache) {
  return (fs::path(cache.format_folder()) / "lock").string();
}

fs::path real(const std::string& path) {
  std::error_code none;
  const fs::path canonical = fs::weakly_canonical(path, none);
  return none ? fs::path(path) : canonical;
}

struct Use {
  fs::path file;
  std::string owner, shot_path, host;
  std::set<CacheItem> items, released;
  bool running = false;
};

/// A file of uses/: the owner, the shot's path, the host, then +ITEM and -ITEM lines.
Use read_use(const fs::path& file) {
  Use use;
  use.file = file;
  std::ifstream in(file);
  std::getline(in, use.owner);
  std::getline(in, use.shot_path);
  std::getline(in, use.host);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('+')) use.items.insert(line.substr(1));
    if (line.starts_with('-')) use.released.insert(line.substr(1));
  }
  // Whatever keeps the lock from being taken, the run may still be going. Some file systems lock only what may be
  // written; what may not be is locked where that will do.
  int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  use.running = descriptor < 0 || ::flock(descriptor, LOCK_EX | LOCK_NB) != 0;
  if (descriptor >= 0) ::close(descriptor);
  return use;
}

/// A shot that was here and is here no more; one that another machine sees, or that lies on a disk which is not
/// mounted, is not gone.
bool is_gone(const Use& use) {
  std::error_code none;
  return use.host == host_name() && fs::is_directory(fs::path(use.shot_path).parent_path(), none) &&
         !fs::exists(use.shot_path, none);
}

std::vector<Use> read_uses(const Cache& cache) {
  std::vector<Use> uses;
  std::error_code none;
  for (fs::directory_iterator entry(uses_folder(cache), none), end; !none && entry != end; entry.increment(none))
    uses.push_back(read_use(entry->path()));
  return uses;
}

struct CachedFile {
  fs::path path;
  CacheItem item;
  double bytes = 0;  ///< that its removal frees
  fs::file_time_type used;
};

/// All results and finished files; not what the cache knows about itself.
std::vector<CachedFile> list_files(const Cache& cache) {
  std::vector<CachedFile> files;
  std::error_code none;
  for (fs::recursive_directory_iterator entry(cache.format_folder(), none), end; !none && entry != end;
       entry.increment(none)) {
    if (!entry->is_regular_file(none)) continue;
    const std::string stage = entry->path().parent_path().filename().string();
    if (entry.depth() != 1 || stage == "uses" || stage == "locks") continue;
    if (is_temporary_name(entry->path().filename().string())) continue;  // see remove_remains
    CachedFile file{entry->path(), cache_item(stage, entry->path().filename().string()), 0, {}};
    struct stat facts {};
    if (::stat(file.path.c_str(), &facts) != 0) continue;
    file.bytes = facts.st_nlink > 1 ? 0.0 : static_cast<double>(facts.st_size);
    file.used = entry->last_write_time(none);
    files.push_back(std::move(file));
  }
  return files;
}

/// The finished files that picture records point to are needed with them.
void add_pointed_files(const Cache& cache, std::set<CacheItem>& items) {
  std::set<CacheItem> files;
  for (const CacheItem& item : items) {
    if (!item.starts_with(kPictureStage)) continue;
    const auto record = load_picture_record(cache, item.substr(std::string_view(kPictureStage).size() + 1));
    if (record) files.insert(cache_item("files", record->checksum));
  }
  items.merge(files);
}

std::set<CacheItem> claimed_items(const Cache& cache, const std::vector<Use>& uses) {
  std::set<CacheItem> claimed;
  for (const Use& use : uses)
    if (use.running)
      std::set_difference(use.items.begin(), use.items.end(), use.released.begin(), use.released.end(),
                          std::inserter(claimed, claimed.end()));
  add_pointed_files(cache, claimed);
  return claimed;
}

/// bytes: that it frees.
void remove_file(const fs::path& path, double bytes, bool dry_run, CacheRemoval& removal) {
  std::error_code failed;
  if (!dry_run) fs::remove(path, failed);
  if (failed) {
    if (removal.problem.empty())
      removal.problem = fmt::format("{}: cannot be removed: {}", path.string(), failed.message());
    return;
  }
  removal.files += 1;
  removal.bytes += bytes;
}

/// Results of older formats: format 1 kept them directly in the cache folder; later ones have a folder named by their
/// number. Nothing but files of ours is touched: the folder may be anybody's.
void remove_older_formats(const Cache& cache, bool dry_run, CacheRemoval& removal) {
  for (const fs::path& file : older_results(cache.folder())) {
    std::error_code none;
    const auto size = fs::file_size(file, none);
    remove_file(file, none ? 0.0 : static_cast<double>(size), dry_run, removal);
    if (dry_run) continue;
    fs::remove(file.parent_path(), none);  // goes if it is empty
    if (file.parent_path().parent_path() != fs::path(cache.folder()))
      fs::remove(file.parent_path().parent_path(), none);
  }
}

/// Locks that nobody holds: their holders were killed.
void remove_dead_locks(const Cache& cache) {
  const fs::path locks = fs::path(cache.format_folder()) / "locks";
  std::error_code none;
  for (fs::directory_iterator entry(locks, none), end; !none && entry != end; entry.increment(none))
    if (auto lock = FileLock::try_take(entry->path().string()))
      const FileLock removed = std::move(*lock).remove_at_end(entry->path().string());
}

/// What killed processes left: unfinished files, and locks that nobody holds.
void remove_remains(const Cache& cache, bool dry_run, CacheRemoval& removal) {
  std::error_code none;
  for (fs::directory_iterator entry(cache.format_folder(), none), end; !none && entry != end; entry.increment(none)) {
    if (!entry->is_directory(none)) continue;
    const Swept swept = sweep_temporaries(entry->path().string(), dry_run);
    removal.files += swept.files;
    removal.bytes += swept.bytes;
  }
  if (!dry_run) remove_dead_locks(cache);
}

CacheRemoval remove_all_but(const Cache& cache, const std::set<CacheItem>& kept, bool dry_run) {
  CacheRemoval removal;
  for (const CachedFile& file : list_files(cache))
    if (kept.count(file.item) == 0) remove_file(file.path, file.bytes, dry_run, removal);
  remove_older_formats(cache, dry_run, removal);
  remove_remains(cache, dry_run, removal);
  return removal;
}

}  // namespace

std::string CacheUse::owner_id(const std::string& shot_path, const std::string& output_folder) {
  return KeyHasher("owner").add(real(shot_path).string()).add(real(output_folder).string()).key();
}

CacheUse::CacheUse(const Cache& cache, const std::string& shot_path, const std::string& output_folder)
    : cache_(cache), owner_(owner_id(shot_path, output_folder)) {
  const FileLock no_removal = FileLock::take(removal_lock(cache), FileLock::Sharing::Shared);
  std::error_code none;
  fs::create_directories(uses_folder(cache), none);
  // Containers may have one host name, and each the same numbers of processes.
  for (int k = 0; descriptor_ < 0; ++k) {
    path_ = (uses_folder(cache) / fmt::format("{}.{}.{}.{}{}", owner_, host_name(), ::getpid(), k, kRunning)).string();
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST)
      return;  // a cache that cannot be written: nobody can remove anything either
  }
  ::flock(descriptor_, LOCK_EX);
  remove_at_sudden_end(path_);
  append(fmt::format("{}\n{}\n{}\n", owner_, real(shot_path).string(), host_name()));
}

void CacheUse::append(const std::string& lines) {
  // A list that is cut short on a full disk protects less; results stay right.
  for (std::size_t at = 0; descriptor_ >= 0 && at < lines.size();) {
    const ssize_t written = ::write(descriptor_, lines.data() + at, lines.size() - at);
    if (written <= 0) return;
    at += static_cast<std::size_t>(written);
  }
}

void CacheUse::claim(const std::vector<CacheItem>& items) {
  const FileLock no_removal = FileLock::take(removal_lock(cache_), FileLock::Sharing::Shared);
  std::string lines;
  for (const CacheItem& item : items) lines += "+" + item + "\n";
  append(lines);
}

void CacheUse::release(const CacheItem& item) {
  append("-" + item + "\n");
}

CacheUse::~CacheUse() {
  if (descriptor_ < 0) return;
  const FileLock nobody_starts = FileLock::take(removal_lock(cache_));
  std::error_code none;
  remove_dead_locks(cache_);
  for (const Use& use : read_uses(cache_))  // of earlier runs of the same shot that were killed
    if (use.owner == owner_ && !use.running && use.file.string().ends_with(kRunning)) fs::remove(use.file, none);
  keep_at_sudden_end(path_);
  fs::rename(path_, uses_folder(cache_) / owner_, none);
  ::close(descriptor_);
}

double cache_size(const Cache& cache) {
  double bytes = 0;
  for (const CachedFile& file : list_files(cache)) bytes += file.bytes;
  return bytes;
}

CacheRemoval cut_cache(const Cache& cache, double limit, bool dry_run) {
  CacheRemoval removal;
  if (!fs::exists(cache.format_folder())) return removal;
  const FileLock lock = FileLock::take(removal_lock(cache));
  std::vector<CachedFile> files = list_files(cache);
  double bytes = 0;
  for (const CachedFile& file : files) bytes += file.bytes;
  if (bytes <= limit) return removal;
  const std::set<CacheItem> claimed = claimed_items(cache, read_uses(cache));
  std::sort(files.begin(), files.end(), [](const CachedFile& a, const CachedFile& b) {
    return std::pair(a.used, a.item) < std::pair(b.used, b.item);
  });
  for (const CachedFile& file : files) {
    if (bytes - removal.bytes <= limit) break;
    if (file.bytes > 0 && claimed.count(file.item) == 0) remove_file(file.path, file.bytes, dry_run, removal);
  }
  return removal;
}

CacheRemoval clean_cache(const Cache& cache, const std::string& owner_id, const std::vector<CacheItem>& kept,
                         bool dry_run) {
  if (!fs::exists(cache.folder())) return {};
  const FileLock lock = FileLock::take(removal_lock(cache));
  const std::vector<Use> uses = read_uses(cache);
  std::set<CacheItem> needed(kept.begin(), kept.end());
  for (const Use& use : uses) {
    if (use.running) continue;
    std::error_code none;
    const bool remembered = use.owner != owner_id && !is_gone(use);
    if (remembered) needed.insert(use.items.begin(), use.items.end());
    if (!remembered && !dry_run) fs::remove(use.file, none);
  }
  add_pointed_files(cache, needed);
  needed.merge(claimed_items(cache, uses));
  return remove_all_but(cache, needed, dry_run);
}

CacheRemoval empty_cache(const Cache& cache, bool dry_run) {
  if (!fs::exists(cache.folder())) return {};
  const FileLock lock = FileLock::take(removal_lock(cache));
  return remove_all_but(cache, claimed_items(cache, read_uses(cache)), dry_run);
}

}  // namespace softreel
