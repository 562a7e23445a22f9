/// Files of a shot in a folder of their own, for tests.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/test_folder.h"
#include "tool/shot/shot_load.h"

namespace softreel {

/// A fresh folder per test; removed at its end. Tests run in it, so that messages show short paths.
class ShotFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    before_ = std::filesystem::current_path();
    folder_ = testing::test_folder() / (std::string(info->test_suite_name()) + "_" + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    std::filesystem::current_path(folder_);
  }
  void TearDown() override {
    std::filesystem::current_path(before_);
    std::filesystem::remove_all(folder_);
  }

  static void write(const std::string& path, const std::string& text) {
    const auto parent = std::filesystem::path(path).parent_path();
    if (!parent.empty()) std::filesystem::create_directories(parent);
    std::ofstream(path, std::ios::binary) << text;
  }

  static std::vector<Override> overrides(const std::vector<std::string>& texts) {
    std::vector<Override> all;
    for (const std::string& text : texts) all.push_back(parse_override(text));
    return all;
  }

  /// Loads `text` as the file s.toml.
  static Shot load(const std::string& text, const std::vector<std::string>& sets = {}) {
    write("s.toml", text);
    return load_shot("s.toml", overrides(sets));
  }

  /// The message that loading `text` fails with; empty if it does not fail.
  static std::string message(const std::string& text, const std::vector<std::string>& sets = {}) {
    try {
      load(text, sets);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      return error.what();
    }
    return "";
  }

  /// A shot of one body, with `lines` inside its table and after it.
  static std::string body(const std::string& lines) { return "[body.a]\nmesh = \"a.ply\"\n" + lines; }

 private:
  std::filesystem::path before_, folder_;
};

/// Every field of a shot with a value that is not its default.
inline constexpr const char* kFullShot = R"(schema = 1

[shot]
name = "other"
fps = 23.976
frames = [-3, 48]
preroll = 5
start = "equilibrium"
mode = "static"
independent = true

[gravity]
acceleration = [0.1, -1.62, 1e-3]

[body.second_by_name]
mesh = "meshes/b.ply"
up = "z"
fit = 1.7
translate = [0.1, 0.2, 0.3]
rotate_deg = [10, 20, 30]
material = "rubber"
edge = 0.03
mode = "embedded"
thickness = 0.02
rotation = "paper"
crease_deg = 40

[[body.second_by_name.region]]
select = [
  { box = { min = [0, 0, 0], max = [1, 0.06, 1] }, unit = "box" },
  { sphere = { center = [0.5, 1, 0.5], radius = 0.2 }, unit = "box" },
  { plane = { point = [0, 0, 0.1], normal = [0, 1, 0] } },
  { nearest = { point = [0.5, 1, 0.5], count = 3 }, unit = "box" },
  { group = "knees" },
  { all = true },
]
stiffness = 0.1

[[body.second_by_name.region]]
select = { all = true }
material = "gel"

[[body.second_by_name.pin]]
select = [
  { box = { min = [0, 0, 0], max = [1, 0.06, 1] }, unit = "box" },
  { sphere = { center = [0.5, 1, 0.5], radius = 0.2 }, unit = "box" },
  { plane = { point = [0, 0, 0.1], normal = [0, 1, 0] } },
  { nearest = { point = [0.5, 1, 0.5], count = 3 }, unit = "box" },
  { group = "knees" },
  { all = true },
  { weights = { file = "map.ply", attribute = "goal" }, threshold = 0.25 },
]
active = [[1, 20], [30.5, 40]]
keys_unit = "box"
keys = [
  { frame = 1, ease = "constant" },
  { frame = 24.5, translate = [0, 0.3, 0], rotate_deg = [33.3, 90, -720.1], scale = [1, 2, 3], pivot = [0, 1, 0], ease = "linear" },
]

[[body.second_by_name.pin]]
select = { plane = { point = [0, 0, 0.1], normal = [0, 1, 0] } }

[[body.second_by_name.pin]]
select = { weights = { color = "green" }, threshold = 0.25 }
follow = { file = "rig.glb", node = "jaw", clip = "open", start = 3, speed = 0.5, reference = 2, placement = "scene" }
grab = true

