/// Textures of the assets: small pictures that repeat without a seam.
#pragma once

#include <string>

#include "render/image/image_io.h"

namespace softreel::sculpt {

/// A patchwork of 4 x 4 fabrics: gingham, dots, stripes, plain. 512 x 512, sRGB; a patch is a tile of the quilted bar.
DisplayImage make_patchwork();

/// The normals of a plain weave, 16 threads either way. 256 x 256, green upward.
DisplayImage make_weave_normals();

}  // namespace softreel::sculpt
