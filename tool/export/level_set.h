/// Distance to a closed surface on the voxels near it, as the bytes of an OpenVDB file. OpenVDB is a part of softreel
/// that is loaded when this is first called.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/types.h"

namespace softreel {

struct LevelSetParams {
  double voxel = 0;       ///< edge of a voxel, in the positions' unit; above 0
  double half_width = 3;  ///< voxels on either side of the surface that know their distance
  std::string grid_name = "surface";
};

/// A closed surface. Borrows all.
struct LevelSetSurface {
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  /// Tells the sides of the surface apart, from any thread. None: OpenVDB floods the outside from the box, whatever the
  /// orientation of the triangles; shells inside of others then do not count.
  std::function<bool(const Vec3& point)> is_inside = {};
};

/// Voxels that the narrow band will have, about: for refusing sizes that no machine can hold.
double estimate_voxels(const LevelSetSurface& surface, const LevelSetParams& params);

/// One float grid of class level set: signed distance in the positions' unit, negative inside, background half_width
/// voxels. The same input gives the same bytes, whatever the number of threads.
/// Throws input_error if softreel was built without OpenVDB, work_error where memory is short.
std::vector<std::uint8_t> encode_level_set(const LevelSetSurface& surface, const LevelSetParams& params,
                                           const Threads& threads);

/// Throws what encode_level_set would throw of a build without OpenVDB: for saying so before long work.
void require_level_sets();

/// The entry of the part, which encode_level_set calls.
extern "C" [[gnu::visibility("default")]] void softreel_encode_level_set(const LevelSetSurface& surface,
                                                                         const LevelSetParams& params,
                                                                         std::vector<std::uint8_t>& bytes);

}  // namespace softreel
