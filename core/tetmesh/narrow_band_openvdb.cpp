/// The only place that knows OpenVDB.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include "core/tetmesh/narrow_band.h"

namespace softreel {
namespace {

/// What OpenVDB is asked for: at 2 and below it leaves out its widening, and voxels within 2 of the surface are
/// missing.
constexpr float kMeasuredVoxels = 2.5F;
static_assert(kMeasuredVoxels > kBandVoxels);

/// Corners in the lattice's own coordinates, the origin subtracted in double: far from the world's origin no bit is
/// lost in OpenVDB's floats.
struct LatticeSpaceMesh {
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  const LatticeFrame& frame;

  std::size_t polygonCount() const { return triangles.size(); }
  std::size_t pointCount() const { return positions.size(); }
  std::size_t vertexCount(std::size_t /*polygon*/) const { return 3; }
  void getIndexSpacePoint(std::size_t polygon, std::size_t corner, openvdb::Vec3d& point) const {
    const Vec3 p =
        (positions[static_cast<std::size_t>(triangles[polygon][corner])] - frame.origin) * (2.0 / frame.spacing);
    point = openvdb::Vec3d(p[0], p[1], p[2]);
  }
};

bool is_lattice_node(const openvdb::Coord& at) {
  return ((at.x() ^ at.y()) & 1) == 0 && ((at.x() ^ at.z()) & 1) == 0;
}

}  // namespace

void softreel_measure_narrow_band(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                  const LatticeFrame& frame, std::vector<BandNode>& band) {
  const LatticeSpaceMesh mesh{positions, triangles, frame};
  const openvdb::math::Transform::Ptr unit = openvdb::math::Transform::createLinearTransform(1.0);
  openvdb::Int32Grid nearest(-1);
  const openvdb::FloatGrid::Ptr grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      mesh, *unit, kMeasuredVoxels, kMeasuredVoxels, openvdb::tools::UNSIGNED_DISTANCE_FIELD, &nearest);
  auto nearest_reader = nearest.getConstAccessor();
  for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf)
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
      const openvdb::Coord at = voxel.getCoord();
      if (!is_lattice_node(at)) continue;
      band.push_back({{at.x(), at.y(), at.z()}, static_cast<double>(*voxel), nearest_reader.getValue(at)});
    }
}

}  // namespace softreel
