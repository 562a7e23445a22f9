#include <csignal>
#include <exception>
#include <new>
#include <string>

#include "core/base/error.h"
#include "tool/commands/command_line.h"
#include "tool/commands/interruption.h"
#include "tool/commands/standard_output.h"
#include "tool/report/console.h"

namespace {

int run(int argc, char** argv) {
  try {
    return softreel::run_command_line(argc, argv);
  } catch (const softreel::Error& error) {
    softreel::say_error(error.kind() == softreel::ErrorKind::Interrupt ? softreel::interruption_message(error.what())
                                                                       : error.what());
    return static_cast<int>(error.kind());
  } catch (const std::bad_alloc&) {
    softreel::say_error("out of memory.\n  Fewer tetrahedra (body.NAME.tets) or smaller pictures need less.");
    return 1;
  } catch (const std::exception& error) {
    softreel::say_error(std::string(error.what()) + "\n  This is a mistake in softreel, not in your files.");
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  softreel::watch_for_interruption();
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit is said like a full disk
  return softreel::status_after_output(run(argc, argv));
}
