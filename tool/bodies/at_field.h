/// Gives the errors of a piece of work the place of the field that asked for it.
#pragma once

#include <string>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/shot/shot.h"

namespace softreel {

/// Runs `work`; what it throws gets "FILE:LINE: FIELD: " in front.
template <typename Work>
auto at_field(const Origin& origin, const std::string& field, Work work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("{}: {}: {}", to_string(origin), field, error.what()));
  }
}

}  // namespace softreel
