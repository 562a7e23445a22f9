/// Pictures of meshes in a build without the path tracer.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tool/report/cut_picture.h"

namespace softreel {
namespace {

TEST(CheckPicture, NamesTheOptionThatBuildsThePathTracer) {
  PictureOptions options;
  check_cut_picture(options);  // no picture is asked for
  options.path = "a.png";
  try {
    check_cut_picture(options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    EXPECT_NE(std::string(error.what()).find("SOFTREEL_WITH_EMBREE=ON"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace softreel
