/// Frames a second of the preview: preview_speed [FRAMES].
///
/// Draws an uneven ball of 86,400 triangles on a backdrop with two lamps at 1280 x 720, a new shape each frame, in both
/// modes. Prints TSV: mode, triangles, milliseconds of wall clock and of all threads' cpu a frame; PNG encoding apart.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "core/base/error.h"
#include "core/base/timer.h"
#include "render/preview/preview.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

struct Clock {
  std::chrono::steady_clock::time_point wall = std::chrono::steady_clock::now();
  std::clock_t cpu = std::clock();

  void print(const char* what, std::size_t triangles, int frames) const {
    const double seconds = seconds_since(wall);
    const double busy = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
    std::printf("%s\t%zu\t%.2f\t%.2f\n", what, triangles, 1000 * seconds / frames, 1000 * busy / frames);
  }
};

Scene studio() {
  Scene scene = scene_in_sky(0.4f);
  Appearance skin = matte(0.6f);
  skin.specular = 0.5f;
  skin.roughness = 0.4f;
  scene.meshes = {sphere(Vec3f(0, 0.6f, 0), 0.5f, skin, 147)};
  for (const Vec3f& center : {Vec3f(-2, 3, 2.5f), Vec3f(2.4f, 2.4f, -1.9f)}) {
    AreaLight lamp;
    lamp.center = center;
    const Vec3f to = (Vec3f(0, 0.6f, 0) - center).normalized();
    lamp.u = to.cross(Vec3f(0, 1, 0)).normalized();
    lamp.v = to.cross(lamp.u);
    if (lamp.u.cross(lamp.v).dot(to) < 0) lamp.v = -lamp.v;
    lamp.radiance = Vec3f::Constant(12);
    scene.area_lights.push_back(lamp);
  }
  scene.ground.emplace();
  scene.ground->style = GroundStyle::Sweep;
  scene.camera.position = Vec3f(0.6f, 1.1f, 2.6f);
  scene.camera.target = Vec3f(0, 0.6f, 0);
  return scene;
}

/// Waves that run over the ball.
void deform(MotionMesh& mesh, const MotionMesh& rest, int frame) {
  for (std::size_t p = 0; p < rest.times[0].positions.size(); ++p) {
    const Vec3f& n = rest.times[0].normals[p];
    const float wave = 0.03f * std::sin(12 * n.x() + 7 * n.y() + 0.3f * static_cast<float>(frame));
    mesh.times[0].positions[p] = rest.times[0].positions[p] + wave * n;
  }
}

void run(int frames) {
  const Clock start;
  Scene scene = studio();
  const MotionMesh rest = scene.meshes[0];
  const std::size_t triangles = rest.triangles.size();
  const auto preview = make_egl_preview();
  std::printf("# %s\n# what\ttriangles\twall_ms\tcpu_ms\n", preview->description().c_str());
  DisplayImage image;
  for (const bool fast : {true, false}) {
    PreviewStyle style;
    style.fast = fast;
    const auto draw = [&](int frame) {
      deform(scene.meshes[0], rest, frame);
      image = preview->draw(scene, 1280, 720, ViewTransform::Filmic, 0, style);
    };
    draw(0);  // compiles the shaders
    if (fast) start.print("first frame", triangles, 1);
    const Clock clock;
    for (int frame = 1; frame <= frames; ++frame) draw(frame);
    clock.print(fast ? "fast" : "shadows", triangles, frames);
  }
  const Clock clock;
  for (int k = 0; k < 3; ++k) encode_png(image);
  clock.print("png", triangles, 3);
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  try {
    softreel::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 20);
  } catch (const softreel::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
