#include "core/mesh/placement.h"

#include <cmath>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {
namespace {

/// The rotation that carries the file's up axis to +Y; of entries 0 and 1 only, so that it adds no round-off.
Mat3 upright(PlacementParams::Up up) {
  Mat3 turn = Mat3::Identity();
  if (up == PlacementParams::Up::X) turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  if (up == PlacementParams::Up::Z) turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return turn;
}

void require_positive(const char* name, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw input_error(
        fmt::format("{} = {} is no size for a body.\n  Accepted: a positive number. Use {} = 1.", name, value, name));
}

}  // namespace

Placement place(const SurfaceMesh& mesh, const PlacementParams& params) {
  Placement placement;
  placement.linear = upright(params.up);
  if (params.fit != 0) {
    require_positive("fit", params.fit);
    Bounds bounds;
    for (const Triangle& triangle : mesh.triangles)
      for (const Index v : triangle) bounds.add(placement.linear * mesh.positions[static_cast<std::size_t>(v)]);
    const double height = bounds.empty() ? 0 : bounds.size().y();
    if (!(height > 0) || !std::isfinite(params.fit / height))
      throw input_error(
          fmt::format("fit = {} cannot be reached: the mesh has the height {} along its up axis.\n"
                      "  Accepted: a mesh that is not flat along `up`. Choose another `up`, or use `scale`.",
                      params.fit, height));
    const double scale = params.fit / height;
    const Vec3 foot(bounds.center().x(), bounds.min.y(), bounds.center().z());
    placement.linear *= scale;
    placement.offset = -scale * foot;
  } else {
    require_positive("scale", params.scale);
    placement.linear *= params.scale;
  }
  if (!params.rotate_rad.isZero(0)) {
    const Mat3 turn = (Eigen::AngleAxisd(params.rotate_rad.z(), Vec3::UnitZ()) *
                       Eigen::AngleAxisd(params.rotate_rad.y(), Vec3::UnitY()) *
                       Eigen::AngleAxisd(params.rotate_rad.x(), Vec3::UnitX()))
                          .toRotationMatrix();
    placement.linear = (turn * placement.linear).eval();
    placement.offset = (turn * placement.offset).eval();
  }
  placement.offset += params.translate;
  return placement;
}

void apply(const Placement& placement, SurfaceMesh& mesh) {
  for (Vec3& p : mesh.positions) p = placement(p);
}

Vec3 undo(const Placement& placement, const Vec3& file_position, const Vec3& rest, const Vec3& deformed) {
  if (deformed == rest) return file_position;
  return file_position + placement.linear.inverse() * (deformed - rest);
}

}  // namespace softreel
