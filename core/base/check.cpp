#include "core/base/check.h"

#include <cstdio>
#include <cstdlib>

namespace softreel::detail {

void check_failed(const char* expression, const std::string& operands, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: CHECK(%s) failed: %s\n  This is a mistake in softreel, not in your files.\n", file, line,
               expression, operands.c_str());
  std::abort();
}

}  // namespace softreel::detail
