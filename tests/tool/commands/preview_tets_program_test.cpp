/// softreel preview of the tetrahedra behind a cut, through the built program.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "render/image/image_io.h"
#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

class PreviewTets : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = shot_folder("preview_tets");
    const Outcome outcome = preview("--mode fast");
    if (has_no_egl(outcome)) GTEST_SKIP() << outcome.err;
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }
  Outcome preview(const std::string& options) const {
    return run(
        fmt::format("softreel preview {0}/shot.toml --frames 2 --output {0}/out --json --quiet --gizmos none --set "
                    "render.width=320 --set render.height=180 --set body.ball.tets=1500 {1}",
                    folder_, options));
  }
  int written(const std::string& options) const {
    const Outcome outcome = preview(options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.status == 0 ? json::parse(outcome.out)["files"]["written"].get<int>() : -1;
  }
  /// Pixels that are sand coloured, as good elements at a cut are, and clearly blue, as the boundary is.
  struct Colors {
    int sand = 0, blue = 0;
  };
  Colors colors() const {
    const DisplayImage image = read_png(folder_ + "/out/ball.preview.0002.png");
    Colors colors;
    for (std::size_t k = 0; k < image.pixels.size(); k += 3) {
      const int r = image.pixels[k], g = image.pixels[k + 1], b = image.pixels[k + 2];
      colors.sand += r > g + 20 && g > b + 20 ? 1 : 0;
      colors.blue += b > r + 50 ? 1 : 0;
    }
    return colors;
  }
  std::string folder_;
};

TEST_F(PreviewTets, AreSandWhereTheCutFacesTheCameraAndBlueOutside) {
  EXPECT_EQ(colors().sand, 0) << "the surface";
  EXPECT_EQ(written("--mode fast --kind tets"), 1);
  const Colors middle = colors();
  EXPECT_GT(middle.sand, 400) << "the plane in the middle looks to the camera";
  EXPECT_EQ(written("--mode fast --kind tets"), 0);
  EXPECT_EQ(written("--mode fast --cut -z"), 1) << "tets because of the cut";
  const Colors behind = colors();
  EXPECT_EQ(behind.sand, 0) << "the cut looks away";
  EXPECT_GT(behind.blue, middle.blue + 1000);
  EXPECT_EQ(written("--mode fast --cut -z --set render.heat=strain"), 1);
  EXPECT_LT(colors().blue, behind.blue / 2) << "in the colours of the strain";
  EXPECT_EQ(written("--mode fast"), 1) << "the surface again";
}

TEST_F(PreviewTets, RefuseNoPlaneAndPlanesOfSurfaces) {
  const auto expect_refused = [&](const std::string& options, const std::vector<std::string>& parts) {
    const Outcome outcome = preview(options);
    EXPECT_EQ(outcome.status, 2) << options;
    for (const std::string& part : parts) EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  };
  expect_refused("--cut w=0.5", {"--cut w=0.5", "Accepted", "x=0.3"});
  expect_refused("--cut x --kind surface", {"--cut x", "Accepted", "--kind tets"});
  expect_refused("--cut x=0", {"--cut x=0", "Accepted", "Move it"});
  expect_refused("--kind cells", {"cells", "tets"});
}

}  // namespace
}  // namespace softreel
