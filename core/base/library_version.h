/// The version of the library behind core/base/parallel.h, which nothing else includes.
#pragma once

#include <string>

namespace softreel {

/// Of the oneTBB that is loaded: "2021.8".
std::string thread_library_version();

}  // namespace softreel
