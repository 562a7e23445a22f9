/// How selections, active frames and the keys of pins and pulls are spelt in a shot.
#pragma once

#include <optional>
#include <vector>

#include "tool/shot/codecs.h"

namespace softreel {

/// One selection { box = ..., unit = "box" } or a list of them, which is their union.
Codec<Selection> selection_codec();

/// [first, last] or [[first, last], ...].
Codec<std::vector<FrameRange>> frame_ranges_codec();

/// The keys of a pin or pull; a key without a pivot takes the one of the nearest key before it that has one, else
/// after.
struct Motion {
  Track<Transform> track;
  bool pivot_given = false;
};
Codec<Motion> motion_codec();

}  // namespace softreel
