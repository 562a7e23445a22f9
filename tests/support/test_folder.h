/// Where cases write.
#pragma once

#include <filesystem>

namespace softreel::testing {

/// A folder of this process, made when it is first asked for, so that cases and users that run beside each other do not
/// meet. It goes when all cases of the process passed; what a failed one made stays to be looked at.
std::filesystem::path test_folder();

}  // namespace softreel::testing
