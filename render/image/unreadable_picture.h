/// The error of a picture file that gives no picture, whatever its format.
#pragma once

#include <string>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {

/// reason: what is wrong, as the end of a sentence. accepted: what would do.
inline Error unreadable_picture(const std::string& path, const std::string& reason, const std::string& accepted) {
  return input_error(
      fmt::format("{}: cannot be read: {}.\n"
                  "  Accepted: {}. Check the path, or save the picture again from the program that made it.",
                  path, reason, accepted));
}

}  // namespace softreel
