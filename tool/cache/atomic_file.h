/// Files that are there completely or not at all: written without a name, flushed, and linked to their name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace softreel {

/// A file under construction. It appears under its final name at `commit`; without one it leaves nothing behind, even
/// if the process is killed (O_TMPFILE; where the file system has none, a ".NAME.HOST.PID.N.part" stays after a kill
/// and sweep_temporaries removes it). All members throw work_error naming the file and what the system said (full
/// disk, read-only folder, ...).
class AtomicFile {
 public:
  enum class Writer {
    Ours,   ///< write()
    Others  ///< another program writes it, under the name temporary_path()
  };
  explicit AtomicFile(std::string path, Writer writer = Writer::Ours);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& temporary_path() const { return temporary_; }
  void write(std::span<const std::uint8_t> bytes);

  enum class Flush {
    ToDisk,  ///< survives a power cut: for files that others read
    Later    ///< survives the process: for files whose checksum is verified whenever they are read
  };
  /// To the disk, which takes its time: `commit(Flush::Later)` is then a matter of a moment.
  void flush();
  /// Flushes, and gives the file its name, in the place of one that is there.
  void commit(Flush when = Flush::ToDisk);

 private:
  [[noreturn]] void fail(const char* what) const;
  void give_name();

  std::string path_, temporary_;  ///< temporary_: empty while the file has no name at all
  int descriptor_ = -1;
};

/// Writes a whole file atomically; folders on the way are made. Throws work_error.
void write_file(const std::string& path, std::span<const std::uint8_t> bytes);
void write_file(const std::string& path, const std::string& text);

/// Adds a text at the end of a file, through to the disk, and returns how long the file is then. size: what is known of
/// it; 0: it is made, in the place of one that is there. What lies beyond, a piece of a line that could not be written,
/// is ended with "~" and a line break first, which make it a line of nothing even if only its end is missing. For one
/// writer at a time. Throws work_error, and may leave a piece of the text.
std::size_t append_to_file(const std::string& path, std::size_t size, const std::string& text);

/// Gives the file `from` a second name `to`, in the place of a file that is there; false if the system cannot (another
/// file system, no such file): the caller copies. Throws work_error for what would stop a copy too.
bool link_file(const std::string& from, const std::string& to);

/// All bytes of a file. Throws input_error if it cannot be read.
std::vector<std::uint8_t> read_file(const std::string& path);

/// Makes a folder and those above it. Throws work_error if that fails or something else has the name.
void make_folder(const std::string& path);

/// Throws work_error unless a file can be made in the folder, which is made if need be: asked before long work.
void require_writable(const std::string& folder);

/// Whether a file of this name is one that is being written, or was: ".NAME.HOST.PID.N.part" of any host.
bool is_temporary_name(const std::string& name);

struct Swept {
  int files = 0;
  double bytes = 0;
};

/// Removes what killed processes left unfinished in a folder; files that are being written stay, and all where the file
/// system has no locks that tell. `dry_run`: only counts.
Swept sweep_temporaries(const std::string& folder, bool dry_run = false);

}  // namespace softreel
