/// A hash of what a picture shows, which seeds its samples.
#pragma once

#include <cstdint>

#include "render/scene/scene.h"

namespace softreel {

/// Of the camera and of all meshes' triangles and positions; not of the frame number, lights or materials: frames in
/// which nothing moved are equal bits, and changing a light does not change the noise.
std::uint64_t picture_hash(const Scene& scene);

}  // namespace softreel
