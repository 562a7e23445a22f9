/// Files of an older state of a shot: removed under the names that a run makes, said where they stay beside them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class Leftovers : public ::testing::Test {
 protected:
  Outcome run_shot(const std::string& command, const std::string& options) const {
    return run(fmt::format("softreel {1} {0}/shot.toml --output {0}/out {2}", folder_, command, options));
  }
  std::string file(const std::string& name) const { return folder_ + "/out/" + name; }

  const std::string folder_ = shot_folder("leftovers");
  /// Another simulation of the same shot.
  const std::string softer_ = "--set material.soft.youngs_modulus=1e4 ";
};

TEST_F(Leftovers, ARenderSaysThatItRemovesMovieAndSheetAndMakesNoMovieOfSomeFrames) {
  const std::string both = "--set output.movie=true --set output.contact_sheet=true ";
  ASSERT_EQ(run_shot("render", both).status, 0);
  const Outcome some = run_shot("render", "--set output.movie=true --frames 1 --set output.exposure=1");
  EXPECT_EQ(some.status, 0) << some.err;
  for (const char* name : {"ball.mp4", "ball.sheet.png"}) {
    EXPECT_FALSE(exists(file(name)));
    EXPECT_TRUE(says(some.err, file(name) + " removed: it is of other pictures")) << some.err;
  }
  EXPECT_TRUE(says(some.err, "no movie: it is made when all frames, 1 to 4, are asked for")) << some.err;
}

TEST_F(Leftovers, AShorterShotRemovesTheKnownPicturesOfFramesThatItNoLongerHas) {
  ASSERT_EQ(run_shot("render", "--set output.exr=true").status, 0);
  const std::string strange = file("ball.0007.png"), shorter = "--set shot.frames=[1,2] ";
  write_text(strange, "not ours");
  EXPECT_EQ(run_shot("render", shorter + "--frames 1").status, 0);
  EXPECT_TRUE(exists(file("ball.0003.png"))) << "some frames were asked for";
  const Outcome whole = run_shot("render", shorter);
  EXPECT_EQ(whole.status, 0) << whole.err;
  EXPECT_TRUE(says(whole.err, "4 outdated pictures removed: they are of frames that the shot no longer has"))
      << whole.err;
  for (const char* gone : {"ball.0003.png", "ball.0004.png", "ball.0003.exr", "ball.0004.exr"})
    EXPECT_FALSE(exists(file(gone))) << gone;
  EXPECT_TRUE(exists(file("ball.0002.png")));
  EXPECT_TRUE(exists(strange)) << "nobody knows it";
  EXPECT_FALSE(says(run_shot("render", shorter).err, "no longer has"));
}

TEST_F(Leftovers, ARenderRemovesOlderPicturesOfAKindThatItNoLongerMakes) {
  const std::string movie = "--set output.movie=true ", exrs = "--set output.exr=true ";
  ASSERT_EQ(run_shot("render", exrs).status, 0);
  EXPECT_EQ(run_shot("render", "").status, 0);
  EXPECT_TRUE(exists(file("ball.0001.exr"))) << "it is of the shot as it is";
  const Outcome pngs = run_shot("render", movie + softer_);
  EXPECT_EQ(pngs.status, 0) << pngs.err;
  EXPECT_FALSE(exists(file("ball.0004.exr")));
  EXPECT_TRUE(exists(file("ball.mp4")));
  const Outcome others = run_shot("render", movie + exrs + "--set output.png=false");
  EXPECT_EQ(others.status, 0) << others.err;
  for (const char* gone : {"ball.0004.png", "ball.mp4"}) EXPECT_FALSE(exists(file(gone))) << gone;
  EXPECT_TRUE(exists(file("ball.0004.exr")));
}

TEST_F(Leftovers, ARenderOfExrsSaysThatThereIsNoMovie) {
  const Outcome outcome =
      run_shot("render", "--frames 1 --set output.png=false --set output.exr=true --set output.movie=true");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(says(outcome.err, "no movie: it is made of PNG pictures")) << outcome.err;
}

TEST_F(Leftovers, AnExportOfSomeFramesWarnsOfOlderOnesBesideThem) {
  const Outcome all = run_shot("export", "");
  ASSERT_EQ(all.status, 0) << all.err;
  const Outcome same = run_shot("export", "--frames 2 --quiet");
  EXPECT_EQ(same.err, "") << "frames of the same state are no leftovers";
  const Outcome some = run_shot("export", softer_ + "--frames 1-2");
  EXPECT_EQ(some.status, 0) << some.err;
  EXPECT_TRUE(says(some.err, "outdated files removed")) << some.err;
  EXPECT_TRUE(says(some.err, file("ball.ball.0003.obj") + ": this and 1 more files are of an older state")) << some.err;
  EXPECT_FALSE(says(run_shot("export", softer_).err, "older state"));
}

TEST_F(Leftovers, AnExportWarnsOfSubFramesThatItDoesNotMake) {
  ASSERT_EQ(run_shot("export", "--frames 1-2 --subframes 1").status, 0);
  const Outcome plain = run_shot("export", "--frames 1-2 --quiet");
  EXPECT_EQ(plain.status, 0) << plain.err;
  EXPECT_TRUE(says(plain.err, "this and 2 more files are of an older state of the shot or of other sub-frames"))
      << plain.err;
}

TEST_F(Leftovers, APreviewOfSomeFramesRemovesTheirMovieAndWarnsOfOlderOnes) {
  const std::string fast = "--mode fast --set output.movie=true ";
  const Outcome all = run_shot("preview", fast);
  if (has_no_egl(all)) GTEST_SKIP() << all.err;
  ASSERT_EQ(all.status, 0) << all.err;
  const Outcome some = run_shot("preview", fast + "--frames 1 --set output.exposure=1");
  EXPECT_EQ(some.status, 0) << some.err;
  EXPECT_TRUE(says(some.err, "1 outdated pictures removed")) << some.err;
  EXPECT_TRUE(says(some.err, file("ball.preview.mp4") + " removed: it is of other pictures")) << some.err;
  EXPECT_FALSE(exists(file("ball.preview.mp4")));
  EXPECT_TRUE(says(some.err, file("ball.preview.0002.png") + ": this and 2 more pictures are of an older")) << some.err;
}

}  // namespace
}  // namespace softreel
