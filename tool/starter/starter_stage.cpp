#include "tool/starter/starter_stage.h"

#include <fmt/format.h>

namespace softreel {
namespace {

/// What presents the body: lamps, camera, ground, picture. Made for bodies of about a metre.
constexpr const char* kStage = R"(
[solver]
integrator = "bdf2"
substeps = 4

[camera]
mode = "frame"
azimuth_deg = 24
elevation_deg = 8
margin = MARGIN
shift = SHIFT
focal_length_mm = 60

[[light]]
type = "area"
center = [-1.9, 3.1, 2.5]
aim = [0, 0.5, 0]
size = [2.4, 2.4]
color = [1.0, 0.90, 0.78]
power = 330
visible = false

[[light]]
type = "area"
center = [2.4, 2.4, -1.9]
aim = [0, 0.6, 0]
size = [2.0, 2.0]
color = [0.80, 0.90, 1.0]
power = 200
visible = false

[environment]
zenith = [0.48, 0.62, 0.85]
horizon = [0.36, 0.48, 0.62]
nadir = [0.20, 0.20, 0.22]
strength = 0.55

[ground]
style = "sweep"
sweep = 4
color = [0.06, 0.20, 0.23]
roughness = 0.8

[render]
width = 960
height = 540
samples = 16
max_bounces = 4
shutter = 0.5

[output]
directory = "out"
view = "filmic"
png = true
exr = false
movie = true
)";

}  // namespace

std::string stage_for(const StarterBody& body) {
  const double height = used_bounds(body.loaded.surface).size().y();
  const double up = height > 1e-3 * body.length ? (body.stands ? 0.12 : 0.1) * body.length / height : 0;
  std::string stage = kStage;
  const auto put = [&stage](const std::string& word, const std::string& value) {
    stage.replace(stage.find(word), word.size(), value);
  };
  put("MARGIN", body.stands ? "1.4" : "1.6");
  put("SHIFT", fmt::format("[0, {:.2g}, 0]", up));
  return stage;
}

}  // namespace softreel
