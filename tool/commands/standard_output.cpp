#include "tool/commands/standard_output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include <unistd.h>

#include "tool/report/console.h"

namespace softreel {
namespace {

/// Why standard output takes no more; 0: it has taken everything.
int output_failure() {
  const bool has_failed_before = std::ferror(stdout) != 0;
  if (std::fflush(stdout) != 0) return errno;
  if (!has_failed_before) return 0;
  // The reason is long forgotten: what is missing of the output is asked for again, with a line end.
  if (::write(STDOUT_FILENO, "\n", 1) < 0) return errno;
  return EIO;
}

}  // namespace

int status_after_output(int status) {
  const int failure = output_failure();
  if (failure == 0) return status;
  if (failure != EPIPE) say_error(std::string("cannot write to standard output: ") + std::strerror(failure));
  return status != 0 ? status : 1;
}

}  // namespace softreel
