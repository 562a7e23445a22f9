/// Which pixels need more samples to look clean.
///
/// The error of a pixel is the standard error of its mean as it looks on a screen, where the eye sees about the square
/// root of light (Dammertz et al., A Hierarchical Automatic Stopping Condition for Monte Carlo Global Illumination,
/// 2009, use the same measure): sigma / (2 sqrt(mean)), averaged over the colours. It is estimated from batches of
/// samples; since batches complement each other (Owen's scrambling), it is on the safe side. A pixel's own estimate is
/// noisy: pixels stop by the root mean square over the 5 x 5 pixels around them, which also keeps the bias of stopping
/// by what was measured (Kirk and Arvo, Unbiased Sampling Techniques for Image Synthesis, 1991) small.
#pragma once

#include <cstdint>
#include <vector>

#include "render/pathtrace/pixel_sums.h"

namespace softreel {

/// Squared error of a pixel on a screen whose white is 1, with that of a shadow on it; of whole batches, at least two.
/// 0 before that.
double squared_screen_error(const PixelSums& pixel);

/// Per pixel, 1 where the error around it is above `noise`. pixels: height x width.
std::vector<std::uint8_t> noisy_pixels(const std::vector<PixelSums>& pixels, int width, int height, double noise);

/// Samples of a pixel after the next pass, given those after the last one: about a quarter more, in whole `step`s.
int samples_after_pass(int samples, int step, int most);

}  // namespace softreel
