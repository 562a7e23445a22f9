/// Keys of lights, surroundings and materials: their values at a frame, and back to the file.
#include "tool/shot/keyed_look.h"

#include <numbers>

#include "tests/tool/shot/shot_files.h"
#include "tool/shot/shot_load.h"

namespace softreel {
namespace {

class KeyedLook : public ShotFiles {
 protected:
  /// A shot of one body and `more`.
  static std::string shot_text(const std::string& more) {
    return "schema = 1\n[body.a]\nmesh = \"a.obj\"\nmaterial = \"m\"\ntets = 100\n[material.m]\n" + more;
  }
};

TEST_F(KeyedLook, LightsFollowTheirKeys) {
  const Shot shot = load(shot_text(R"(
[[light]]
type = "area"
center = [ { frame = 1, value = [0, 2, 0], ease = "linear" }, { frame = 11, value = [10, 2, 0] } ]
aim = [0, 0, 0]
size = [2, 1]
power = [ { frame = 1, value = 8, ease = "linear" }, { frame = 5, value = 16 } ]
[[light]]
type = "sun"
direction = [0, -1, 0]
color = [ { frame = 1, value = [1, 0, 0], ease = "constant" }, { frame = 3, value = [0, 1, 0] } ]
)"));
  EXPECT_TRUE(lights_at(shot, 6).lamps[0].center.isApprox(Vec3f(5, 2, 0)));
  EXPECT_FLOAT_EQ(lights_at(shot, 3).lamps[0].radiance.x(), 12.0f / 8);
  EXPECT_FLOAT_EQ(lights_at(shot, 50).lamps[0].radiance.x(), 2);
  EXPECT_EQ(lights_at(shot, 2).suns[0].irradiance, Vec3f(1, 0, 0));
  EXPECT_EQ(lights_at(shot, 3).suns[0].irradiance, Vec3f(0, 1, 0));
}

TEST_F(KeyedLook, RoundLampsHaveThePowerThatTheyAreGiven) {
  const Shot shot = load(shot_text(R"(
[[light]]
type = "disk"
size = [2, 2]
power = 100
[[light]]
type = "sphere"
center = [1, 2, 3]
radius = 0.5
power = 100
)"));
  const std::vector<AreaLight> lamps = lights_at(shot, 1).lamps;
  EXPECT_EQ(lamps[0].shape, LampShape::Disk);
  EXPECT_NEAR(lamps[0].radiance.x(), 100 / (4 * std::numbers::pi), 1e-4) << "as a rectangle of that area";
  EXPECT_EQ(lamps[1].shape, LampShape::Sphere);
  EXPECT_FLOAT_EQ(lamps[1].u.norm(), 0.5f);
  // What leaves a square metre of it is pi times the radiance.
  EXPECT_NEAR(lamps[1].radiance.x() * std::numbers::pi * std::numbers::pi, 100, 1e-3);
}

TEST_F(KeyedLook, ASkyBringsItsSunAndBothFollowTheKeys) {
  const Shot shot = load(shot_text(R"(
[environment]
strength = 0.5
[environment.sky]
elevation_deg = [ { frame = 1, value = 10, ease = "linear" }, { frame = 11, value = 60 } ]
azimuth_deg = 90
)"));
  EXPECT_NEAR(daylight_at(shot, 6)->elevation, 35 * std::numbers::pi / 180, 1e-6);
  const std::vector<SunLight> suns = lights_at(shot, 6).suns;
  ASSERT_EQ(suns.size(), 1u);
  EXPECT_NEAR(suns[0].direction.x(), -std::cos(35 * std::numbers::pi / 180), 1e-5) << "from the right";
  const Vec3f whole = SkyModel(*daylight_at(shot, 6)).sun_irradiance();
  EXPECT_TRUE(suns[0].irradiance.isApprox(0.5f * whole)) << "as strong as the sky";
  EXPECT_GT(lights_at(shot, 11).suns[0].irradiance.y(), lights_at(shot, 1).suns[0].irradiance.y());
  EXPECT_TRUE(lights_at(load(shot_text("[environment.sky]\nsun = false\n")), 1).suns.empty());
  EXPECT_FALSE(daylight_at(load(shot_text("")), 1).has_value());
  EXPECT_TRUE(daylight_at(load(shot_text("[environment]\nimage = \"a.exr\"\n[environment.sky]\n")), 1).has_value());
}

TEST_F(KeyedLook, MaterialsFollowTheirKeys) {
  const Shot shot = load(shot_text(R"(
roughness = [ { frame = 1, value = 0.2, ease = "linear" }, { frame = 5, value = 0.6 } ]
base_color = [ { frame = 1, value = [1, 0, 0], ease = "linear" }, { frame = 3, value = [0, 0, 1] } ]
metallic = 0.25
)"));
  const MaterialSettings& material = shot.materials.at("m");
  EXPECT_FLOAT_EQ(appearance_at(material, 3).roughness, 0.4f);
  EXPECT_TRUE(appearance_at(material, 2).base_color.isApprox(Vec3f(0.5f, 0, 0.5f)));
  EXPECT_EQ(appearance_at(material, 2).metallic, 0.25f);
  EXPECT_EQ(material.appearance.roughness, 0.2f) << "as at the first key";
}

TEST_F(KeyedLook, IsWrittenAsItWasRead) {
  const Shot shot = load(shot_text(R"(
roughness = [ { frame = 1, value = 0.2, ease = "linear" }, { frame = 5, value = 0.6 } ]
emission = [ { frame = 2, value = [0.1, 0.2, 0.3] }, { frame = 4, value = [1, 2, 3] } ]
[environment]
strength = [ { frame = 1, value = 0.1 }, { frame = 9, value = 1 } ]
[environment.sky]
turbidity = 4
[[light]]
type = "sphere"
power = [ { frame = 1, value = 0 }, { frame = 9, value = 60 } ]
[ground]
shadow_catcher = true
[render]
noise = 0.01
min_samples = 32
time_limit = 20
shutter_opening = 0.25
shutter_closing = 0.5
crop = [0.25, 0, 0.75, 0.5]
overscan = 0.1
)"));
  const std::string text = to_toml(shot);
  const Shot again = load(text);
  EXPECT_EQ(to_toml(again), text);
  for (const double frame : {1.0, 3.3, 20.0}) {
    EXPECT_EQ(appearance_at(again.materials.at("m"), frame).roughness,
              appearance_at(shot.materials.at("m"), frame).roughness);
    EXPECT_EQ(appearance_at(again.materials.at("m"), frame).emission,
              appearance_at(shot.materials.at("m"), frame).emission);
    EXPECT_EQ(environment_at(again, frame).strength, environment_at(shot, frame).strength);
    EXPECT_EQ(lights_at(again, frame).lamps[0].radiance, lights_at(shot, frame).lamps[0].radiance);
  }
  EXPECT_TRUE(again.ground->shadow_catcher);
  EXPECT_EQ(again.render.params.min_samples, 32);
  EXPECT_EQ(again.render.params.window, shot.render.params.window);
}

TEST_F(KeyedLook, CropAndOverscanBecomePixels) {
  const auto window = [](const std::string& more) {
    return load(shot_text("[render]\nwidth = 200\nheight = 100\n" + more)).render.params.window;
  };
  EXPECT_EQ(window(""), PixelWindow{});
  EXPECT_EQ(window("crop = [0.25, 0.1, 0.5, 1]\n"), (PixelWindow{50, 10, 100, 100}));
  EXPECT_EQ(window("overscan = 0.05\n"), (PixelWindow{-10, -5, 210, 105}));
  EXPECT_EQ(window("overscan = 0.05\ncrop = [0, 0, 0.5, 0.5]\n"), (PixelWindow{-10, -5, 110, 55}));
  EXPECT_EQ(window("scale = 2\ncrop = [0.25, 0.1, 0.5, 1]\n"), (PixelWindow{100, 20, 200, 200}));
}

TEST_F(KeyedLook, ScaleKeepsTheAspectOfThePicture) {
  const Shot shot = load(shot_text("[render]\nwidth = 200\nheight = 101\nscale = 0.5\n"));
  EXPECT_EQ(shot.render.params.width, 100);
  EXPECT_EQ(shot.render.params.height, 51) << "rounded";
  const RenderParams again = load(to_toml(shot)).render.params;
  EXPECT_EQ(again.width, 100) << "not scaled twice";
  EXPECT_EQ(again.height, 51);
  EXPECT_EQ(load(shot_text("")).render.params.width, RenderSettings{}.width) << "without a table of the picture";
}

TEST_F(KeyedLook, SaysWhatIsWrong) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases{
      {"[[light]]\ntype = \"sphere\"\naim = [0, 1, 0]\n", {"light[0].aim", "a sphere has no such field"}},
      {"[[light]]\ntype = \"area\"\nradius = 1\n", {"light[0].radius", "an area light has no such field", "sphere"}},
      {"[[light]]\ntype = \"disk\"\ncenter = [{frame=1,value=[0,1,0]},{frame=2,value=[0,0,0]}]\n",
       {"aims at its own center"}},
      {"[environment.sky]\nelevation_deg = -5\n", {"environment.sky.elevation_deg", "0 to 90"}},
      {"[render]\nmin_samples = 20\n", {"render.min_samples", "multiple of 8"}},
      {"[render]\nshutter_opening = 0.6\nshutter_closing = 0.6\n", {"render.shutter_closing", "at most 1"}},
      {"[render]\ncrop = [0.5, 0, 0.2, 1]\n", {"render.crop", "no pixel"}},
      {"[render]\ncrop = [0.6, 0, 0.5, 1]\noverscan = 0.1\n", {"render.crop", "no pixel"}},
      {"[render]\nwidth = 32768\noverscan = 1\n", {"render.overscan", "98304"}},
      {"[camera]\nposition = [0, 1, 4]\n", {"camera", "needs a target"}},
      {"[render]\nwidth = 20000\nscale = 2\n", {"render.scale = 2", "40000 x 1080 pixels", "1 to 32768"}},
      {"[material.n]\nroughness = [{frame=1,value=2}]\n", {"roughness", "0 to 1"}},
      {"[material.n]\nemission = [{frame=1,value=[1e39,0,0]}]\n", {"emission", "out of range"}},
  };
  for (const auto& [text, parts] : cases) {
    const std::string said = message(shot_text(text));
    for (const std::string& part : parts) EXPECT_NE(said.find(part), std::string::npos) << text << said;
  }
}

TEST_F(KeyedLook, KeysThatMeetBetweenTwoKeysAreAnErrorOfThatFrame) {
  const Shot shot = load(shot_text(R"(
[[light]]
type = "area"
aim = [0, 0, 0]
center = [ { frame = 1, value = [-1, 0, 0], ease = "linear" }, { frame = 3, value = [1, 0, 0] } ]
)"));
  EXPECT_NO_THROW(lights_at(shot, 1.5));
  EXPECT_THROW(lights_at(shot, 2), Error);
}

}  // namespace
}  // namespace softreel
