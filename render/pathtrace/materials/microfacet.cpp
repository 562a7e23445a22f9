#include "render/pathtrace/materials/microfacet.h"

#include "render/pathtrace/rays/sampling.h"

namespace softreel {

Vec3f visible_normal(const Vec3f& o, float alpha, const Vec2f& disk) {
  // Stretch to alpha = 1, where the visible normals are those of a hemisphere; sample its projection; unstretch.
  const Vec3f stretched = Vec3f(alpha * o.x(), alpha * o.y(), o.z()).normalized();
  const float across = stretched.x() * stretched.x() + stretched.y() * stretched.y();
  const Vec3f t1 = across > 0 ? Vec3f(Vec3f(-stretched.y(), stretched.x(), 0) / std::sqrt(across)) : Vec3f(1, 0, 0);
  const Vec3f t2 = stretched.cross(t1);
  const float s = 0.5f * (1 + stretched.z());
  const float p1 = disk.x();
  const float p2 = (1 - s) * std::sqrt(std::max(0.0f, 1 - p1 * p1)) + s * disk.y();
  const float p3 = std::sqrt(std::max(0.0f, 1 - p1 * p1 - p2 * p2));
  const Vec3f n = p1 * t1 + p2 * t2 + p3 * stretched;
  return Vec3f(alpha * n.x(), alpha * n.y(), std::max(1e-6f, n.z())).normalized();
}

Vec3f sample_visible_normal(const Vec3f& o, float alpha, const Vec2f& u) {
  return visible_normal(o, alpha, concentric_disk(u));
}

float fresnel_dielectric(float cosine, float eta) {
  const float sin2_t = (1 - cosine * cosine) / (eta * eta);
  if (sin2_t >= 1) return 1;
  const float cos_t = std::sqrt(1 - sin2_t);
  const float parallel = (eta * cosine - cos_t) / (eta * cosine + cos_t);
  const float across = (cosine - eta * cos_t) / (cosine + eta * cos_t);
  return 0.5f * (parallel * parallel + across * across);
}

bool refract(const Vec3f& o, const Vec3f& h, float eta, Vec3f& refracted) {
  const float cosine = o.dot(h);
  const float sin2_t = std::max(0.0f, 1 - cosine * cosine) / (eta * eta);
  if (sin2_t >= 1) return false;
  refracted = (cosine / eta - std::sqrt(1 - sin2_t)) * h - o / eta;
  return true;
}

}  // namespace softreel
