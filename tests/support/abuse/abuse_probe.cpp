/// abuse_probe ACTION FOLDER: does one thing to the files of a folder that has "old" (100 bytes) in it, as a C++
/// program would, and prints the name of the error, or "done". The abuse library is tested with it.
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <map>
#include <string>

#include <fcntl.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

const std::string kData(1000, 'x');

bool write_all(int fd) {
  std::size_t done = 0;
  while (done < kData.size()) {
    const ssize_t written = ::write(fd, kData.data() + done, kData.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    done += static_cast<std::size_t>(written);
  }
  return true;
}

bool write_stream(const std::string& folder) {
  errno = 0;
  std::ofstream out(folder + "/new", std::ios::binary);
  out << kData;
  out.close();
  return out.good();
}

/// Small pieces stay in the buffer of the stream until it is flushed.
bool write_stdio(const std::string& folder) {
  std::FILE* file = std::fopen((folder + "/new").c_str(), "wb");
  if (file == nullptr) return false;
  for (const char c : kData) std::fputc(c, file);
  const bool flushed = std::fflush(file) == 0 && ::fsync(::fileno(file)) == 0;
  return std::fclose(file) == 0 && flushed;
}

bool write_descriptor(const std::string& folder) {
  const int fd = ::open((folder + "/new").c_str(), O_WRONLY | O_CREAT, 0644);
  return fd >= 0 && write_all(fd);
}

bool write_vector(const std::string& folder) {
  const int fd = ::open((folder + "/new").c_str(), O_WRONLY | O_CREAT, 0644);
  if (fd < 0) return false;
  std::string data = kData;
  for (std::size_t done = 0; done < data.size();) {
    const std::size_t half = (data.size() - done) / 2;
    const std::array<iovec, 2> parts{
        {{data.data() + done, half}, {data.data() + done + half, data.size() - done - half}}};
    const ssize_t written = ::writev(fd, parts.data(), 2);
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) done += static_cast<std::size_t>(written);
  }
  return true;
}

bool write_unnamed(const std::string& folder) {
  const int fd = ::open(folder.c_str(), O_TMPFILE | O_WRONLY, 0644);
  if (fd < 0 || !write_all(fd)) return false;
  const std::string link = "/proc/self/fd/" + std::to_string(fd);
  return ::linkat(AT_FDCWD, link.c_str(), AT_FDCWD, (folder + "/new").c_str(), AT_SYMLINK_FOLLOW) == 0;
}

/// Copies all of "old" by calls of `copy(in, out)`.
bool copy_by(const std::string& folder, const std::function<ssize_t(int, int)>& copy) {
  const int in = ::open((folder + "/old").c_str(), O_RDONLY),
            out = ::open((folder + "/new").c_str(), O_WRONLY | O_CREAT, 0644);
  if (in < 0 || out < 0) return false;
  for (;;) {
    const ssize_t copied = copy(in, out);
    if (copied == 0) return true;
    if (copied < 0 && errno != EINTR) return false;
  }
}

using Action = std::function<bool(const std::string& folder)>;

const std::map<std::string, Action> kActions = {
    {"ofstream", write_stream},
    {"stdio", write_stdio},
    {"write", write_descriptor},
    {"writev", write_vector},
    {"tmpfile", write_unnamed},
    {"copy_file_range",
     [](const std::string& folder) {
       return copy_by(folder, [](int in, int out) { return ::copy_file_range(in, nullptr, out, nullptr, 1000, 0); });
     }},
    {"sendfile",
     [](const std::string& folder) {
       return copy_by(folder, [](int in, int out) { return ::sendfile(out, in, nullptr, 1000); });
     }},
    {"rename",
     [](const std::string& folder) { return ::rename((folder + "/old").c_str(), (folder + "/new").c_str()) == 0; }},
    {"renameat",
     [](const std::string& folder) {
       const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY);
       return ::renameat(fd, "old", fd, "new") == 0;
     }},
    {"link",
     [](const std::string& folder) { return ::link((folder + "/old").c_str(), (folder + "/new").c_str()) == 0; }},
    {"unlink", [](const std::string& folder) { return ::unlink((folder + "/old").c_str()) == 0; }},
    {"remove", [](const std::string& folder) { return std::remove((folder + "/old").c_str()) == 0; }},
    {"mkdir", [](const std::string& folder) { return ::mkdir((folder + "/new").c_str(), 0755) == 0; }},
    {"truncate", [](const std::string& folder) { return ::open((folder + "/old").c_str(), O_RDONLY | O_TRUNC) >= 0; }},
    {"read",
     [](const std::string& folder) {
       std::ifstream in(folder + "/old", std::ios::binary);
       std::string data(100, 0);
       return in.read(data.data(), 100).gcount() == 100;
     }},
};

void print_clocks() {
  for (int i = 0; i < 20; ++i) {
    timespec day{}, steady{};
    timeval old{};
    ::clock_gettime(CLOCK_REALTIME, &day);
    ::clock_gettime(CLOCK_MONOTONIC, &steady);
    ::gettimeofday(&old, nullptr);
    std::printf("%ld %ld %ld %ld\n", static_cast<long>(day.tv_sec), static_cast<long>(old.tv_sec),
                static_cast<long>(std::time(nullptr)), static_cast<long>(steady.tv_sec));
  }
}

}  // namespace

int main(int count, char** arguments) {
  const std::string action = count > 1 ? arguments[1] : "", folder = count > 2 ? arguments[2] : "";
  if (action == "clock") return print_clocks(), 0;
  const auto found = kActions.find(action);
  if (found == kActions.end()) return std::fprintf(stderr, "abuse_probe: unknown action %s\n", action.c_str()), 2;
  const bool done = found->second(folder);
  std::printf("%s\n", done ? "done" : ::strerrorname_np(errno));
  return done ? 0 : 1;
}
