/// Locks between processes that end with their holder, however it ends (flock(2)).
#pragma once

#include <optional>
#include <string>
#include <utility>

namespace softreel {

/// A lock on a file of its own. Released at destruction and when the process dies.
class FileLock {
 public:
  enum class Sharing { Shared, Exclusive };

  /// Takes the lock, or nothing if another holder is in the way. The file is made if need be; where it cannot be made
  /// (a read-only folder) nobody can write there either, and the lock is a formality that always succeeds.
  static std::optional<FileLock> try_take(const std::string& path, Sharing sharing = Sharing::Exclusive);
  /// Waits for the lock. For locks that are held for moments only.
  static FileLock take(const std::string& path, Sharing sharing = Sharing::Exclusive);
  FileLock(FileLock&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), removed_(std::exchange(other.removed_, {})) {}
  FileLock& operator=(FileLock&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(removed_, other.removed_);
    return *this;
  }
  ~FileLock();

  /// The file goes with the lock: for locks on one result each, which would pile up.
  FileLock&& remove_at_end(std::string path) &&;

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  /// The lock on a file that is open already; nothing if another holder is in the way. Takes over the descriptor.
  static std::optional<FileLock> try_adopt(int descriptor, Sharing sharing);

  int descriptor_;  ///< -1: a formality
  std::string removed_;
};

/// A file that means nothing once this process has ended goes with the locks' files; until it is told to stay.
void remove_at_sudden_end(const std::string& path);
void keep_at_sudden_end(const std::string& path);

/// Removes the files that go with their locks, for a process that is about to end without destroying them. None is
/// removed or taken away after this: whoever destroys such a lock waits for the end.
void remove_lock_files_at_once();

/// This machine's name, for files that tell whose they are.
std::string host_name();

}  // namespace softreel
