#include "render/pathtrace/shadow_catcher.h"

namespace softreel {

namespace {

/// A ray leaves the ground for good after so many meetings with it; a sweep's wall is met once, or where it is bent.
constexpr int kMostGroundHits = 4;

bool bodies_are_on(const Picture& picture, Ray ray) {
  const auto ground = static_cast<Index>(picture.meshes.size()) - 1;
  for (int k = 0; k < kMostGroundHits; ++k) {
    RayHit hit;
    if (!picture.rays->intersect(ray, hit)) return false;
    if (hit.mesh != ground) return true;
    const float passed = hit.distance * (1 + 1e-4f) + 1e-5f;
    ray.origin += passed * ray.direction;
    ray.max_distance -= passed;
    if (!(ray.max_distance > 0)) return false;
  }
  return false;
}

class Catcher {
 public:
  Catcher(const Picture& picture, const SurfacePoint& point, float time)
      : picture_(picture), receiver_{point.lifted, point.shading_normal, false, true, time} {}

  void add_lights(const SampleBlock& numbers) {
    const LightSet& lights = *picture_.lights;
    for (std::size_t k = 0; k < lights.count(); ++k) {
      LightSample light;
      bool point_like = false;
      if (!lights.sample_light(k, receiver_, numbers[5], Vec2f(numbers[0], numbers[1]), light, point_like)) continue;
      const float cosine = light.direction.dot(receiver_.normal);
      if (cosine <= 0) continue;
      add(luminance(light.radiance) * cosine / (kPi * light.pdf), light.direction, light.distance);
    }
  }

  /// A sky that is no light of its own.
  void add_sky(const SampleBlock& numbers) {
    if (picture_.lights->samples_environment()) return;
    const Vec3f local = cosine_hemisphere(Vec2f(numbers[2], numbers[3]));
    const Vec3f direction = ShadingFrame(receiver_.normal).to_world(local);
    add(luminance(picture_.lights->environment(direction)), direction, std::numeric_limits<float>::infinity());
  }

  const CaughtLight& light() const { return light_; }

 private:
  void add(float value, const Vec3f& direction, float distance) {
    light_.unshadowed += value;
    Ray ray;
    ray.origin = receiver_.position;
    ray.direction = direction;
    ray.max_distance = distance;
    ray.time = receiver_.time;
    if (!bodies_are_on(picture_, ray)) light_.shadowed += value;
  }

  const Picture& picture_;
  Receiver receiver_;
  CaughtLight light_;
};

}  // namespace

CaughtLight caught_light(const Picture& picture, const SurfacePoint& point, float time, const SampleBlock& numbers) {
  Catcher catcher(picture, point, time);
  catcher.add_lights(numbers);
  catcher.add_sky(numbers);
  return catcher.light();
}

}  // namespace softreel
