/// Bytes as text of 64 characters (RFC 4648, section 4), for files that are text.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace softreel {

std::string base64(std::span<const std::uint8_t> bytes);

/// What base64 wrote. Throws work_error for anything else.
std::vector<std::uint8_t> from_base64(const std::string& text);

}  // namespace softreel
