// GLB, read back by a reader written from the specification.
#include <cmath>
#include <random>

#include "tests/tool/export/format_runs.h"
#include "tests/tool/export/readers/glb_reader.h"

namespace softreel {
namespace {

using testing::GlbScene;

/// The largest distance between what a scene shows and the positions, over the size of the numbers that it is made of.
double worst_error(const std::vector<float>& shown, const std::vector<Vec3>& positions, const std::vector<Vec3>& rest) {
  double worst = 0;
  for (std::size_t v = 0; v < positions.size(); ++v)
    for (int k = 0; k < 3; ++k) {
      const double size = std::abs(positions[v][k]) + std::abs(rest[v][k]);
      const float exact = static_cast<float>(positions[v][k]);
      if (size > 0)
        worst = std::max(worst, std::abs(double{shown[3 * v + static_cast<std::size_t>(k)]} - exact) / size);
    }
  return worst;
}

TEST(GlbExport, ShowsEachSampleAtItsTimeAndTheFilesVerticesFirst) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("glb");
  run.add_body("cloth", mesh);
  run.target().times = {3, 2, 5};
  run.target().settings.fps = 10;
  for (int s = 0; s < 5; ++s) run.append(3 + 0.5 * s, testing::moved(mesh.positions, s));
  const GlbScene scene = testing::read_glb(run.finish());
  EXPECT_EQ(scene.mesh_name, "cloth");
  testing::expect_same_floats(scene.positions, testing::floats_of(mesh.positions));
  EXPECT_GT(scene.positions.size(), 3 * mesh.positions.size()) << "no duplicates at seams";
  for (int s = 0; s < 5; ++s) {
    EXPECT_EQ(scene.times[static_cast<std::size_t>(s)], static_cast<float>(0.5 * s / 10)) << "a clip begins at 0";
    EXPECT_LE(worst_error(scene.positions_at(0.5 * s / 10), testing::moved(mesh.positions, s), mesh.positions), 1.2e-7);
  }
}

TEST(GlbExport, TakesNamesOfAnyBytes) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("glb");
  run.add_body("cloth", mesh);
  run.target().shot = "caf\xe9";
  run.append(1, mesh.positions);
  EXPECT_EQ(testing::read_glb(run.finish()).mesh_name, "cloth");
}

TEST(GlbExport, DuplicatesMoveWithTheirOriginalsAndHaveTheirOwnCoordinates) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("glb");
  run.add_body("cloth", mesh);
  run.append(1, testing::moved(mesh.positions, 4));
  const GlbScene scene = testing::read_glb(run.finish());
  const std::vector<float> shown = scene.positions_at(1.0 / 24);
  ASSERT_EQ(scene.indices.size(), 3 * mesh.triangles.size());
  for (std::size_t c = 0; c < scene.indices.size(); ++c) {
    const std::size_t vertex = scene.indices[c];
    const auto original = static_cast<std::size_t>(mesh.triangles[c / 3][c % 3]);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(shown[3 * vertex + k], shown[3 * original + k]);
    const Vec2 at = mesh.texture_coordinates[static_cast<std::size_t>(mesh.triangle_textures[c / 3][c % 3])];
    EXPECT_EQ(scene.textures[2 * vertex], static_cast<float>(at.x()));
    EXPECT_NEAR(scene.textures[2 * vertex + 1], 1 - at.y(), 1e-7) << "glTF counts from the top";
  }
}

TEST(GlbExport, BlendsLinearlyBetweenSamples) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("glb");
  run.add_body("cloth", mesh);
  run.target().times = {0, 1, 2};
  run.target().settings.fps = 1;
  const std::vector<Vec3> start = testing::moved(mesh.positions, 1), end = testing::moved(mesh.positions, 5);
  run.append(0, start);
  run.append(1, end);
  const std::vector<float> shown = testing::read_glb(run.finish()).positions_at(0.25);
  for (std::size_t v = 0; v < start.size(); ++v)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(shown[3 * v + static_cast<std::size_t>(k)], 0.75 * start[v][k] + 0.25 * end[v][k], 2e-6);
}

