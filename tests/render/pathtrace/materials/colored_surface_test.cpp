#include "render/pathtrace/materials/colored_surface.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/base/srgb.h"
#include "render/image/texture_pyramid.h"
#include "render/pathtrace/rays/sampling.h"
#include "render/scene/color_map.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// A square of 2 m, coordinates 0 to 1, u along x, v along -z.
MotionMesh unit_square(const Appearance& appearance) {
  MotionMesh mesh = square(1, 0, appearance);
  mesh.coloring.coordinates = {Vec2f(0, 0), Vec2f(1, 0), Vec2f(1, 1), Vec2f(0, 1)};
  mesh.coloring.triangles = mesh.triangles;
  return mesh;
}

template <typename Texel>
auto constant(const Texel& value) {
  return std::make_shared<const TexturePyramid<Texel>>(make_pyramid(4, 4, std::vector<Texel>(16, value)));
}

struct Seen {
  Bsdf bsdf;
  SurfacePoint point;
};

/// What a ray straight down (or `direction`) sees at a place of triangle 0.
Seen look(const MotionMesh& mesh, const Vec3f& direction = Vec3f(0, -1, 0), bool blurred = false, Index triangle = 0) {
  AlbedoCache tables;
  const ColoredSurface surface(mesh, 0.4f, tables);
  RayHit hit;
  hit.mesh = 0;
  hit.triangle = triangle;
  hit.u = 0.3f;
  hit.v = 0.2f;
  hit.distance = 1;
  Ray ray;
  ray.direction = direction.normalized();
  SurfacePoint point = surface_point(mesh, hit, ray);
  const Bsdf bsdf = surface.at(hit, ray, 0.01f, blurred, point);
  return {bsdf, point};
}

/// Equal where it matters: in many directions, bit for bit.
void expect_same(const Bsdf& a, const Bsdf& b) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> any(0, 1);
  for (int k = 0; k < 50; ++k) {
    const Vec3f o = cosine_hemisphere(Vec2f(any(random), any(random))),
                i = cosine_hemisphere(Vec2f(any(random), any(random)));
    const BsdfValue x = a.evaluate(o, i, false), y = b.evaluate(o, i, false);
    EXPECT_EQ(x.value, y.value);
    EXPECT_EQ(x.pdf, y.pdf);
  }
  EXPECT_EQ(a.albedo(), b.albedo());
}

Appearance glossy(const Vec3f& color, float roughness, float metallic) {
  Appearance appearance;
  appearance.base_color = color;
  appearance.roughness = roughness;
  appearance.metallic = metallic;
  return appearance;
}

TEST(ColoredSurface, ConstantTexturesAreTheConstantMaterialBitForBit) {
  const Vec3f color(0.3f, 0.62f, 0.117f);
  for (const float metallic : {0.0f, 1.0f}) {
    MotionMesh mesh = unit_square(glossy(Vec3f::Zero(), 0.9f, metallic));
    mesh.coloring.maps.base_color = constant(color);
    mesh.coloring.maps.roughness = constant(0.27f);
    expect_same(look(mesh).bsdf, Bsdf(glossy(color, 0.27f, metallic)));
    expect_same(look(mesh, Vec3f(0, -1, 0), true).bsdf, Bsdf(glossy(color, 0.4f, metallic)));
  }
}

TEST(ColoredSurface, ColoursOfVerticesAndHeatAreInterpolated) {
  MotionMesh mesh = square(1, 0, matte(0.5f));
  mesh.coloring.colors = {Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 0, 1), Vec3f(0, 0, 0)};
  EXPECT_TRUE(look(mesh).bsdf.albedo().isApprox(Vec3f(0.5f, 0.3f, 0.2f)));
  mesh.coloring.heat = {0, 1, 0.5f, 0};
  EXPECT_TRUE(look(mesh).bsdf.albedo().isApprox(heat_color(0.4f), 1e-5f)) << "values, not colours, are interpolated";
}

TEST(ColoredSurface, TrianglesWithoutCoordinatesKeepTheMaterial) {
  MotionMesh mesh = unit_square(matte(0.5f));
  mesh.coloring.maps.base_color = constant(Vec3f(1, 0, 0));
  mesh.coloring.triangles[1] = {-1, -1, -1};
  EXPECT_EQ(look(mesh).bsdf.albedo(), Vec3f(1, 0, 0));
  EXPECT_EQ(look(mesh, Vec3f(0, -1, 0), false, 1).bsdf.albedo(), Vec3f(0.5f, 0.5f, 0.5f));
}

