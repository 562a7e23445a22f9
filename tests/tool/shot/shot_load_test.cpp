#include "tool/shot/shot_load.h"

#include <filesystem>
#include <numbers>

#include "tests/tool/shot/shot_files.h"
#include "tool/shot/keyed_look.h"

namespace softreel {
namespace {

using LoadShot = ShotFiles;

TEST_F(LoadShot, TakesDefaultsFromTheStructs) {
  const Shot shot = load(body(""));
  ASSERT_EQ(shot.bodies.size(), 1u);
  EXPECT_EQ(shot.settings.name, "s");
  EXPECT_EQ(shot.settings.fps, ShotSettings{}.fps);
  EXPECT_EQ(shot.bodies[0].name, "a");
  EXPECT_EQ(shot.bodies[0].tets, 20000);
  EXPECT_EQ(shot.bodies[0].edge, 0);
  EXPECT_EQ(shot.bodies[0].fit, 0);
  EXPECT_EQ(shot.gravity, Vec3(0, -9.81, 0));
  EXPECT_FALSE(shot.ground.has_value());
  EXPECT_TRUE(lights_at(shot, 1).lamps.empty());
  EXPECT_EQ(shot.camera.focal_length_mm.at(7), 50);
  EXPECT_TRUE(shot.camera.focus_distance.keys.empty());
}

TEST_F(LoadShot, HasABuiltInMaterialWhereThereIsNone) {
  const Shot shot = load(body(""));
  EXPECT_EQ(shot.bodies[0].material, "default");
  EXPECT_EQ(shot.materials.at("default").physics.youngs_modulus, ElementMaterial{}.youngs_modulus);
}

TEST_F(LoadShot, TakesTheOnlyMaterialForABodyThatNamesNone) {
  EXPECT_EQ(load(body("[material.gel]\ndensity = 900")).bodies[0].material, "gel");
  EXPECT_EQ(load(body("[material.gel]\n[material.default]")).bodies[0].material, "default");
}

TEST_F(LoadShot, KeepsBodiesInTheOrderOfTheFile) {
  const Shot shot = load(kFullShot);
  ASSERT_EQ(shot.bodies.size(), 4u);
  EXPECT_EQ(shot.bodies[0].name, "second_by_name");
  EXPECT_EQ(shot.bodies[1].name, "first_by_name");
}

TEST_F(LoadShot, RemembersWhereThingsWereWritten) {
  const Shot shot = load("[body.a]\n  mesh = \"a.ply\"\n[[body.a.pin]]\nselect = { all = true }\n");
  EXPECT_EQ(to_string(shot.bodies[0].origin), "s.toml:1:1");
  EXPECT_EQ(to_string(shot.bodies[0].mesh_origin), "s.toml:2:10");
  EXPECT_EQ(to_string(shot.bodies[0].pins[0].origin), "s.toml:3:1");
}

TEST_F(LoadShot, ResolvesPathsAgainstTheFileThatSaysThem) {
  write("shots/deep/s.toml", body("[environment]\nimage = \"../sky.exr\""));
  const Shot shot = load_shot("shots/deep/s.toml", overrides({"body.mesh=b.ply"}));
  EXPECT_EQ(shot.bodies[0].mesh, "b.ply");
  EXPECT_EQ(shot.environment_image, "shots/sky.exr");
  EXPECT_EQ(to_string(shot.environment_origin), "shots/deep/s.toml:4:9");
  EXPECT_EQ(load(kFullShot).bodies[1].mesh, "/meshes/a.ply");
}

TEST_F(LoadShot, FollowsALinkBeforeTheFolderAboveIt) {
  namespace fs = std::filesystem;
  write("far/deep/here.txt", "");
  write("far/look.toml", "[render]\nwidth = 10\n");
  write("look.toml", "[render]\nwidth = 20\n");
  fs::create_directory_symlink("far/deep", "link");
  const Shot shot = load("use = [\"link/../look.toml\"]\n" + body("[environment]\nimage = \"link/../sky.exr\""),
                         {"body.mesh=link/../b.ply"});
  EXPECT_EQ(shot.render.params.width, 10);
  EXPECT_EQ(shot.environment_image, fs::canonical("far").string() + "/sky.exr");
  EXPECT_EQ(shot.bodies[0].mesh, fs::canonical("far").string() + "/b.ply");
  EXPECT_EQ(load(body("[environment]\nimage = \"link/sky.exr\"")).environment_image, "link/sky.exr");
}

TEST_F(LoadShot, TakesTheSizeOfTetrahedraInOneOfFourWays) {
  const Shot shot = load(kFullShot);
  EXPECT_EQ(shot.bodies[2].error, (BodyLength{0.003, true}));
  EXPECT_DOUBLE_EQ(shot.bodies[2].error.in_meters(2), 0.006);
  EXPECT_EQ(load(body("error = 0.02")).bodies[0].error, (BodyLength{0.02, false}));
  EXPECT_EQ(shot.bodies[3].tetrahedra, "meshes/d.msh");
  for (const BodySettings& one : shot.bodies)
    EXPECT_EQ((one.tets > 0) + (one.edge > 0) + (one.error.value > 0) + !one.tetrahedra.empty(), 1) << one.name;
  EXPECT_NE(message(body("error = 0.02\ntetrahedra = \"b.msh\"")).find("not both"), std::string::npos);
  EXPECT_NE(message(body("tets = 500\nerror = 0.02")).find("not both"), std::string::npos);
  for (const char* wrong : {"\"0.3\"", "\"percent\"", "\"-1%\"", "\"60%\"", "\"nan%\"", "0", "true"})
    EXPECT_EQ(message(body(std::string("error = ") + wrong)).empty(), std::string(wrong) == "\"0.3\"") << wrong;
}

TEST_F(LoadShot, TurnsDegreesIntoRadians) {
  const Shot shot =
      load(body("[[body.a.pin]]\nselect = { all = true }\nkeys = [{ frame = 1, rotate_deg = [90, 0, -720] }]\n"
                "[environment]\nrotation_deg = 180\n"));
  EXPECT_DOUBLE_EQ(shot.bodies[0].pins[0].keys.at(1).rotate.x(), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(shot.bodies[0].pins[0].keys.at(1).rotate.z(), -4 * std::numbers::pi);
  EXPECT_FLOAT_EQ(environment_at(shot, 1).rotation, std::numbers::pi_v<float>);
}

TEST_F(LoadShot, HoldsAPinWithoutKeysWhereItRests) {
  const Shot shot = load(body("[[body.a.pin]]\nselect = { all = true }\n"));
  const Pin pin{"", {}, shot.bodies[0].pins[0].keys, {}};
  EXPECT_EQ(pin.track.at(17).apply(Vec3(1, 2, 3)), Vec3(1, 2, 3));
  EXPECT_FALSE(shot.bodies[0].pins[0].pivot_given);
  EXPECT_FALSE(shot.bodies[0].pins[0].keys_in_box);
  EXPECT_TRUE(shot.bodies[0].pins[0].active.empty());
}

TEST_F(LoadShot, CarriesAPivotToKeysWithoutOne) {
  const Shot shot =
      load(body("[[body.a.pin]]\nselect = { all = true }\nkeys = [{ frame = 1 }, { frame = 2, pivot = [1, 2, "
                "3] }, { frame = 3 }, { frame = 4, pivot = [4, 5, 6] }]\n"));
  const PinSettings& pin = shot.bodies[0].pins[0];
  ASSERT_EQ(pin.keys.keys.size(), 4u);
  EXPECT_TRUE(pin.pivot_given);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(pin.keys.keys[static_cast<std::size_t>(i)].value.pivot, Vec3(1, 2, 3));
  EXPECT_EQ(pin.keys.keys[3].value.pivot, Vec3(4, 5, 6));
}

TEST_F(LoadShot, ReadsEveryShapeOfASelection) {
  const Shot shot = load(body(R"([[body.a.pin]]
select = [
  { box = { min = [0, 0, 0], max = [1, 2, 3] }, unit = "box" }, { sphere = { center = [1, 2, 3], radius = 4 } },
  { plane = { point = [1, 0, 0], normal = [0, 1, 0] } }, { group = "g" }, { nearest = { point = [1, 1, 1], count = 3 } },
  { nearest = { point = [1, 1, 1] } }, { all = true }]
)"));
  const auto& terms = shot.bodies[0].pins[0].select.terms;
  ASSERT_EQ(terms.size(), 7u);
  EXPECT_EQ(std::get<SelectBox>(terms[0].shape).max, Vec3(1, 2, 3));
  EXPECT_EQ(terms[0].unit, SelectionUnit::Box);
  EXPECT_EQ(std::get<SelectSphere>(terms[1].shape).radius, 4);
  EXPECT_EQ(terms[1].unit, SelectionUnit::Meter);
  EXPECT_EQ(std::get<SelectPlane>(terms[2].shape).normal, Vec3(0, 1, 0));
  EXPECT_EQ(std::get<SelectGroup>(terms[3].shape).name, "g");
  EXPECT_EQ(std::get<SelectNearest>(terms[4].shape).count, 3);
  EXPECT_EQ(std::get<SelectNearest>(terms[5].shape).count, 1);
  EXPECT_TRUE(std::holds_alternative<SelectAll>(terms[6].shape));
}

TEST_F(LoadShot, ReadsValuesOverFrames) {
  const Shot shot = load(kFullShot);
  const PullSettings& pull = shot.bodies[0].pulls[0];
  EXPECT_EQ(pull.stiffness.at(1), 400);
  EXPECT_EQ(pull.stiffness.at(100), 0);
  EXPECT_EQ(pull.stiffness.keys[0].ease, Ease::Smooth);
  EXPECT_EQ(pull.stiffness.keys[1].ease, Ease::Linear);
  EXPECT_EQ(shot.camera.position.at(1), Vec3(0, 1, 4));
  EXPECT_EQ(shot.camera.target.at(30), Vec3(0, 0.5, 0));
  EXPECT_TRUE(shot.bodies[0].pins[0].keys_in_box);
  EXPECT_TRUE(is_active(shot.bodies[0].pins[0].active, 30.5));
  EXPECT_FALSE(is_active(shot.bodies[0].pins[0].active, 25));
}

TEST_F(LoadShot, MakesLampsThatFaceTheirAimAndGiveTheirPower) {
  for (const char* aim : {"[0, 0.5, 0]", "[2, 9, 3]", "[2, -1, 3]", "[-7, 4, 3]"}) {
    const Shot shot = load(
        body(std::string("[[light]]\ntype = \"area\"\ncenter = [2, 4, 3]\nsize = [2, 3]\npower = 120\naim = ") + aim));
    ASSERT_EQ(lights_at(shot, 1).lamps.size(), 1u);
    const AreaLight lamp = lights_at(shot, 1).lamps[0];
    const Vec3f forward = (shot.lights[0].aim.at(1) - shot.lights[0].center.at(1)).cast<float>().normalized();
    EXPECT_NEAR(lamp.u.cross(lamp.v).normalized().dot(forward), 1, 1e-6);
    EXPECT_NEAR(lamp.u.norm(), 1, 1e-6);
    EXPECT_NEAR(lamp.v.norm(), 1.5, 1e-6);
    EXPECT_NEAR(lamp.radiance.x(), 120 / (4 * 2 * 3), 1e-5);
  }
}

TEST_F(LoadShot, MakesSunsOfUnitDirection) {
  const Shot shot = load(kFullShot);
  ASSERT_EQ(lights_at(shot, 1).suns.size(), 1u);
  EXPECT_NEAR(lights_at(shot, 1).suns[0].direction.norm(), 1, 1e-6);
  EXPECT_TRUE(lights_at(shot, 1).suns[0].irradiance.isApprox(Vec3f(2, 1.8f, 1.6f)));
  EXPECT_NEAR(lights_at(shot, 1).suns[0].angular_diameter, 2 * std::numbers::pi / 180, 1e-7);
}

TEST_F(LoadShot, BodiesAreSmoothUnlessTheySayOtherwise) {
  for (const char* lines : {"", "crease_deg = 180"}) EXPECT_FALSE(load(body(lines)).bodies[0].has_creases()) << lines;
  const Shot shot = load(kFullShot);
  EXPECT_EQ(shot.bodies[0].crease_deg, 40);
  EXPECT_TRUE(shot.bodies[0].has_creases());
  EXPECT_NE(message(body("crease_deg = 0")).find("above 0"), std::string::npos);
}

TEST_F(LoadShot, TakesWholeNumbersWhereANumberIsWantedAndBack) {
  const Shot shot = load(body("tets = 2e4\ntranslate = [1, 2, 3]\n[shot]\nfps = 25\n"));
  EXPECT_EQ(shot.bodies[0].tets, 20000);
  EXPECT_EQ(shot.settings.fps, 25);
}

}  // namespace
}  // namespace softreel
