#include "tool/export/level_set.h"

#include <sstream>

#include <gtest/gtest.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include "tests/support/surfaces.h"
#include "tool/export/vdb_export.h"

namespace softreel {
namespace {

constexpr double kRadius = 0.4;
const Vec3 kCenter(0.3, -0.2, 0.1);

/// The grids of the bytes, read by OpenVDB.
openvdb::FloatGrid::Ptr read(const std::vector<std::uint8_t>& bytes) {
  openvdb::initialize();
  std::istringstream text(std::string(bytes.begin(), bytes.end()));
  const openvdb::GridPtrVecPtr grids = openvdb::io::Stream(text, /*delayLoad=*/false).getGrids();
  EXPECT_EQ(grids->size(), 1U);
  return openvdb::gridPtrCast<openvdb::FloatGrid>((*grids)[0]);
}

LevelSetParams params_of(double voxel) {
  LevelSetParams params;
  params.voxel = voxel;
  return params;
}

std::vector<std::uint8_t> encode(const SurfaceMesh& mesh, double voxel, int threads = 1) {
  return encode_level_set({mesh.positions, mesh.triangles}, params_of(voxel), Threads(threads));
}

double distance_at(const openvdb::FloatGrid& grid, const Vec3& p) {
  openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler> sampler(grid);
  return sampler.wsSample(openvdb::Vec3d(p.x(), p.y(), p.z()));
}

TEST(LevelSet, OfASphereHasItsDistancesWithinAVoxel) {
  const double voxel = 0.02;
  const auto grid = read(encode(test::make_sphere(kRadius, 32, kCenter), voxel));
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(grid->getName(), "surface");
  EXPECT_NEAR(grid->voxelSize()[0], voxel, 1e-12);
  EXPECT_NEAR(grid->background(), 3 * voxel, 1e-6);
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(1, 2, 3), Vec3(-3, 1, -0.5)})
    for (const double off : {-0.04, -0.01, 0.0, 0.013, 0.04})
      EXPECT_NEAR(distance_at(*grid, kCenter + (kRadius + off) * direction.normalized()), off, 0.2 * voxel);
}

TEST(LevelSet, FarFromTheSurfaceIsTheBackgroundWithItsSign) {
  const double voxel = 0.02;
  const auto grid = read(encode(test::make_sphere(kRadius, 16, kCenter), voxel));
  EXPECT_NEAR(distance_at(*grid, kCenter), -3 * voxel, 1e-6) << "negative inside";
  EXPECT_NEAR(distance_at(*grid, Vec3(5, 5, 5)), 3 * voxel, 1e-6);
}

/// What --format vdb makes of a surface.
openvdb::FloatGrid::Ptr exported(const SurfaceMesh& mesh, double voxel) {
  const Threads threads(2);
  std::vector<std::uint8_t> bytes;
  ExportTarget target;
  target.settings.voxel = voxel;
  target.bodies.emplace_back();
  target.bodies[0].mesh = &mesh;
  target.threads = &threads;
  target.sink = [&bytes](std::span<const std::uint8_t> part) { bytes.insert(bytes.end(), part.begin(), part.end()); };
  const FilledBody filled;
  const std::vector<ElementMaterial> materials;
  const std::vector<Vec3> nodes;
  const TetSample tets{filled, materials, nodes};
  ExportSample sample;
  sample.positions = mesh.positions;
  sample.tets = &tets;
  const auto writer = vdb_format().make(target);
  writer->append(sample);
  writer->finish();
  return read(bytes);
}

TEST(VdbExport, TheCavityOfAHollowSphereIsOutside) {
  const double voxel = 0.02;
  SurfaceMesh mesh = test::make_sphere(kRadius, 24, kCenter), cavity = test::make_sphere(0.2, 16, kCenter);
  test::turn_inside_out(cavity);
  test::append(mesh, cavity);
  const auto grid = exported(mesh, voxel);
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_NEAR(distance_at(*grid, kCenter), 3 * voxel, 1e-6);
  EXPECT_NEAR(distance_at(*grid, kCenter + Vec3(0.3, 0, 0)), -3 * voxel, 1e-6);
  EXPECT_NEAR(distance_at(*grid, kCenter + Vec3(0.6, 0, 0)), 3 * voxel, 1e-6);
  EXPECT_NEAR(distance_at(*grid, kCenter + Vec3(0, 0.22, 0)), -0.02, 0.2 * voxel);
  EXPECT_NEAR(distance_at(*grid, kCenter + Vec3(0, 0.18, 0)), 0.02, 0.2 * voxel);
  EXPECT_NEAR(distance_at(*grid, kCenter + Vec3(0, 0.42, 0)), 0.02, 0.2 * voxel);
}

TEST(VdbExport, OverlappingPartsAreOneSolid) {
  const double voxel = 0.02;
  SurfaceMesh mesh = test::make_sphere(kRadius, 24, kCenter);
  test::append(mesh, test::make_sphere(kRadius, 24, kCenter + Vec3(0.4, 0, 0)));
  const auto grid = exported(mesh, voxel);
  EXPECT_NEAR(distance_at(*grid, kCenter + Vec3(0.2, 0, 0)), -3 * voxel, 1e-6) << "where they overlap";
  EXPECT_NEAR(distance_at(*grid, kCenter + Vec3(kRadius, 0, 0)), -3 * voxel, 1e-6) << "no wall in between";
  EXPECT_NEAR(distance_at(*grid, kCenter - Vec3(kRadius, 0, 0)), 0, 0.2 * voxel);
}

TEST(LevelSet, IsTheSameBytesForAnyNumberOfThreadsAndWhenWrittenAgain) {
  const SurfaceMesh mesh = test::make_sphere(kRadius, 32, kCenter);
  const std::vector<std::uint8_t> once = encode(mesh, 0.015, 1);
  EXPECT_EQ(once, encode(mesh, 0.015, 4));
  EXPECT_EQ(once, encode(mesh, 0.015, 1));
}

TEST(EstimateVoxels, IsNearTheCountThatOpenVdbMakes) {
  const SurfaceMesh mesh = test::make_sphere(kRadius, 32, kCenter);
  const LevelSetParams params = params_of(0.01);
  const double made = static_cast<double>(read(encode(mesh, params.voxel))->activeVoxelCount());
  EXPECT_NEAR(estimate_voxels({mesh.positions, mesh.triangles}, params), made, 0.25 * made);
}

}  // namespace
}  // namespace softreel
