#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "core/base/error.h"
#include "tool/commands/command_line.h"
#include "tool/commands/interruption.h"

int main(int argc, char** argv) {
  softreel::watch_for_interruption();
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit is said like a full disk
  try {
    return softreel::run_command_line(argc, argv);
  } catch (const softreel::Error& error) {
    std::fprintf(stderr, "\nsoftreel: %s\n", error.what());
    return static_cast<int>(error.kind());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr,
                 "\nsoftreel: out of memory.\n  Fewer tetrahedra (body.NAME.tets) or smaller pictures need less.\n");
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "\nsoftreel: %s\n  This is a mistake in softreel, not in your files.\n", error.what());
    return 1;
  }
}
