#include "tool/report/cut_picture.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace softreel {
namespace {

Bounds box_between(const Vec3& min, const Vec3& max) {
  Bounds box;
  box.add(min);
  box.add(max);
  return box;
}

const Bounds kBox = box_between(Vec3(-1, 0, 2), Vec3(3, 5, 4));
const Vec3 kCenter(1.5, 2, 2.75);

std::string message_of(const std::string& cut) {
  try {
    cut_plane(cut, kBox, kCenter);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    return error.what();
  }
  return "";
}

TEST(CutPlane, GoesThroughTheCentreOfMassAcrossTheShorterHorizontalExtent) {
  const CutPlane plane = cut_plane("", kBox, kCenter);
  EXPECT_EQ(plane.normal, Vec3(0, 0, 1));
  EXPECT_EQ(plane.point, kCenter);
  EXPECT_EQ(cut_plane("", box_between(Vec3(0, 0, 0), Vec3(1, 0.5, 2)), kCenter).normal, Vec3(1, 0, 0));
}

TEST(CutPlane, LiesAtAShareOfTheBoxAndFacesEitherWay) {
  EXPECT_EQ(cut_plane("y=0.2", kBox, kCenter).point.y(), 1);
  EXPECT_EQ(cut_plane("y=0.2", kBox, kCenter).normal, Vec3(0, 1, 0));
  EXPECT_EQ(cut_plane("-x=0.25", kBox, kCenter).point.x(), 0);
  EXPECT_EQ(cut_plane("-x=0.25", kBox, kCenter).normal, Vec3(-1, 0, 0));
  EXPECT_EQ(cut_plane("z", kBox, kCenter).point.z(), 2.75);
}

TEST(CutPlane, IsAPointAndADirection) {
  const CutPlane plane = cut_plane("1,-2.5,3e-1:0,1,1", kBox, kCenter);
  EXPECT_EQ(plane.point, Vec3(1, -2.5, 0.3));
  EXPECT_EQ(plane.normal, Vec3(0, 1, 1));
}

TEST(CutPlane, RefusesWhatIsNoneAndSaysWhatIs) {
  for (const char* cut : {"w", "-", "x=", "x=1.5", "x=-0.1", "x=nan", "x0.5", "xy", "1,2,3", "1,2:0,0,1", "1,2,3:0,0,0",
                          "1,2,3:0,0,1,", "1,2,3:0,0,inf", "1,2,3:0,0,1:2", " x"}) {
    const std::string message = message_of(cut);
    for (const std::string& part : {"--cut " + std::string(cut), std::string("Accepted"), std::string("x=0.3")})
      EXPECT_NE(message.find(part), std::string::npos) << cut << ": " << message;
  }
}

TEST(PictureSize, IsTwoNumbersOfPixels) {
  const PictureSize size = parse_picture_size("320x200");
  EXPECT_EQ(size.width, 320);
  EXPECT_EQ(size.height, 200);
  for (const char* text : {"", "320", "320x", "x200", "320x200x1", "320 x 200", "8x200", "320x9000", "-320x200"}) {
    try {
      parse_picture_size(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("--picture-size " + std::string(text)), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("1600x1200"), std::string::npos);
    }
  }
}

TEST(StudioPlace, StandsTheBoxOnTheGroundWithDiagonalOne) {
  const Bounds far = box_between(Vec3(1e6, 2e6, -1e6), Vec3(1e6 + 3e-3, 2e6 + 4e-3, -1e6 + 12e-3));
  const StudioPlace place(far);
  const Vec3f low = place(far.min), high = place(far.max);
  EXPECT_EQ(low.y(), 0);
  EXPECT_NEAR((high - low).norm(), 1, 1e-5);
  EXPECT_NEAR(low.x() + high.x(), 0, 1e-5);
  EXPECT_NEAR(low.z() + high.z(), 0, 1e-5);
}

}  // namespace
}  // namespace softreel
