// MDD and PC2 point caches, read back by a reader of their own.
#include <limits>

#include "tests/tool/export/format_runs.h"
#include "tests/tool/export/readers/point_cache_reader.h"

namespace softreel {
namespace {

TEST(MddExport, HoldsTheNearestFloatOfEveryCoordinateAndTheTimes) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("mdd");
  run.add_body("cloth", mesh);
  run.target().times = {10, 2, 5};
  run.target().settings.fps = 25;
  for (int s = 0; s < 5; ++s) run.append(10 + 0.5 * s, testing::moved(mesh.positions, s));
  const testing::PointCache cache = testing::read_mdd(run.finish());
  EXPECT_EQ(cache.points, 9);
  ASSERT_EQ(cache.samples.size(), 5U);
  for (int s = 0; s < 5; ++s) {
    testing::expect_same_floats(cache.samples[static_cast<std::size_t>(s)],
                                testing::floats_of(testing::moved(mesh.positions, s)));
    EXPECT_EQ(cache.times[static_cast<std::size_t>(s)], static_cast<float>((10 + 0.5 * s) / 25));
  }
}

TEST(MddExport, PassesOnEachSampleWhenItComes) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("mdd");
  run.add_body("cloth", mesh);
  run.target().times = {1, 1, 3};
  run.begin();
  EXPECT_EQ(run.bytes_so_far(), 8U + 3 * 4);
  for (std::size_t s = 1; s <= 3; ++s) {
    run.append(static_cast<double>(s), mesh.positions);
    EXPECT_EQ(run.bytes_so_far(), 20 + s * 9 * 12);
  }
}

TEST(PointCaches, RefuseNumbersThatReadersWouldShowAsGarbage) {
  const SurfaceMesh mesh = testing::patchwork();
  for (const char* format : {"pc2", "mdd", "glb", "usda"})
    for (const double bad : {1e39, std::numeric_limits<double>::quiet_NaN()}) {
      testing::FormatRun run(format);
      run.add_body("cloth", mesh);
      std::vector<Vec3> positions = mesh.positions;
      positions[4].y() = bad;
      const std::string message = testing::error_of([&] { run.append(1, positions); });
      EXPECT_NE(message.find("vertex 5"), std::string::npos) << format << ": " << message;
      EXPECT_NE(message.find("Accepted"), std::string::npos) << format << ": " << message;
    }
}

TEST(MddExport, RefusesTimesThatFloatsDoNotHold) {
  const SurfaceMesh mesh = testing::patchwork();
  const auto message = [&](const SampleTimes& times, double fps) {
    testing::FormatRun run("mdd");
    run.add_body("cloth", mesh);
    run.target().times = times;
    run.target().settings.fps = fps;
    return testing::error_of([&] { run.begin(); });
  };
  for (const std::string& text : {message({1e6, 100, 3}, 24), message({1, 1, 1}, 1e-300)}) {
    EXPECT_NE(text.find("float32"), std::string::npos) << text;
    EXPECT_NE(text.find("Accepted"), std::string::npos) << text;
  }
  EXPECT_EQ(message({-3, 1, 5}, 24), "");
}

TEST(TextureCoordinates, AreRefusedWhereTheFileCannotSayThem) {
  for (const char* format : {"glb", "usda", "obj", "ply"})
    for (const double bad : {1e39, std::numeric_limits<double>::quiet_NaN()}) {
      SurfaceMesh mesh = testing::patchwork();
      mesh.texture_coordinates[2].y() = bad;
      testing::FormatRun run(format);
      run.add_body("cloth", mesh);
      const std::string message = testing::error_of([&] { run.begin(); });
      if (bad == 1e39 && (format[0] == 'o' || format[0] == 'p')) {
        EXPECT_EQ(message, "") << format << " holds doubles";
        continue;
      }
      EXPECT_NE(message.find("texture coordinate 3"), std::string::npos) << format << ": " << message;
      EXPECT_NE(message.find("Accepted"), std::string::npos) << format << ": " << message;
    }
}

TEST(Pc2Export, SaysHowFarApartItsSamplesAre) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("pc2");
  run.add_body("cloth", mesh);
  run.target().times = {7, 4, 2};
  run.append(7, mesh.positions);
  run.append(7.25, mesh.positions);
  const testing::PointCache cache = testing::read_pc2(run.finish());
  EXPECT_EQ(cache.start_frame, 7.0F);
  EXPECT_EQ(cache.frames_apart, 0.25F);
  EXPECT_EQ(cache.samples.size(), 2U);
}

}  // namespace
}  // namespace softreel
