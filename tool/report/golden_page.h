/// Golden images and what became of them, as one HTML page that needs nothing else.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace softreel {

struct GoldenPageFrame {
  std::string shot;
  int frame = 0;
  bool changed = false;        ///< or missing
  bool missing = false;        ///< there is no golden image
  std::string verdict, cause;  ///< a sentence each
  /// PNG files; empty where there is none. Only those of changed frames are shown.
  std::vector<std::uint8_t> golden, now, difference;
};

/// A table of all frames; of the changed ones both pictures under a slider, and their difference with its scale.
std::string golden_page(const std::vector<GoldenPageFrame>& frames);

}  // namespace softreel
