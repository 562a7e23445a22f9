// What writers of long files hold: a sample, not the file.
#include "tests/support/peak_memory.h"
#include "tests/tool/export/format_runs.h"

namespace softreel {
namespace {

/// A sheet of n x n quads.
SurfaceMesh sheet(int n) {
  SurfaceMesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) mesh.positions.emplace_back(0.1 * x, 0.1 * y, 0.01 * x * y);
  const auto corner = [n](int x, int y) { return static_cast<Index>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      for (const Index v : {corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)})
        mesh.polygons.corner_vertices.push_back(v);
      mesh.polygons.offsets.push_back(static_cast<Index>(mesh.polygons.corner_vertices.size()));
    }
  triangulate_polygons(mesh);
  return mesh;
}

TEST(Streaming, MemoryOfAWriterDoesNotGrowWithTheSamples) {
  if (test::kIsSanitized) GTEST_SKIP() << "a sanitizer keeps what was given back";
  const SurfaceMesh mesh = sheet(140);
  const std::vector<Vec3> normals = vertex_normals(mesh, mesh.positions);
  for (const char* format : {"pc2", "mdd", "glb", "usda"}) {
    SCOPED_TRACE(format);
    testing::FormatRun run(format);
    run.add_body("sheet", mesh);
    run.target().settings.normals = find_export_format(format).has_normals;
    run.target().times = {0, 1, 100};
    std::uint64_t size = 0;
    run.target().sink = [&size](std::span<const std::uint8_t> bytes) { size += bytes.size(); };
    const auto append = [&](int s) {
      run.append(s, testing::moved(mesh.positions, s), run.target().settings.normals ? normals : std::vector<Vec3>{});
    };
    for (int s = 0; s < 5; ++s) append(s);
    test::reset_peak_memory();
    const std::int64_t before = test::peak_memory();
    ASSERT_GT(before, 0);
    for (int s = 5; s < 100; ++s) append(s);
    run.finish();
    EXPECT_GT(size, 20'000'000U);
    EXPECT_LT(test::peak_memory() - before, 6'000'000) << "of a file of " << size << " bytes";
  }
}

}  // namespace
}  // namespace softreel
