/// Which fields are said to have no effect, and that those which have one are not.
#include "tool/shot/unused_fields.h"

#include <gtest/gtest.h>

namespace softreel {
namespace {

std::string said(const Shot& shot) {
  std::string all;
  for (const std::string& line : find_unused_fields(shot)) all += line + "\n";
  return all;
}

bool says(const Shot& shot, const std::string& field) {
  return said(shot).find(" " + field + " has no effect") != std::string::npos;
}

TEST(UnusedFields, OfADefaultShotAreNone) {
  Shot shot;
  EXPECT_EQ(said(shot), "");
  shot.settings.mode = SimulationMode::Static;
  EXPECT_EQ(said(shot), "");
}

TEST(UnusedFields, DependOnTheMode) {
  Shot shot;
  shot.path = "a.toml";
  shot.settings.start = StartState::Equilibrium;
  shot.settings.preroll = 3;
  shot.settings.independent = true;
  shot.solver.step_error = 1e-3;
  EXPECT_EQ(said(shot),
            "a.toml: shot.independent has no effect: it is of static shots, and shot.mode = \"dynamic\".\n");
  shot.settings.mode = SimulationMode::Static;
  for (const char* field : {"shot.start", "solver.step_error", "shot.preroll"}) EXPECT_TRUE(says(shot, field));
  EXPECT_FALSE(says(shot, "shot.independent"));
  shot.settings.independent = false;
  EXPECT_FALSE(says(shot, "shot.preroll")) << "balances may be several, and each frame begins at the one before";
}

TEST(UnusedFields, DependOnTheIntegrator) {
  Shot shot;
  shot.solver.newmark = {0.3, 0.6};
  shot.solver.integrator = Integrator::Euler;
  EXPECT_TRUE(says(shot, "solver.newmark_beta") && says(shot, "solver.newmark_gamma"));
  shot.solver.integrator = Integrator::Newmark;
  EXPECT_EQ(said(shot), "");
}

TEST(UnusedFields, DependOnTheCamera) {
  Shot shot;
  shot.camera.margin = 2;
  shot.camera.azimuth_deg = 80;
  EXPECT_EQ(said(shot), "");
  shot.camera.position = shot.camera.target = constant_track(Vec3(1, 2, 3));
  EXPECT_TRUE(says(shot, "camera.position") && says(shot, "camera.target") && !says(shot, "camera.margin"));
  shot.camera.mode = CameraMode::Place;
  EXPECT_TRUE(says(shot, "camera.margin") && says(shot, "camera.azimuth_deg") && !says(shot, "camera.position"));
  shot.camera.focus_distance = constant_track(2.0);
  EXPECT_TRUE(says(shot, "camera.focus_distance"));
  shot.camera.f_number = 4;
  EXPECT_FALSE(says(shot, "camera.focus_distance"));
}

TEST(UnusedFields, DependOnWhatSurroundsTheScene) {
  Shot shot;
  shot.environment.zenith = Vec3f(1, 0, 0);
  EXPECT_EQ(said(shot), "");
  shot.environment_image = "sky.hdr";
  EXPECT_TRUE(says(shot, "environment.zenith") && !says(shot, "environment.image"));
  shot.sky.emplace();
  EXPECT_TRUE(says(shot, "environment.zenith") && says(shot, "environment.image"));
}

TEST(UnusedFields, DependOnTheGround) {
  Shot shot;
  shot.ground.emplace().sweep = 3;
  shot.ground->checker_color = Vec3f(1, 0, 0);
  EXPECT_TRUE(says(shot, "ground.sweep") && says(shot, "ground.checker_color"));
  shot.ground->style = GroundStyle::Sweep;
  shot.ground->checker = 0.5f;
  EXPECT_EQ(said(shot), "");
}

TEST(UnusedFields, DependOnWhatPicturesShow) {
  Shot shot;
  shot.render.heat.range = Vec2(0, 1);
  shot.render.params.channels.add(PictureChannel::Depth);
  EXPECT_TRUE(says(shot, "render.heat_range") && says(shot, "render.channels"));
  shot.render.heat.quantity = HeatQuantity::Stress;
  shot.output.exr = true;
  EXPECT_EQ(said(shot), "");
}

TEST(UnusedFields, DependOnTheTexturesOfTheMaterial) {
  Shot shot;
  TextureSettings& textures = shot.materials["wood"].textures;
  textures.scale = Vec2(2, 2);
  textures.normal_strength = 0.5;
  textures.bump_height = 0.1;
  for (const char* field : {"texture_scale", "normal_strength", "bump_height"})
    EXPECT_TRUE(says(shot, std::string("material.wood.") + field)) << field;
  textures.normal = "n.png";
  EXPECT_TRUE(says(shot, "material.wood.bump_height"));
  EXPECT_FALSE(says(shot, "material.wood.texture_scale") || says(shot, "material.wood.normal_strength"));
}

}  // namespace
}  // namespace softreel
