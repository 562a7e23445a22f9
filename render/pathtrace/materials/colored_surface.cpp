#include "render/pathtrace/materials/colored_surface.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/check.h"
#include "render/scene/color_map.h"

namespace softreel {

namespace {

/// Steps of roughness between tables of albedo; linear between them is within 0.002 of the exact tables.
constexpr float kRoughnessStep = 1.0f / 32;

/// Value at a hit; of equal values exactly their value.
template <typename T>
T interpolated(const T& a, const T& b, const T& c, const RayHit& hit) {
  return a + hit.u * (b - a) + hit.v * (c - a);
}

template <typename T>
T interpolated(const std::vector<T>& values, const Triangle& corners, const RayHit& hit) {
  const auto at = [&](std::size_t k) -> const T& { return values[static_cast<std::size_t>(corners[k])]; };
  return interpolated<T>(at(0), at(1), at(2), hit);
}

bool has_coordinates(const Triangle& corners) {
  return corners[0] >= 0 && corners[1] >= 0 && corners[2] >= 0;
}

/// Whether u and v run clockwise on the side of `normal`.
bool is_mirrored(const TextureGradients& gradients, const Vec3f& normal) {
  return gradients.du.cross(gradients.dv).dot(normal) < 0;
}

std::size_t tangent_index(Index tangent, bool mirrored) {
  return 2 * static_cast<std::size_t>(tangent) + (mirrored ? 1 : 0);
}

float corner_angle(const Vec3f& a, const Vec3f& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

Vec3f valid_normal(const Vec3f& normal, const Vec3f& shading, const Vec3f& geometric, const Vec3f& to_viewer) {
  constexpr float kGrazing = 0.01f;
  const auto is_valid = [&](const Vec3f& n) {
    const float cosine = n.dot(to_viewer);
    return cosine >= kGrazing && (2 * cosine * n - to_viewer).dot(geometric) > 0;
  };
  if (is_valid(normal)) return normal;
  if (!is_valid(shading)) return shading;
  Vec3f valid = shading;
  float low = 0, high = 1;
  for (int k = 0; k < 10; ++k) {
    const float middle = 0.5f * (low + high);
    const Vec3f n = (shading + middle * (normal - shading)).normalized();
    if (is_valid(n)) {
      valid = n;
      low = middle;
    } else {
      high = middle;
    }
  }
  return valid;
}

ColoredSurface::ColoredSurface(const MotionMesh& mesh, float least_roughness, AlbedoCache& tables)
    : mesh_(mesh), least_roughness_(least_roughness) {
  const SurfaceColoring& coloring = mesh.coloring;
  const std::size_t vertices = mesh.times.front().positions.size();
  if (!coloring.colors.empty()) CHECK(coloring.colors.size() == vertices);
  if (!coloring.heat.empty()) CHECK(coloring.heat.size() == vertices);
  const TextureMaps& maps = coloring.maps;
  if (!maps.empty()) {
    CHECK(coloring.triangles.size() == mesh.triangles.size());
    for (const Vec2f& c : coloring.coordinates) coordinates_.push_back(maps.scale.cwiseProduct(c) + maps.offset);
  }
  prepare_tables(tables);
  if (maps.normal) prepare_tangents();
}

void ColoredSurface::prepare_tables(AlbedoCache& cache) {
  Appearance appearance = mesh_.appearance, blurred = appearance;
  plain_ = cache.of(appearance);
  blurred.roughness = std::max(appearance.roughness, least_roughness_);
  blurred.coat_roughness = std::max(appearance.coat_roughness, least_roughness_);
  plain_blurred_ = cache.of(blurred);
  const bool coat_differs = appearance.coat > 0 && blurred.coat_roughness != appearance.coat_roughness;
  const auto& roughness = mesh_.coloring.maps.roughness;
  if (!roughness) return;
  const std::vector<float>& texels = roughness->levels.front().texels;
  const auto [least, most] = std::minmax_element(texels.begin(), texels.end());
  first_roughness_ = *least;
  const float range = std::max(*most, least_roughness_) - first_roughness_;
  const int steps = static_cast<int>(std::ceil(range / kRoughnessStep));
  roughness_step_ = steps > 0 ? range / static_cast<float>(steps) : 1.0f;
  for (int k = 0; k <= steps; ++k) {
    appearance.roughness = blurred.roughness = first_roughness_ + static_cast<float>(k) * roughness_step_;
    tables_.push_back(cache.of(appearance));
    if (coat_differs) blurred_tables_.push_back(cache.of(blurred));
  }
}

std::array<Vec2f, 3> ColoredSurface::coordinates_of(const Triangle& corners) const {
  return {coordinates_[static_cast<std::size_t>(corners[0])], coordinates_[static_cast<std::size_t>(corners[1])],
          coordinates_[static_cast<std::size_t>(corners[2])]};
}

void ColoredSurface::join_tangent_corners() {
  struct Corner {
    Index normal;  // a vertex has one but at hard edges, where tangents of one side are none of the other
    Vec2f at;
    std::size_t triangle, corner;
  };
  std::vector<Corner> all;
  tangent_corners_.assign(mesh_.triangles.size(), {-1, -1, -1});
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (!has_coordinates(mesh_.coloring.triangles[t])) continue;
    const std::array<Vec2f, 3> at = coordinates_of(mesh_.coloring.triangles[t]);
    for (std::size_t k = 0; k < 3; ++k) all.push_back({mesh_.corners_of_normals()[t][k], at[k], t, k});
  }
  const auto key = [](const Corner& c) { return std::tuple(c.normal, c.at.x(), c.at.y()); };
  std::sort(all.begin(), all.end(), [&](const Corner& a, const Corner& b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == 0 || key(all[i]) != key(all[i - 1])) ++tangent_count_;
    tangent_corners_[all[i].triangle][all[i].corner] = static_cast<Index>(tangent_count_ - 1);
  }
}

void ColoredSurface::prepare_tangents() {
  join_tangent_corners();
  for (const MotionMesh::Time& time : mesh_.times) tangents_.push_back(tangents_of(time));
}

/// After Mikkelsen, Simulation of Wrinkled Surfaces Revisited, 2008: each triangle's direction, in the tangent plane of
/// the vertex, weighted by the corner's angle; mirrored triangles apart from the others.
std::vector<Vec3f> ColoredSurface::tangents_of(const MotionMesh::Time& time) const {
  std::vector<Vec3f> sums(2 * tangent_count_, Vec3f::Zero());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const Triangle &vertices = mesh_.triangles[t], &corners = mesh_.coloring.triangles[t];
    const Triangle& normals = mesh_.corners_of_normals()[t];
    if (!has_coordinates(corners)) continue;
    Corners p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = time.positions[static_cast<std::size_t>(vertices[k])];
    const Vec3f normal = (p[1] - p[0]).cross(p[2] - p[0]);
    const TextureGradients gradients(p, coordinates_of(corners));
    const bool mirrored = is_mirrored(gradients, normal);
    const Vec3f along_u = (mirrored ? -1.0f : 1.0f) * gradients.dv.cross(normal);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& n = time.normals.empty() ? normal : time.normals[static_cast<std::size_t>(normals[k])];
      const Vec3f in_plane = along_u - along_u.dot(n) / std::max(n.squaredNorm(), 1e-30f) * n;
      const float length = in_plane.norm();
      if (!(length > 0)) continue;
      const float angle = corner_angle(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
      sums[tangent_index(tangent_corners_[t][k], mirrored)] += angle / length * in_plane;
    }
  }
  for (Vec3f& sum : sums)
    if (const float length = sum.norm(); length > 0) sum /= length;
  return sums;
}

/// Colours of vertices.
void ColoredSurface::color(const RayHit& hit, Appearance& appearance) const {
  const SurfaceColoring& coloring = mesh_.coloring;
  const Triangle& vertices = mesh_.triangles[static_cast<std::size_t>(hit.triangle)];
  if (!coloring.heat.empty())
    appearance.base_color = heat_color(interpolated(coloring.heat, vertices, hit));
  else if (!coloring.colors.empty())
    appearance.base_color = interpolated(coloring.colors, vertices, hit);
}

/// The normal that a normal map's texel stands for, on the side of `outward`.
Vec3f ColoredSurface::mapped_normal(const RayHit& hit, const Ray& ray, bool mirrored, const Vec3f& texel,
                                    const Vec3f& outward) const {
  if (texel.x() == 0 && texel.y() == 0) return outward;
  const Triangle& corners = tangent_corners_[static_cast<std::size_t>(hit.triangle)];
  const auto [step, share] = moment_of(mesh_, ray);
  const auto tangent_at = [&](std::size_t time) {
    const auto corner = [&](std::size_t k) { return tangents_[time][tangent_index(corners[k], mirrored)]; };
    return interpolated<Vec3f>(corner(0), corner(1), corner(2), hit);
  };
  Vec3f tangent = tangent_at(step);
  if (share > 0) tangent += share * (tangent_at(step + 1) - tangent);
  tangent -= tangent.dot(outward) * outward;
  const float length = tangent.norm();
  if (!(length > 1e-6f)) return outward;
  tangent /= length;
  const Vec3f bitangent = (mirrored ? -1.0f : 1.0f) * outward.cross(tangent);
  const float strength = mesh_.coloring.maps.normal_strength;
  const Vec3f n = strength * (texel.x() * tangent + texel.y() * bitangent) + texel.z() * outward;
  const float norm = n.norm();
  return norm > 1e-6f ? Vec3f(n / norm) : outward;
}

void ColoredSurface::bend(const RayHit& hit, const Ray& ray, const TextureGradients& gradients,
                          const TextureFootprint& footprint, SurfacePoint& point) const {
  const TextureMaps& maps = mesh_.coloring.maps;
  const float side = point.inside ? -1.0f : 1.0f;
  Vec3f normal = side * point.shading_normal;
  if (maps.normal) {
    const bool mirrored = is_mirrored(gradients, side * point.geometric_normal);
    normal = mapped_normal(hit, ray, mirrored, look_up(*maps.normal, maps.wrap, footprint), normal);
  }
  if (maps.bump) {
    // Mikkelsen, Bump Mapping Unparametrized Surfaces on the GPU, 2010: less the gradient of the height along the
    // surface.
    const Vec2f slope = maps.bump_height * look_up_slope(*maps.bump, maps.wrap, footprint);
    Vec3f uphill = slope.x() * gradients.du + slope.y() * gradients.dv;
    uphill -= uphill.dot(normal) * normal;
    if (!uphill.isZero(0)) normal = (normal - uphill).normalized();
  }
  normal *= side;
  if (normal != point.shading_normal)
    point.shading_normal = valid_normal(normal, point.shading_normal, point.geometric_normal, -ray.direction);
}

Bsdf ColoredSurface::material(const Appearance& appearance, bool textured, bool blurred) const {
  if (!textured) return {appearance, blurred ? plain_blurred_ : plain_};
  const std::vector<AlbedoTables>& tables = blurred && !blurred_tables_.empty() ? blurred_tables_ : tables_;
  const float place = std::max(0.0f, (appearance.roughness - first_roughness_) / roughness_step_);
  const std::size_t k = std::min(static_cast<std::size_t>(place), tables.size() - 1);
  if (k + 1 == tables.size()) return {appearance, tables[k]};
  return {appearance, AlbedoTables::between(tables[k], tables[k + 1], place - static_cast<float>(k))};
}

Bsdf ColoredSurface::at(const RayHit& hit, const Ray& ray, float width, bool blurred, SurfacePoint& point) const {
  const SurfaceColoring& coloring = mesh_.coloring;
  const TextureMaps& maps = coloring.maps;
  Appearance appearance = mesh_.appearance;
  bool rough = false;  // the roughness is the map's
  if (!maps.empty() && has_coordinates(coloring.triangles[static_cast<std::size_t>(hit.triangle)])) {
    const Triangle& corners = coloring.triangles[static_cast<std::size_t>(hit.triangle)];
    const TextureGradients gradients(hit_corners(mesh_, hit, ray), coordinates_of(corners));
    const TextureFootprint footprint = cone_footprint(gradients, interpolated(coordinates_, corners, hit),
                                                      ray.direction, point.geometric_normal, width);
    if (maps.base_color) appearance.base_color = look_up(*maps.base_color, maps.wrap, footprint);
    rough = maps.roughness != nullptr;
    if (rough) appearance.roughness = look_up(*maps.roughness, maps.wrap, footprint);
    if (maps.normal || maps.bump) bend(hit, ray, gradients, footprint, point);
  }
  color(hit, appearance);
  if (blurred) appearance.roughness = std::max(appearance.roughness, least_roughness_);
  return material(appearance, rough, blurred);
}

}  // namespace softreel
