// Says what processor softreel needs where it would else die of an illegal instruction. Compiled for any x86-64
// processor, and run before anything that is not: all other sources are compiled for x86-64-v3
// (tool/cmake/warnings.cmake), constructors of their static objects too.
#include <unistd.h>

namespace {

constexpr char kMessage[] =
    "softreel: this processor lacks AVX2, FMA or BMI2, which softreel is built for.\n"
    "  Accepted: x86-64-v3 (Intel since Haswell, 2013; AMD since Zen, 2017). Use such a machine, or in a virtual one a "
    "processor model that has them.\n";

__attribute__((constructor(101))) void refuse_old_processors() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 && __builtin_cpu_supports("bmi2") != 0)
    return;
  const auto written = write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  _exit(written < 0 ? 1 : 2);
}

}  // namespace
