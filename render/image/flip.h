/// FLIP: how different two display pictures look to a person who flips between them.
///
/// Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem and Fairchild, FLIP: A Difference Evaluator for Alternating
/// Images, 2020; the LDR-FLIP of that paper, with its constants. Section numbers below are the paper's.
#pragma once

#include <vector>

#include "render/image/image_io.h"

namespace softreel {

/// Pixels under one degree of the viewer's eye: 0.7 m from a screen of 3840 pixels and 0.7 m (sec. 4.1).
inline constexpr float kFlipPixelsPerDegree = 67.0f;

/// A value per pixel in [0, 1], row 0 on top; 0: looks the same, 1: pure green beside pure blue.
struct FlipMap {
  int width = 0, height = 0;
  std::vector<float> errors;
};

/// The error of each pixel; symmetric in a and b, 0 where both pictures are the same round about. Sizes must be equal.
FlipMap flip(const DisplayImage& a, const DisplayImage& b, float pixels_per_degree = kFlipPixelsPerDegree);

/// The numbers of a map.
struct FlipSummary {
  double mean = 0;
  double worst_block = 0;  ///< largest mean over a block of kFlipBlock x kFlipBlock pixels: what a small change does
  int worst_x = 0, worst_y = 0;  ///< top left pixel of that block
};
inline constexpr int kFlipBlock = 16;
FlipSummary summarize(const FlipMap& map);

/// The map in the colours of magma: black for 0, violet, orange, light yellow for 1.
DisplayImage flip_picture(const FlipMap& map);

/// The colour of magma at a share in [0, 1], display values: S. van der Walt and N. Smith's map (2015, CC0) as the
/// polynomial of M. Zucker (CC0), within 1/60 of its table.
Vec3f magma(float share);

}  // namespace softreel