[[body.second_by_name.pin]]
select = { weights = { file = "map.ply", attribute = "goal" } }
follow = { file = "rig.glb", mesh = "skin", bind = "vertex" }

[[body.second_by_name.pull]]
select = [
  { box = { min = [0, 0, 0], max = [1, 0.06, 1] }, unit = "box" },
  { sphere = { center = [0.5, 1, 0.5], radius = 0.2 }, unit = "box" },
  { plane = { point = [0, 0, 0.1], normal = [0, 1, 0] } },
  { nearest = { point = [0.5, 1, 0.5], count = 3 }, unit = "box" },
  { group = "knees" },
  { all = true },
]
keys_unit = "box"
stiffness = [{ frame = 1, value = 400 }, { frame = 48, value = 0, ease = "linear" }]
falloff = 0.1
max_force = 12
active = [1, 48]
keys = [
  { frame = 1, ease = "linear" },
  { frame = 40, translate = [0.2, 0.5, 0], rotate_deg = [1, 2, 3], scale = [2, 1, 1], pivot = [1, 1, 1] },
]

[[body.second_by_name.pull]]
select = { weights = { file = "map.ply", attribute = "goal" }, threshold = 0.75 }
stiffness = 3
weights = { attribute = "softness", file = "b.ply" }
follow = { file = "cache.mdd", node = "none", clip = "c", start = 1.5, speed = 2, reference = 4, placement = "scene" }
grab = true

[[body.second_by_name.pull]]
select = { weights = { color = "blue" }, threshold = 0.1 }
stiffness = 4
weights = { color = "red" }
follow = { file = "rig.fbx", mesh = "skin", bind = "nearest" }

[[body.second_by_name.region]]
select = [{ weights = { file = "map.txt", attribute = "goal" }, threshold = 0.1 }, { weights = { color = "red" } }]
stiffness = 2

[body.first_by_name]
mesh = "/meshes/a.ply"
scale = 0.01
material = "gel"
tets = 5000
graded = true

[body.third_by_name]
mesh = "meshes/c.ply"
material = "gel"
error = "0.3%"
optimize = true

[body.fourth_by_name]
mesh = "meshes/d.ply"
material = "gel"
tetrahedra = "meshes/d.msh"

[[glue]]
bodies = ["first_by_name", "third_by_name"]
distance = 0.02
select = [
  { box = { min = [0, 0, 0], max = [1, 0.06, 1] }, unit = "box" },
  { sphere = { center = [0.5, 1, 0.5], radius = 0.2 }, unit = "box" },
  { plane = { point = [0, 0, 0.1], normal = [0, 1, 0] } },
  { nearest = { point = [0.5, 1, 0.5], count = 3 }, unit = "box" },
  { group = "knees" },
  { weights = { file = "map.ply", attribute = "sticky" }, threshold = 0.75 },
  { weights = { color = "blue" } },
  { all = true },
]
stiffness = [{ frame = 1, value = 400 }, { frame = 48, value = 0, ease = "linear" }]
close = 0
max_force = 12
active = [1, 40]

[material.rubber]
youngs_modulus = 2e5
poisson_ratio = 0.45
density = 950
damping_mass = 0.1
damping_stiffness = 0.002
base_color = [0.8, 0.3, 0.15]
roughness = 0.4
metallic = 0.1
specular = 0.7
transmission = 0.2
ior = 1.33
absorption = [0.1, 2, 30]
emission = [0, 0.01, 0.1]
coat = 0.5
coat_roughness = 0.2
coat_ior = 1.6
coat_color = [0.9, 0.5, 0.25]
sheen = 0.3
sheen_roughness = 0.45
sheen_color = [1, 0.5, 0.2]
subsurface = 0.6
subsurface_radius = [0.03, 0.02, 0.01]
subsurface_scale = 1.5
subsurface_anisotropy = 0.4

