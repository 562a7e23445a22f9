/// Radiance pictures (.hdr): colours with a shared exponent, in any of the three codings of their rows.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "render/scene/light.h"

namespace softreel {

/// The picture in the bytes of a file. path: for messages. Refuses what is cut off, of no or absurd size, or not made
/// of whole rows. Memory grows with the rows that are read, not with what the header claims. Throws input_error.
EnvironmentImage decode_radiance(const std::string& path, std::string_view bytes);

/// The same from the file itself.
EnvironmentImage read_radiance(const std::string& path);

/// Width and height by the header alone, which is all that is read. Throws input_error.
std::pair<int, int> radiance_size(const std::string& path);

}  // namespace softreel
