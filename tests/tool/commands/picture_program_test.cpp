/// --picture of tetrahedralize and inspect, through the built program.
#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "render/image/image_io.h"
#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;

constexpr const char* kCreature = "'" SOFTREEL_SOURCE_DIR "/assets/creature.ply'";

/// Decodes, and holds more than one colour.
void expect_picture(const std::string& path, int width, int height) {
  ASSERT_TRUE(exists(path)) << path;
  const DisplayImage image = read_png(path);
  EXPECT_EQ(image.width, width);
  EXPECT_EQ(image.height, height);
  const auto [least, most] = std::minmax_element(image.pixels.begin(), image.pixels.end());
  EXPECT_GT(*most - *least, 100);
}

TEST(Picture, OfTetrahedraHasTheSameBitsOnOneAndTwoThreads) {
  const std::string folder = new_folder("picture");
  for (const int threads : {1, 2}) {
    const Outcome outcome =
        run(fmt::format("softreel tetrahedralize {0} -o {1}/tets.vtu --tets 3000 --quiet --threads {2} --picture "
                        "{1}/of_{2}.png --picture-size 160x120",
                        kCreature, folder, threads));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find(fmt::format("of_{}.png: ", threads)), std::string::npos) << outcome.out;
    expect_picture(fmt::format("{}/of_{}.png", folder, threads), 160, 120);
  }
  EXPECT_EQ(read_text(folder + "/of_1.png"), read_text(folder + "/of_2.png"));
  // The file of tetrahedra gives the same picture as the tetrahedra that went into it.
  const Outcome again =
      run(fmt::format("softreel inspect {0}/tets.vtu --picture {0}/again.png --picture-size 160x120 --json", folder));
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.out.front(), '{');
  EXPECT_EQ(read_text(folder + "/again.png"), read_text(folder + "/of_1.png"));
  const Outcome other = run(
      fmt::format("softreel inspect {0}/tets.vtu --picture {0}/other.png --picture-size 160x120 --cut -x=0.4", folder));
  ASSERT_EQ(other.status, 0) << other.err;
  EXPECT_NE(read_text(folder + "/other.png"), read_text(folder + "/of_1.png"));
}

TEST(Picture, OfASurface) {
  const std::string folder = new_folder("picture_surface");
  const Outcome outcome =
      run(fmt::format("softreel inspect {} --picture {}/new/surface.png --picture-size 160x120", kCreature, folder));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("no damage"), std::string::npos) << outcome.out;
  expect_picture(folder + "/new/surface.png", 160, 120);
}

TEST(Picture, ThatCannotBeWrittenLeavesNothing) {
  const std::string folder = shot_folder("picture_refused");
  const Outcome outcome =
      run(fmt::format("softreel inspect {0}/sphere.obj --picture {0}/sphere.obj/a.png --picture-size 16x16", folder));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("sphere.obj"), std::string::npos) << outcome.err;
  const Outcome refused = run(fmt::format(
      "softreel tetrahedralize {0}/sphere.obj -o {0}/a.vtu --tets 500 --cut x=0 --picture {0}/a.png --quiet", folder));
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("no element lies behind the plane"), std::string::npos) << refused.err;
  EXPECT_FALSE(exists(folder + "/a.png"));
}

}  // namespace
}  // namespace softreel
