/// Paths without detours that lead to the file which the system would open.
#pragma once

#include <filesystem>

namespace softreel {

/// The path without ".", ".." and doubled slashes. Where a ".." follows a link to a folder, taking both out of the text
/// would lead to another file: then it is the whole path without links.
std::filesystem::path plain_path(const std::filesystem::path& path);

}  // namespace softreel
