/// How what pins and pulls follow, and painted weights, are spelt in a shot.
#pragma once

#include <optional>

#include "tool/shot/codecs.h"

namespace softreel {

/// { file = ..., node | mesh = ..., clip, start, speed, reference, placement, bind }.
Codec<std::optional<FollowSettings>> follow_codec();

/// { file, attribute } or { color } or { attribute }; text alone is the file.
Codec<std::optional<WeightSource>> weights_codec();

}  // namespace softreel
