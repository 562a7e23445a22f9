// The real test surfaces, with the facts that an independent program found.
#include <gtest/gtest.h>

#include "core/mesh/mesh_check.h"
#include "core/mesh/mesh_repair.h"
#include "tests/core/mesh/mesh_files.h"

namespace softreel {
namespace {

struct SharedMesh {
  const char* file;
  std::int64_t vertices, triangles, boundary_edges, non_manifold_edges, pieces, euler;
};

class SharedMeshes : public ::testing::TestWithParam<SharedMesh> {};

TEST_P(SharedMeshes, HaveTheKnownFacts) {
  const SharedMesh& known = GetParam();
  const std::string path = testing::shared_mesh(known.file);
  if (path.empty()) GTEST_SKIP() << "shared/meshes/" << known.file << " is not beside the project";
  SurfaceMesh mesh = import_mesh(path, Log{});
  const MeshFacts facts = check_mesh(mesh);
  EXPECT_EQ(facts.triangles, known.triangles);
  EXPECT_EQ(facts.boundary_edges, known.boundary_edges);
  EXPECT_EQ(facts.non_manifold_edges, known.non_manifold_edges);
  EXPECT_EQ(facts.pieces, known.pieces);
  EXPECT_EQ(facts.distinct_vertices - facts.edges + facts.triangles - facts.collapsed_triangles, known.euler);
  const std::vector<std::string> lines = repair_mesh(mesh);
  const MeshFacts repaired = check_mesh(mesh);
  EXPECT_EQ(repaired.flipped_neighbours, 0);
  if (facts.closed()) {
    EXPECT_GT(repaired.signed_volume, 0);
    EXPECT_EQ(repaired.triangles, facts.triangles);
    EXPECT_EQ(lines.empty(), facts.signed_volume > 0) << lines.size();
  }
}

INSTANTIATE_TEST_SUITE_P(All, SharedMeshes,
                         ::testing::Values(SharedMesh{"armadillo.obj", 43243, 86482, 0, 0, 1, 2},
                                           SharedMesh{"bunny.off", 3485, 6966, 0, 0, 1, 2},
                                           SharedMesh{"bunny_open.obj", 35947, 69451, 223, 0, 1, -3},
                                           SharedMesh{"cheburashka.obj", 6669, 13334, 0, 0, 1, 2},
                                           SharedMesh{"dragon.obj", 50000, 100000, 0, 0, 1, 0},
                                           SharedMesh{"fandisk.obj", 6475, 12946, 0, 0, 1, 2},
                                           SharedMesh{"horse.off", 48485, 96966, 0, 0, 1, 2},
                                           SharedMesh{"spot.obj", 2930, 5856, 0, 0, 1, 2},
                                           SharedMesh{"suzanne.obj", 507, 968, 44, 1, 1, 0},
                                           SharedMesh{"teapot.obj", 3644, 6320, 160, 0, 3, 1}),
                         [](const auto& param_info) {
                           std::string name = param_info.param.file;
                           for (char& c : name)
                             if (c == '.') c = '_';
                           return name;
                         });

}  // namespace
}  // namespace softreel
