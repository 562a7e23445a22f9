#include "core/base/part.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel::detail {
namespace {

Error unusable(const std::string& file) {
  const char* reason = dlerror();
  return work_error(fmt::format(
      "{}: this part of softreel cannot be loaded: {}.\n"
      "  Accepted: the file that was built with this program, in ../lib/softreel from the program. Build or install "
      "softreel again as a whole, or install the library that is missing.",
      file, reason != nullptr ? reason : "no reason given"));
}

}  // namespace

void* part_symbol(const char* part, const char* symbol) {
  const std::string file = fmt::format("softreel_part_{}.so", part);
  // Without a folder in its name: found by the RUNPATH of the program. The loader counts its users; it loads once.
  void* module = dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (module == nullptr) throw unusable(file);
  void* function = dlsym(module, symbol);
  if (function == nullptr) throw unusable(file);
  return function;
}

}  // namespace softreel::detail
