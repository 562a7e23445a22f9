/// What a body takes in memory: at most a kilobyte (1024 bytes) a tetrahedron while it steps in float.
#include <gtest/gtest.h>
#include <malloc.h>

#include "tests/core/dynamics/dynamics_support.h"
#include "tests/support/elastic_box.h"
#include "tests/support/peak_memory.h"

namespace softreel {
namespace {

/// Bytes that the heap has handed out, in small and in mapped pieces.
double live_bytes() {
  const struct mallinfo2 heap = mallinfo2();
  return static_cast<double>(heap.uordblks) + static_cast<double>(heap.hblkhd);
}

/// Of a simulator with all that it holds, tetrahedra and materials included, after three steps of `seconds`.
double bytes_a_tet(const TetMesh& mesh, double seconds, double poisson_ratio = 0.4) {
  const double before = live_bytes();
  BodyModel model;
  model.name = "body.bar";
  model.materials.assign(mesh.tets.size(), {1e6, poisson_ratio, 1000, 0.1, 0.002});
  model.mesh.lattice = mesh.lattice;
  model.mesh.nodes.assign(mesh.nodes.begin(), mesh.nodes.end());
  model.mesh.tets.assign(mesh.tets.begin(), mesh.tets.end());
  testing::Bench bench(std::move(model));
  for (int k = 1; k <= 3; ++k) EXPECT_TRUE(bench.simulator.step(k, seconds).ok());
  return (live_bytes() - before) / static_cast<double>(mesh.tets.size());
}

TEST(Simulator, TakesAtMostAKilobyteATetrahedronInFloat) {
  if (test::kIsSanitized) GTEST_SKIP() << "its own heap does not tell the C library";
  const TetMesh bar = test_support::make_bar(9), cut = testing::kuhn_bar({48, 12, 12}, Vec3(1, 0.25, 0.25));
  const double of_bar = bytes_a_tet(bar, 1.0 / 96), of_cut = bytes_a_tet(cut, 1.0 / 96);
  EXPECT_LT(of_bar, 1024) << "a lattice";
  EXPECT_LT(of_cut, 1024) << "no lattice: more coarse nodes";
  EXPECT_GT(of_bar, 500) << "the count sees the body";
  EXPECT_LT(bytes_a_tet(bar, 1.0 / 96, 0.49), 1024) << "two sweeps keep two vectors more";
  EXPECT_LT(bytes_a_tet(cut, 1.0 / 96, 0.49), 1024) << "the same without a lattice";
  RecordProperty("bytes", std::to_string(of_bar) + " " + std::to_string(of_cut));
}

TEST(Simulator, TakesAThirdMoreWhereItStepsInDouble) {
  if (test::kIsSanitized) GTEST_SKIP() << "its own heap does not tell the C library";
  // A long step of a stiff, light mesh, which float does not suit.
  const double bytes = bytes_a_tet(test_support::make_bar(9), 1.0 / 8);
  EXPECT_LT(bytes, 1330);
  EXPECT_GT(bytes, 1024) << "so the limit of the test before is not met by chance";
  RecordProperty("bytes", std::to_string(bytes));
}

}  // namespace
}  // namespace softreel