TEST(ColoredSurface, RoughnessBetweenTablesIsNearTheExactMaterial) {
  for (const float roughness : {0.113f, 0.41f, 0.77f}) {
    MotionMesh mesh = unit_square(glossy(Vec3f(0.9f, 0.6f, 0.3f), 0.5f, 1));
    std::vector<float> texels(64 * 64, roughness);
    texels[63] = 0.05f;  // far from the place that is looked at
    texels[0] = 0.95f;
    mesh.coloring.maps.roughness = std::make_shared<const DataTexture>(make_pyramid(64, 64, std::move(texels)));
    const Bsdf exact(glossy(Vec3f(0.9f, 0.6f, 0.3f), roughness, 1)), seen = look(mesh).bsdf;
    for (const float tilt : {0.1f, 0.6f, 1.3f}) {
      const Vec3f o(std::sin(tilt), 0, std::cos(tilt)), i(-o.x(), 0, o.z());
      const float wanted = exact.evaluate(o, i, false).value.x();
      EXPECT_NEAR(seen.evaluate(o, i, false).value.x(), wanted, 2e-3f * wanted) << roughness << " " << tilt;
    }
  }
}

TEST(ColoredSurface, AFlatNormalMapIsNone) {
  const MotionMesh plain = unit_square(matte(0.5f));
  MotionMesh mapped = plain;
  mapped.coloring.maps.normal = constant(Vec3f(0, 0, 1));
  const Vec3f slant(0.3f, -1, 0.2f);
  EXPECT_EQ(look(mapped, slant).point.shading_normal, look(plain, slant).point.shading_normal);
  MotionMesh bumpy = plain;
  bumpy.coloring.maps.bump = constant(0.7f);
  EXPECT_EQ(look(bumpy, slant).point.shading_normal, Vec3f(0, 1, 0));
}

TEST(ColoredSurface, NormalMapsTurnTheNormalAlongTheTexturesAxes) {
  MotionMesh mesh = unit_square(matte(0.5f));
  mesh.coloring.maps.normal = constant(Vec3f(0.6f, 0, 0.8f));
  EXPECT_TRUE(look(mesh).point.shading_normal.isApprox(Vec3f(0.6f, 0.8f, 0), 1e-5f)) << "u runs along x";
  mesh.coloring.maps.normal = constant(Vec3f(0, 0.6f, 0.8f));
  EXPECT_TRUE(look(mesh).point.shading_normal.isApprox(Vec3f(0, 0.8f, -0.6f), 1e-5f)) << "v runs along -z";
  mesh.coloring.maps.normal_strength = 0;
  EXPECT_TRUE(look(mesh).point.shading_normal.isApprox(Vec3f(0, 1, 0), 1e-6f));
  // Mirrored coordinates: u runs along -x, v as before.
  mesh.coloring.maps.normal_strength = 1;
  for (Vec2f& c : mesh.coloring.coordinates) c.x() = -c.x();
  EXPECT_TRUE(look(mesh).point.shading_normal.isApprox(Vec3f(0, 0.8f, -0.6f), 1e-5f));
  mesh.coloring.maps.normal = constant(Vec3f(0.6f, 0, 0.8f));
  EXPECT_TRUE(look(mesh).point.shading_normal.isApprox(Vec3f(-0.6f, 0.8f, 0), 1e-5f));
}

TEST(ColoredSurface, MapsMoveWithTheSurfaceWhileTheShutterIsOpen) {
  // The square turns by 90 degrees about z between the two times: half-way, its normal and tangents lie between.
  MotionMesh mesh = unit_square(matte(0.5f));
  mesh.coloring.maps.normal = constant(Vec3f(0.6f, 0, 0.8f));
  mesh.times.push_back(mesh.times[0]);
  for (Vec3f& p : mesh.times[1].positions) p = Vec3f(-p.y(), p.x(), p.z());
  for (Vec3f& n : mesh.times[1].normals) n = Vec3f(-n.y(), n.x(), n.z());
  AlbedoCache tables;
  const ColoredSurface surface(mesh, 0.4f, tables);
  RayHit hit;
  hit.mesh = hit.triangle = 0;
  hit.u = hit.v = 0.3f;
  Ray ray;
  ray.time = 0.5f;
  const float half = std::sqrt(0.5f);
  ray.direction = Vec3f(half, -half, 0);
  SurfacePoint point = surface_point(mesh, hit, ray);
  surface.at(hit, ray, 0.01f, false, point);
  const Vec3f normal(-half, half, 0), tangent(half, half, 0);
  EXPECT_TRUE(point.shading_normal.isApprox(0.6f * tangent + 0.8f * normal, 1e-4f)) << point.shading_normal.transpose();
}

