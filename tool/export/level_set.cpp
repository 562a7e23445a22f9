#include "tool/export/level_set.h"

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/part.h"

namespace softreel {

double estimate_voxels(const LevelSetSurface& surface, const LevelSetParams& params) {
  double area = 0;
  for (const Triangle& t : surface.triangles) {
    const auto at = [&](std::size_t k) { return surface.positions[static_cast<std::size_t>(t[k])]; };
    area += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
  }
  return area / (params.voxel * params.voxel) * 2 * params.half_width;
}

#if SOFTREEL_WITH_OPENVDB

void require_level_sets() {}

std::vector<std::uint8_t> encode_level_set(const LevelSetSurface& surface, const LevelSetParams& params,
                                           const Threads& threads) {
  CHECK(params.voxel > 0);
  static const auto encode = part_function<&softreel_encode_level_set>("openvdb", "softreel_encode_level_set");
  std::vector<std::uint8_t> bytes;
  threads.run([&] { encode(surface, params, bytes); });
  return bytes;
}

#else

void require_level_sets() {
  throw input_error(
      "--format vdb: this build of softreel has no OpenVDB: it was configured with SOFTREEL_WITH_OPENVDB=OFF or "
      "without the library.\n"
      "  Accepted: a build with SOFTREEL_WITH_OPENVDB=ON. Install libopenvdb-dev and libboost-iostreams-dev and "
      "configure again, or choose another format.");
}

std::vector<std::uint8_t> encode_level_set(const LevelSetSurface& /*surface*/, const LevelSetParams& /*params*/,
                                           const Threads& /*threads*/) {
  require_level_sets();
  return {};
}

#endif

}  // namespace softreel
