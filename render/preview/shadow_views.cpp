#include "render/preview/shadow_views.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "render/preview/preview_lights.h"

namespace softreel {
namespace {

struct Ball {
  Vec3f center = Vec3f::Zero();
  float radius = 0;
};

Ball ball_around(const std::vector<MotionMesh>& meshes) {
  Eigen::AlignedBox3f box;
  for (const MotionMesh& mesh : meshes)
    for (const Vec3f& p : mesh.times.back().positions) box.extend(p);
  if (box.isEmpty()) return {};
  // The box's own ball, a little wider so that the edge of the map is empty.
  return {box.center(), 0.52f * box.diagonal().norm()};
}

/// Rows: right, up, towards `forward`; relative to `eye`.
Eigen::Matrix4f view_from(const Vec3f& eye, const Vec3f& forward) {
  const Vec3f helper = std::abs(forward.y()) < 0.9f ? Vec3f(0, 1, 0) : Vec3f(1, 0, 0);
  const Vec3f right = forward.cross(helper).normalized(), up = right.cross(forward);
  Eigen::Matrix4f view = Eigen::Matrix4f::Identity();
  view.row(0) << right.transpose(), -right.dot(eye);
  view.row(1) << up.transpose(), -up.dot(eye);
  view.row(2) << forward.transpose(), -forward.dot(eye);
  return view;
}

ShadowView sun_view(const SunLight& sun, const Ball& ball, int size) {
  ShadowView view;
  view.is_sun = true;
  Eigen::Matrix4f scale = Eigen::Matrix4f::Identity();
  scale.diagonal().head<3>().setConstant(1 / ball.radius);
  view.clip_from_world = scale * view_from(ball.center, sun.direction.normalized());
  view.texel = 2 * ball.radius / static_cast<float>(size);
  return view;
}

ShadowView lamp_view(const AreaLight& lamp, const Ball& ball, int size) {
  ShadowView view;
  const Vec3f to = ball.center - lamp.center;
  const float distance = to.norm();
  const float near = distance - ball.radius, far = distance + ball.radius;
  const float slope = ball.radius / std::sqrt(distance * distance - ball.radius * ball.radius);
  Eigen::Matrix4f project = Eigen::Matrix4f::Zero();
  project(0, 0) = project(1, 1) = 1 / slope;
  project(2, 2) = (far + near) / (far - near);
  project(2, 3) = -2 * far * near / (far - near);
  project(3, 2) = 1;
  view.clip_from_world = project * view_from(lamp.center, to / distance);
  view.texel = 2 * slope * distance / static_cast<float>(size);
  return view;
}

}  // namespace

std::vector<ShadowView> shadow_views(const Scene& scene, int most, int size) {
  const Ball ball = ball_around(scene.meshes);
  std::vector<ShadowView> views;
  if (!(ball.radius > 0)) return views;
  const auto add = [&](ShadowView view, int light) {
    view.light = light;
    if (static_cast<int>(views.size()) < most) views.push_back(view);
  };
  const PreviewLights lights = preview_lights(scene);
  for (const int k : lights.suns) add(sun_view(scene.suns[static_cast<std::size_t>(k)], ball, size), k);
  for (const int k : lights.lamps) {
    const AreaLight& lamp = scene.area_lights[static_cast<std::size_t>(k)];
    if ((lamp.center - ball.center).norm() > 1.05f * ball.radius) add(lamp_view(lamp, ball, size), k);
  }
  return views;
}

}  // namespace softreel
