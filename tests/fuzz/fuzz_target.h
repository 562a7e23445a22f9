/// What a fuzz target defines, for libFuzzer and for the driver of this folder alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/check.h"
#include "core/base/error.h"

/// Runs one input. The first byte chooses the format, the file's bytes follow. Aborts where a promise is broken: bytes
/// become a sound mesh or picture, or one Error of kind Input, whose message is short.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace softreel::fuzz {

/// Small sound inputs that use every feature of their formats: what mutations start from.
std::vector<std::string> seeds();

/// A refusal blames the input, in a message that a terminal shows: two lines without control characters.
inline void check_message(const Error& error) {
  const std::string message = error.what();
  CHECK(error.kind() == ErrorKind::Input);
  CHECK(message.starts_with("fuzz"));
  CHECK(message.size() < 1000U);
  for (const char c : message) CHECK((c == '\n' || static_cast<unsigned char>(c) >= ' '));
}

/// Gives an input's first byte and what follows to `read`, which may refuse it by an Error.
template <typename Read>
int run_input(const std::uint8_t* data, std::size_t size, const Read& read) {
  if (size == 0) return 0;
  try {
    read(data[0], std::string_view(reinterpret_cast<const char*>(data) + 1, size - 1));
  } catch (const Error& error) {
    check_message(error);
  }
  return 0;
}

}  // namespace softreel::fuzz
