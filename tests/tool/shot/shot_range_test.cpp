// The ends of every range: the last number that is taken and the first that is not.
#include "tests/tool/shot/shot_files.h"

namespace softreel {
namespace {

using ShotRanges = ShotFiles;

struct Ends {
  const char* path;
  std::vector<const char*> taken, refused;
};

TEST_F(ShotRanges, EndWhereTheReferenceSays) {
  const std::vector<const char*> positive{"1e-300", "1e300"}, above_zero{"0", "-1"};
  const std::vector<const char*> share{"0", "1"}, no_share{"-0.001", "1.001"};
  // What pictures are made with is computed on in single precision.
  const std::vector<const char*> above_zero_single{"0", "-1", "1e39"}, positive_single{"1e-30", "1e30"};
  const std::vector<const char*> not_negative{"0", "1e30"}, negative{"-1e-9"};
  const std::vector<Ends> all{
      {"shot.fps", {"0.001", "100000"}, {"0", "100001"}},
      {"shot.preroll", {"0", "1000000"}, {"-1", "1000001"}},
      {"shot.frames", {"[-1000000, 1000000]", "[5, 5]"}, {"[0, 1000001]", "[-1000001, 0]", "[5, 4]"}},
      {"body.fit", positive, above_zero},
      {"body.scale", positive, above_zero},
      {"body.edge", positive, above_zero},
      {"body.error", {"1e-300", "1e300", "\"50%\""}, {"0", "-1", "\"50.1%\"", "\"0%\""}},
      {"body.thickness", positive, above_zero},
      {"body.crease_deg", {"1e-3", "180"}, {"0", "-1", "180.1"}},
      {"body.tets", {"1", "500000000"}, {"0", "500000001", "9223372036854775807", "1e19"}},
      {"body.region[0].stiffness", positive, above_zero},
      {"body.pull[0].stiffness", not_negative, negative},
      {"body.pull[0].falloff", not_negative, negative},
      {"body.pull[0].max_force", not_negative, negative},
      {"body.pin[0].select.sphere.radius", positive, above_zero},
      {"body.pin[1].select.nearest.count", {"1", "1000000000"}, {"0", "1000000001"}},
      {"material.m.youngs_modulus", positive, above_zero},
      {"material.m.poisson_ratio", {"0", "0.499"}, {"-0.001", "0.4991", "0.5"}},
      {"material.m.density", positive, above_zero},
      {"material.m.damping_mass", not_negative, negative},
      {"material.m.damping_stiffness", not_negative, negative},
      {"material.m.base_color", {"[0, 1, 0.5]"}, {"[0, 1.001, 0]", "[-0.001, 0, 0]"}},
      {"material.m.coat", share, no_share},
      {"material.m.coat_roughness", share, no_share},
      {"material.m.coat_ior", {"1", "5"}, {"0.999", "5.001"}},
      {"material.m.coat_color", {"[0.001, 1, 0.5]"}, {"[0, 1, 1]", "[1, 1, 1.001]"}},
      {"material.m.sheen", share, no_share},
      {"material.m.sheen_roughness", {"0.1", "1"}, {"0.099", "1.001"}},
      {"material.m.sheen_color", {"[0, 1, 0.5]"}, {"[0, 1.001, 0]", "[-0.001, 0, 0]"}},
      {"material.m.subsurface", share, no_share},
      {"material.m.subsurface_radius", {"[1e-6, 1e6, 1]"}, {"[0, 1, 1]", "[1, 1, 1.1e6]"}},
      {"material.m.subsurface_scale", {"0.001", "1000"}, {"0", "1001"}},
      {"material.m.subsurface_anisotropy", {"-0.95", "0.95"}, {"-0.96", "0.96"}},
      {"material.m.roughness", share, no_share},
      {"material.m.metallic", share, no_share},
      {"material.m.specular", share, no_share},
      {"material.m.transmission", share, no_share},
      {"material.m.ior", {"1", "5"}, {"0.999", "5.001"}},
      {"material.m.absorption", {"[0, 0, 1e30]"}, {"[-1, 0, 0]", "[0, 0, 1e39]"}},
      {"material.m.emission", {"[0, 0, 1e30]"}, {"[-1, 0, 0]", "[0, 0, 1e39]"}},
      {"solver.newmark_beta", {"0.25", "1"}, {"0.2499", "1.001"}},
      {"solver.newmark_gamma", {"0.5"}, {"0.4999", "1.001", "0.6"}},  // the last needs a greater beta
      {"solver.substeps", {"1", "10000"}, {"0", "10001"}},
      {"solver.step_error", {"0", "1"}, {"-1e-9", "1.001"}},
      {"solver.max_substeps", {"1", "65536"}, {"0", "65537"}},
      {"solver.rest_tolerance", {"0", "1"}, {"-1e-9", "1.001"}},
      {"solver.matrix_lag", {"0", "1"}, {"-1e-9", "1.001"}},
      {"solver.tolerance", {"1e-16", "1"}, {"0", "1.001"}},
      {"solver.force_tolerance", {"1e-16", "1"}, {"0", "1.001"}},
      {"solver.max_iterations", {"1", "1000000"}, {"0", "1000001"}},
      {"solver.max_newton_iterations", {"1", "1000000"}, {"0", "1000001"}},
      {"solver.threads", {"0", "4096"}, {"-1", "4097"}},
      {"camera.elevation_deg", {"-90", "90"}, {"-90.1", "90.1"}},
      {"camera.margin", positive_single, above_zero_single},
      {"camera.focal_length_mm", positive_single, above_zero_single},
      {"camera.sensor_width_mm", positive_single, above_zero_single},
      {"camera.f_number", not_negative, {"-1e-9", "1e39"}},
      {"camera.focus_distance", positive_single, above_zero_single},
      {"light[0].size", {"[1e-9, 1]"}, {"[0, 1]", "[1, -1]", "[1, 1e39]"}},
      {"light[0].color", {"[0, 0, 0]"}, {"[0, -1, 0]", "[1e39, 0, 0]"}},
      {"light[0].power", not_negative, {"-1e-9", "1e39"}},
      {"light[1].irradiance", not_negative, {"-1e-9", "1e39"}},
      {"light[1].angle_deg", {"0", "90"}, {"-0.1", "90.1"}},
      {"environment.zenith", {"[0, 0, 0]"}, {"[0, -1, 0]"}},
      {"environment.strength", not_negative, {"-1e-9", "1e39"}},
      {"ground.size", {"1e-30", "1e30"}, above_zero},
      {"ground.sweep", {"1e-30", "1e30"}, above_zero},
      {"ground.checker", not_negative, negative},
      {"ground.roughness", share, no_share},
      {"ground.specular", share, no_share},
      {"render.width", {"1", "32768"}, {"0", "32769"}},
      {"render.height", {"1", "32768"}, {"0", "32769"}},
      {"render.scale", {"0.001", "34"}, {"0", "1e-4", "35", "1e30"}},  // of 960 x 540
      {"render.samples", {"1", "1048576"}, {"0", "1048577"}},
      {"render.max_bounces", {"0", "1024"}, {"-1", "1025"}},
      {"render.clamp", not_negative, negative},
      {"render.caustic_roughness", share, no_share},
      {"render.shutter", share, no_share},
      {"render.shutter_opening", share, no_share},
      {"render.shutter_closing", share, no_share},
      {"render.noise", share, no_share},
      {"render.min_samples", {"16", "1048576"}, {"8", "1048584"}},
      {"render.time_limit", not_negative, negative},
      {"render.overscan", share, no_share},
      {"render.blur_segments", {"1", "64"}, {"0", "65"}},
      {"output.exposure", {"-64", "64"}, {"-64.1", "64.1"}},
      {"golden.threshold", not_negative, negative},
  };
  const std::string text = body(R"(
[[body.a.region]]
select = { all = true }
[[body.a.pin]]
select = { sphere = { center = [0, 0, 0], radius = 1 } }
[[body.a.pin]]
select = { nearest = { point = [0, 0, 0] } }
[[body.a.pull]]
select = { all = true }
stiffness = 1
[[light]]
type = "area"
[[light]]
type = "sun"
[material.m]
)");
  for (const Ends& ends : all) {
    std::string base = text;
    if (std::string(ends.path) != "body.region[0].stiffness")
      base.insert(base.find("[[body.a.pin]]"), "stiffness = 2\n");
    for (const char* value : ends.taken)
      EXPECT_EQ(message(base, {std::string(ends.path) + "=" + value}), "") << ends.path << " = " << value;
    for (const char* value : ends.refused)
      EXPECT_NE(message(base, {std::string(ends.path) + "=" + value}), "") << ends.path << " = " << value;
  }
}

}  // namespace
}  // namespace softreel
