#include "tool/stages/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "core/base/error.h"

namespace softreel {
namespace fs = std::filesystem;

namespace {

std::string advice(int code) {
  if (code == ENOSPC || code == EDQUOT) return "Free some space or choose another folder with --output.";
  if (code == EACCES || code == EROFS || code == EPERM)
    return "Accepted: a folder that can be written. Choose one with --output DIR.";
  return "Check the path, or choose another folder with --output.";
}

/// A name in the same folder that no other process uses and that no pattern of the outputs matches.
std::string temporary_name(const std::string& path) {
  const fs::path p(path);
  return (p.parent_path() / fmt::format(".{}.{}.part", p.filename().string(), ::getpid())).string();
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)), temporary_(temporary_name(path_)) {
  const fs::path parent = fs::path(path_).parent_path();
  if (!parent.empty()) make_folder(parent.string());
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (file_ == nullptr) fail("cannot be created");
}

AtomicFile::~AtomicFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::remove(temporary_.c_str());
}

void AtomicFile::fail(const char* what) const {
  const int code = errno;
  throw work_error(
      fmt::format("{}: {}: {}.\n  {} Finished files are intact.", path_, what, std::strerror(code), advice(code)));
}

void AtomicFile::write(std::span<const std::uint8_t> bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail("cannot be written");
}

void AtomicFile::commit() {
  if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) fail("cannot be written");
  std::FILE* file = file_;
  file_ = nullptr;
  const bool closed = std::fclose(file) == 0;
  if (closed && std::rename(temporary_.c_str(), path_.c_str()) == 0) return;
  const int code = errno;
  std::remove(temporary_.c_str());
  errno = code;
  fail("cannot be written");
}

void write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

void write_file(const std::string& path, const std::string& text) {
  write_file(path, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

std::vector<std::uint8_t> read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? static_cast<std::streamoff>(in.tellg()) : -1;
  if (size < 0 || fs::is_directory(path))
    throw input_error(fmt::format("{}: cannot be read: {}.\n  Accepted: a readable file. Check the path.", path,
                                  fs::is_directory(path) ? "it is a folder" : std::strerror(errno)));
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(bytes.data()), size);
  if (!in && size > 0) throw input_error(fmt::format("{}: cannot be read to its end.", path));
  return bytes;
}

void make_folder(const std::string& path) {
  std::error_code code;
  fs::create_directories(path, code);
  if (!code && fs::is_directory(path)) return;
  const std::string reason = code ? code.message() : "something that is no folder has this name";
  throw work_error(fmt::format("{}: cannot be made a folder: {}.\n  {}", path, reason, advice(code.value())));
}

}  // namespace softreel
