/// Binary glTF 2.0: a body whose samples are morph targets, and an animation that goes from one to the next.
#pragma once

#include "tool/export/exporter.h"

namespace softreel {

/// POSITION is the body at rest: the vertices of the file in order, then duplicates at texture seams. The target of a
/// sample holds differences to it, rounded so that rest + difference in float32 is the nearest float32 of the sample's
/// position wherever a float32 difference can give it, and within half a unit in the last place of the difference where
/// none can. Weights go linearly from target to target, each 1 at its frame over the rate, in seconds: frame 0 is at 0.
/// Texture coordinates have their origin at the top, as glTF wants them; PNG and JPEG textures lie in the file.
/// Colours of vertices, where the look shows them, are COLOR_0, linear. In object space the node carries the body's
/// placement, which is a rotation, one scale and a translation.
///
/// The header comes first and needs everything; so vertex data goes to a scratch file, and what grows with the samples
/// in memory is their lines of the header, half a kilobyte each. The weights are samples x samples numbers in the file.
/// A file that would pass 4 GiB, which glTF cannot say, is refused before it is begun; so are frames before 0.
ExportFormat glb_format();

}  // namespace softreel