TEST(ColoredSurface, BumpsTiltTheNormalDownhill) {
  MotionMesh mesh = unit_square(matte(0.5f));
  std::vector<float> ramp;
  for (int k = 0; k < 64 * 64; ++k) ramp.push_back(static_cast<float>(k % 64) / 64);
  mesh.coloring.maps.bump = std::make_shared<const DataTexture>(make_pyramid(64, 64, std::move(ramp)));
  mesh.coloring.maps.bump_height = 0.5f;  // over the square's 2 m: a slope of a quarter
  const Vec3f normal = look(mesh).point.shading_normal;
  EXPECT_TRUE(normal.isApprox(Vec3f(-0.25f, 1, 0).normalized(), 2e-3f)) << normal.transpose();
}

TEST(ColoredSurface, NormalsOfASphereAreSmoothAcrossItsTriangles) {
  // The same tilt everywhere: neighbouring triangles of a coarse sphere must agree at their common edge.
  MotionMesh mesh = sphere(Vec3f::Zero(), 1, matte(0.5f), 12);
  const auto columns = 24;
  for (std::size_t v = 0; v < mesh.times[0].positions.size(); ++v)
    mesh.coloring.coordinates.emplace_back(static_cast<float>(v % columns) / columns,
                                           1 - static_cast<float>(v / columns) / 12);
  // Each corner with a coordinate of its own, as PLY files have them.
  std::vector<Vec2f> own;
  for (const Triangle& vertices : mesh.triangles) {
    const auto first = static_cast<Index>(own.size());
    mesh.coloring.triangles.push_back({first, first + 1, first + 2});
    for (const Index v : vertices) own.push_back(mesh.coloring.coordinates[static_cast<std::size_t>(v)]);
  }
  mesh.coloring.coordinates = std::move(own);
  mesh.coloring.maps.normal = constant(Vec3f(0.3f, 0.3f, 0.9f));
  AlbedoCache tables;
  const ColoredSurface surface(mesh, 0, tables);
  int compared = 0;
  for (std::size_t t = 0; t + 1 < mesh.triangles.size(); t += 2) {  // the two of a quadrangle share the edge d, b
    const Triangle &first = mesh.triangles[t], &second = mesh.triangles[t + 1];
    if (first[1] != second[1] || first[2] != second[0]) continue;
    if (first[0] % columns == columns - 1 || first[0] < columns) continue;  // the seam and the pole
    RayHit hit;
    hit.mesh = 0;
    const auto normal_at = [&](std::size_t triangle, float u, float v) {
      hit.triangle = static_cast<Index>(triangle);
      hit.u = u;
      hit.v = v;
      Ray ray;
      ray.direction = -mesh.times[0].normals[static_cast<std::size_t>(first[1])];
      SurfacePoint point = surface_point(mesh, hit, ray);
      surface.at(hit, ray, 0.01f, false, point);
      return point.shading_normal;
    };
    EXPECT_LT((normal_at(t, 0.5f, 0.5f) - normal_at(t + 1, 0.5f, 0)).norm(), 1e-4f) << t;
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST(ValidNormal, KeepsGoodNormalsAndBendsOthersUntilTheMirroredViewIsAbove) {
  const Vec3f up(0, 1, 0);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> any(-1, 1);
  int bent = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec3f view = Vec3f(any(random), 0.5f + 0.49f * any(random), any(random)).normalized();
    const Vec3f wanted = Vec3f(any(random), any(random), any(random)).normalized();
    const Vec3f normal = valid_normal(wanted, up, up, view);
    EXPECT_NEAR(normal.norm(), 1, 1e-5f);
    EXPECT_GT(normal.dot(view), 0);
    EXPECT_GT((2 * normal.dot(view) * normal - view).dot(up), 0);
    if (normal != wanted) ++bent;
  }
  EXPECT_GT(bent, 500);
  EXPECT_LT(bent, 1990);
  EXPECT_EQ(valid_normal(Vec3f(0.1f, 0.9f, 0).normalized(), up, up, up), Vec3f(0.1f, 0.9f, 0).normalized());
}

}  // namespace
}  // namespace softreel
