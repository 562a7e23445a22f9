/// The most memory a process held, from the kernel's account of it (Linux).
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

namespace softreel::test {

/// Under the address sanitizer, whose own heap takes more and keeps what was given back.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kIsSanitized = true;
#elif defined(__has_feature)  // clang's way to say it
constexpr bool kIsSanitized = __has_feature(address_sanitizer);
#else
constexpr bool kIsSanitized = false;
#endif

/// Lets the peak begin again from what is held now; needs write access to /proc/self, which a process has.
inline void reset_peak_memory() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

/// Largest resident size since the last reset, bytes; 0 where the kernel does not say.
inline std::int64_t peak_memory() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
    if (word == "VmHWM:") {
      std::int64_t kilobytes = 0;
      status >> kilobytes;
      return kilobytes * 1024;
    }
  return 0;
}

}  // namespace softreel::test
