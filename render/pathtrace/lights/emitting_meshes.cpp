#include "render/pathtrace/lights/emitting_meshes.h"

#include <algorithm>
#include <cmath>

#include "render/pathtrace/rays/sampling.h"
#include "render/pathtrace/rays/surface_point.h"

namespace softreel {

namespace {

/// Shadow rays end this share before the light, so that they do not find it in their way,
constexpr float kShortened = 1 - 1e-4f;
/// and by the round-off of its coordinates, a few units in the last place of the largest: far from the origin, light
/// that is near would else be in its own way.
constexpr float kRoundOff = 4e-7f;

/// Of a shadow ray to a point of a light.
float distance_before(const Vec3f& point, const Vec3f& receiver, float distance) {
  const float largest = std::max(point.cwiseAbs().maxCoeff(), receiver.cwiseAbs().maxCoeff());
  return std::max(0.0f, distance * kShortened - kRoundOff * largest);
}

/// Over all times of the shutter.
EmitterBounds bounds_of(const MotionMesh& mesh, const Triangle& triangle, float radiance) {
  EmitterBounds bounds;
  float largest = 0;
  bool is_first = true;
  for (const MotionMesh::Time& time : mesh.times) {
    Corners p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = time.positions[static_cast<std::size_t>(triangle[k])];
    const Vec3f low = p[0].cwiseMin(p[1]).cwiseMin(p[2]), high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
    bounds.low = is_first ? low : Vec3f(bounds.low.cwiseMin(low));
    bounds.high = is_first ? high : Vec3f(bounds.high.cwiseMax(high));
    is_first = false;
    const Vec3f normal = (p[1] - p[0]).cross(p[2] - p[0]);
    const float twice_area = normal.norm();
    largest = std::max(largest, 0.5f * twice_area);
    if (twice_area > 0) bounds.normals = bounds.normals.joined({normal / twice_area, 0});
  }
  // Between the times it may turn on: with few of them, by more than the cone that they span.
  if (mesh.times.size() > 1) bounds.normals.angle = std::min(kPi, 2 * std::max(bounds.normals.angle, 0.0f) + 0.01f);
  bounds.power_by_pi = radiance * largest;
  return bounds;
}

std::vector<EmitterBounds> all_bounds(const std::vector<MotionMesh>& meshes) {
  std::vector<EmitterBounds> bounds;
  for (const MotionMesh& mesh : meshes)
    if (mesh.appearance.emission.maxCoeff() > 0)
      for (const Triangle& triangle : mesh.triangles)
        bounds.push_back(bounds_of(mesh, triangle, luminance(mesh.appearance.emission)));
  return bounds;
}

}  // namespace

EmittingMeshes::EmittingMeshes(const std::vector<MotionMesh>& meshes) : tree_(all_bounds(meshes)) {
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    meshes_.push_back(&meshes[m]);
    const bool emits = meshes[m].appearance.emission.maxCoeff() > 0;
    first_.push_back(emits ? static_cast<Index>(emitters_.size()) : -1);
    if (!emits) continue;
    for (std::size_t t = 0; t < meshes[m].triangles.size(); ++t)
      emitters_.push_back({static_cast<Index>(m), static_cast<Index>(t)});
  }
}

bool EmittingMeshes::sample(const TreeReceiver& receiver, float time, float choice, const Vec2f& u,
                            LightSample& sample) const {
  Index chosen = -1;
  float probability = 0;
  if (!tree_.choose(receiver, choice, chosen, probability)) return false;
  const Emitter& emitter = emitters_[static_cast<std::size_t>(chosen)];
  const MotionMesh& mesh = *meshes_[static_cast<std::size_t>(emitter.mesh)];
  RayHit hit;
  hit.triangle = emitter.triangle;
  Ray ray;
  ray.time = time;
  const Corners p = hit_corners(mesh, hit, ray);
  const Vec3f normal = (p[1] - p[0]).cross(p[2] - p[0]);  // as long as twice the area
  const float root = std::sqrt(u.x());
  const Vec3f point = (1 - root) * p[0] + root * (1 - u.y()) * p[1] + root * u.y() * p[2];
  const Vec3f to = point - receiver.position;
  const float distance = to.norm();
  sample.direction = to / distance;
  const float projected = -0.5f * normal.dot(sample.direction);  // area as seen from the receiver
  if (!(projected > 0)) return false;
  sample.pdf = probability * distance * distance / projected;
  sample.distance = distance_before(point, receiver.position, distance);
  sample.radiance = mesh.appearance.emission;
  return true;
}

float EmittingMeshes::pdf(const TreeReceiver& receiver, const Ray& ray, const RayHit& hit) const {
  const auto mesh = static_cast<std::size_t>(hit.mesh);
  if (mesh >= first_.size() || first_[mesh] < 0) return 0;
  const Corners p = hit_corners(*meshes_[mesh], hit, ray);
  const float projected = -0.5f * (p[1] - p[0]).cross(p[2] - p[0]).dot(ray.direction);
  if (!(projected > 0)) return 0;
  return tree_.probability(receiver, first_[mesh] + hit.triangle) * hit.distance * hit.distance / projected;
}

}  // namespace softreel
