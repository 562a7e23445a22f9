/// The most that filling takes in memory: 300 bytes a tetrahedron, whatever the mode.
#include <gtest/gtest.h>
#include <malloc.h>

#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/support/peak_memory.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

/// Resident beyond what was so before, at the peak.
double peak_bytes_a_tet(const TetrahedralizeParams& params) {
  const SurfaceMesh surface = test::make_torus(1.0, 0.35, 96, 32, Vec3::Zero());
  const Threads threads(1);
  const Log silent{[](const std::string&) {}, [](const std::string&) {}};
  StageTimes times;
  malloc_trim(0);  // what other tests gave back is not to be filled unseen
  test::reset_peak_memory();
  const std::int64_t before = test::peak_memory();
  EXPECT_GT(before, 0);
  const TetMesh mesh = tetrahedralize(surface, params, "torus", threads, silent, times);
  const double bytes = static_cast<double>(test::peak_memory() - before) / static_cast<double>(mesh.tets.size());
  EXPECT_GT(mesh.tets.size(), 30000U) << "the surface's own share is to be small";
  EXPECT_GT(bytes, 30) << "the account sees the mesh";
  ::testing::Test::RecordProperty("bytes", std::to_string(bytes));
  return bytes;
}

class FillingMemory : public ::testing::Test {
 protected:
  void SetUp() override {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "a sanitizer keeps what was given back";
#endif
  }
};

TEST_F(FillingMemory, OfOneSizeIsBounded) {
  EXPECT_LT(peak_bytes_a_tet({.tets = 100000}), 300);
}

TEST_F(FillingMemory, OfGradedSizesIsBounded) {
  EXPECT_LT(peak_bytes_a_tet({.edge = 0.055, .graded = true}), 300);
}

TEST_F(FillingMemory, OfAnErrorBudgetIsBounded) {
  EXPECT_LT(peak_bytes_a_tet({.error = 0.006}), 300);
}

TEST_F(FillingMemory, OfWholeLatticeTetrahedraIsBounded) {
  EXPECT_LT(peak_bytes_a_tet({.tets = 100000, .mode = TetMode::Embedded}), 300);
}

}  // namespace
}  // namespace softreel