TEST(GlbExport, PositionsAreExactWhereverAFloatDifferenceCanGiveThem) {
  // All of a body far from the origin that moves by less than its distance, as nearly every body does.
  SurfaceMesh mesh = testing::unit_box();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(1, 2), way(-0.5, 0.5);
  for (Vec3& p : mesh.positions) p = Vec3(place(random), place(random), place(random));
  testing::FormatRun run("glb");
  run.add_body("box", mesh);
  run.target().times = {0, 1, 50};
  std::vector<std::vector<Vec3>> samples;
  for (int s = 0; s < 50; ++s) {
    samples.push_back(mesh.positions);
    for (Vec3& p : samples.back()) p += Vec3(way(random), way(random), way(random));
    run.append(s, samples.back());
  }
  const GlbScene scene = testing::read_glb(run.finish());
  for (std::size_t s = 0; s < 50; ++s)
    testing::expect_same_floats(scene.positions_at(scene.times[s]), testing::floats_of(samples[s]));
}

TEST(GlbExport, NormalsHaveUnitLengthAtRestAndAtSamples) {
  SurfaceMesh mesh = testing::unit_box();
  testing::FormatRun run("glb");
  run.add_body("box", mesh);
  run.target().settings.normals = true;
  run.target().times = {0, 1, 3};
  std::vector<std::vector<Vec3>> normals;
  for (int s = 0; s < 3; ++s) {
    normals.push_back(vertex_normals(mesh, testing::moved(mesh.positions, s)));
    run.append(s, testing::moved(mesh.positions, s), normals.back());
  }
  const GlbScene scene = testing::read_glb(run.finish());
  const auto expect_units = [](const std::vector<float>& values) {
    for (std::size_t v = 0; v < values.size(); v += 3)
      EXPECT_NEAR(Vec3f(values[v], values[v + 1], values[v + 2]).norm(), 1, 1e-6);
  };
  expect_units(scene.normals);
  for (int s = 0; s < 3; ++s) {
    const std::vector<float> shown = scene.normals_at(scene.times[static_cast<std::size_t>(s)]);
    expect_units(shown);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(shown[3 * v + static_cast<std::size_t>(k)], normals[static_cast<std::size_t>(s)][v][k], 1e-6);
  }
}

TEST(GlbExport, TheNodeCarriesThePlacementAndTheMaterialItsLook) {
  const SurfaceMesh mesh = testing::unit_box();
  testing::FormatRun run("glb");
  run.add_body("box", mesh);
  ExportBody& body = run.target().bodies[0];
  const Mat3 turn = Eigen::AngleAxisd(1.9, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  body.transform = {0.3 * turn, Vec3(1, -2, 5)};
  body.appearance.base_color = Vec3f(0.1F, 0.5F, 0.9F);
  body.appearance.metallic = 0.25F;
  body.appearance.roughness = 0.75F;
  run.append(1, mesh.positions);
  const GlbScene scene = testing::read_glb(run.finish());
  const Quaternion rotation(scene.rotation[3], scene.rotation[0], scene.rotation[1], scene.rotation[2]);
  EXPECT_NEAR(rotation.norm(), 1, 1e-12);
  for (const Vec3& p : mesh.positions) {
    const Vec3 scaled = scene.scale[0] * p;
    const Vec3 placed = rotation * scaled + Vec3(scene.translation[0], scene.translation[1], scene.translation[2]);
    EXPECT_NEAR((placed - body.transform(p)).norm(), 0, 1e-12);
  }
  EXPECT_EQ(scene.material_name, "stuff");
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(static_cast<float>(scene.base_color[k]), body.appearance.base_color[static_cast<Index>(k)]);
  EXPECT_EQ(scene.metallic, 0.25);
  EXPECT_EQ(scene.roughness, 0.75);
}

TEST(GlbExport, GivesTheSinkNothingBeforeItKnowsTheHeader) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("glb");
  run.add_body("cloth", mesh);
  run.target().times = {1, 1, 20};
  for (int s = 0; s < 20; ++s) {
    run.append(1 + s, mesh.positions);
    EXPECT_EQ(run.bytes_so_far(), 0U);
  }
  testing::read_glb(run.finish());
}

TEST(GlbExport, RefusesWhatItsFormatCannotSay) {
  const SurfaceMesh mesh = testing::patchwork();
  const auto message = [&](const SampleTimes& times, double fps) {
    testing::FormatRun run("glb");
    run.add_body("cloth", mesh);
    run.target().times = times;
    run.target().settings.fps = fps;
    return testing::error_of([&] { run.begin(); });
  };
  EXPECT_NE(message({1, 1, 40000}, 24).find("4 GiB"), std::string::npos);
  EXPECT_NE(message({1, 1, 3}, 1e300).find("float32"), std::string::npos);
  EXPECT_EQ(message({-3, 1, 5}, 24), "");
  EXPECT_EQ(message({1e6, 100, 3}, 24), "");
}

}  // namespace
}  // namespace softreel