[material.gel]
poisson_ratio = 0.49
base_color_texture = "../textures/skin.png"
roughness_texture = "../textures/rough.exr"
normal_texture = "/textures/pores.png"
normal_strength = 0.7
bump_texture = "scales.jpg"
bump_height = -0.002
texture_scale = [2, 3]
texture_offset = [0.25, -0.5]
texture_wrap = "mirror"
[material.paint]
vertex_colors = true

[solver]
rotation = "energy"
dilatation = "linear"
recovery = false
integrator = "newmark"
newmark_beta = 0.36
newmark_gamma = 0.7
linearize = "iterated"
step_error = 1e-4
max_substeps = 64
max_tets = 50000
rest_tolerance = 1e-6
matrix_lag = 0.05
keep_hierarchy = false
substeps = 3
tolerance = 1e-5
force_tolerance = 1e-7
max_iterations = 300
max_newton_iterations = 100
galerkin = "stream"
method = "cycles"
cycle = "v"
smoother = "chebyshev"
sweeps = 2
chebyshev_degree = 3
threads = 3

[camera]
mode = "place"
azimuth_deg = 33
elevation_deg = -12
margin = 1.1
shift = [0.1, 0.2, 0.3]
position = [{ frame = 1, value = [0, 1, 4] }, { frame = 48, value = [1, 1, 4], ease = "linear" }]
target = [{ frame = 2, value = [0, 0.5, 0], ease = "linear" }]
focal_length_mm = [{ frame = 1, value = 35 }, { frame = 48, value = 85, ease = "constant" }]
sensor_width_mm = 24
f_number = 2.8
focus_distance = [{ frame = 2, value = 3.1, ease = "linear" }]

[[light]]
type = "sun"
direction = [{ frame = 2, value = [-1, -1, -0.5], ease = "linear" }]
color = [{ frame = 2, value = [1, 0.9, 0.8], ease = "linear" }]
irradiance = [{ frame = 2, value = 2, ease = "linear" }]
angle_deg = 2

[[light]]
type = "area"
center = [{ frame = 1, value = [2, 4, 3], ease = "linear" }]
aim = [{ frame = 1, value = [0, 0.5, 0], ease = "linear" }]
size = [2, 1]
color = [1, 0.9, 0.7]
power = [{ frame = 1, value = 400 }, { frame = 9, value = 0, ease = "linear" }]
visible = false

[[light]]
type = "sphere"
radius = 0.3

[environment]
zenith = [0.1, 0.2, 0.3]
horizon = [0.4, 0.5, 0.6]
nadir = [0.7, 0.8, 0.9]
image = "../studio.exr"
strength = [{ frame = 1, value = 1.3, ease = "linear" }]
rotation_deg = [{ frame = 1, value = 77.7, ease = "linear" }]

[environment.sky]
turbidity = [{ frame = 1, value = 4, ease = "linear" }]
elevation_deg = [{ frame = 1, value = 20, ease = "linear" }]
azimuth_deg = [{ frame = 1, value = 120, ease = "linear" }]
ground_albedo = 0.4
sun = false
sun_angle_deg = 2

[ground]
style = "sweep"
height = -0.1
size = 30
sweep = 5
color = [0.1, 0.2, 0.3]
roughness = 0.61
specular = 0.31
checker = 0.5
checker_color = [0.11, 0.22, 0.33]
shadow_catcher = true

[render]
width = 640
height = 360
scale = 1.5
samples = 64
noise = 0.01
min_samples = 32
time_limit = 60
max_bounces = 4
clamp = 10
caustic_roughness = 0.2
shutter = 0.5
blur_segments = 4
shutter_opening = 0.25
shutter_closing = 0.5
crop = [0.1, 0, 0.9, 1]
overscan = 0.05
auxiliary = true
channels = ["albedo", "normal", "depth", "position", "motion", "object_id", "material_id", "strain", "samples"]
heat = "stress"
heat_range = [-1, 2.5e4]

[output]
directory = "pictures"
view = "standard"
exposure = 0.5
png = false
exr = true
movie = false
burn_in = true
contact_sheet = true
cache_limit = 7

[golden]
frames = [-3, 10, 48]
threshold = 0.05
max_width = 320
max_samples = 4
)";

}  // namespace softreel
