/// Pictures of deformed bodies in the studio of `softreel inspect --picture`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/tetmesh/tet_mesh.h"
#include "tests/benchmark/report/report.h"

namespace softreel::bench {

/// A body where it is, in linear colour.
struct PosedBody {
  const TetMesh* mesh = nullptr;
  std::vector<Vec3> positions;  ///< per node, m
  Vec3f color{0.24f, 0.38f, 0.54f};
};

inline const Vec3f kBlue{0.24f, 0.38f, 0.54f}, kRust{0.62f, 0.16f, 0.07f};

/// Bodies side by side: each is moved along `direction` until `gap` (m) lies between it and the one before.
std::vector<PosedBody> in_a_row(std::vector<PosedBody> bodies, const Vec3& direction, double gap);

/// Draws the boundary faces with their edges into `file` of the report's folder and adds the picture. size: "1100x400".
/// Without the path tracer says so instead.
void add_body_picture(Report& report, const std::vector<PosedBody>& bodies, const Vec3& facing, const std::string& file,
                      const std::string& size, const std::string& caption);

}  // namespace softreel::bench
