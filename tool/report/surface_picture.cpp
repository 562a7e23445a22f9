#include "tool/report/surface_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.h"
#include "core/mesh/mesh_damage.h"

namespace softreel {
namespace {

const Vec3f kSurface(0.24f, 0.38f, 0.54f), kTurned(0.42f, 0.10f, 0.50f), kLine(0.035f, 0.06f, 0.09f);
const Vec3f kBoundary(0.80f, 0.03f, 0.03f), kNonManifold(0.95f, 0.38f, 0.02f), kFlipped(0.50f, 0.05f, 0.60f);
constexpr float kLineWidth = 1.25f;   ///< pixels
constexpr float kTubeRadius = 2e-3f;  ///< of the box's diagonal

/// Sides of polygons as sorted keys, so that the diagonals which cut them into triangles can be told apart.
class PolygonSides {
 public:
  explicit PolygonSides(const SurfaceMesh& mesh) {
    const PolygonList& polygons = mesh.polygons;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
      const auto begin = static_cast<std::size_t>(polygons.offsets[p]),
                 end = static_cast<std::size_t>(polygons.offsets[p + 1]);
      for (std::size_t c = begin; c < end; ++c)
        sides_.push_back(key(polygons.corner_vertices[c], polygons.corner_vertices[c + 1 < end ? c + 1 : begin],
                             static_cast<Index>(p)));
    }
    std::sort(sides_.begin(), sides_.end());
  }
  bool has(Index a, Index b, Index polygon) const {
    return std::binary_search(sides_.begin(), sides_.end(), key(a, b, polygon));
  }

 private:
  static Triangle key(Index a, Index b, Index polygon) { return {polygon, std::min(a, b), std::max(a, b)}; }
  std::vector<Triangle> sides_;
};

bool is_finite(const SurfaceMesh& mesh, const Triangle& triangle) {
  return std::all_of(triangle.begin(), triangle.end(),
                     [&](Index v) { return mesh.positions[static_cast<std::size_t>(v)].allFinite(); });
}

Bounds box_of(const SurfaceMesh& mesh) {
  Bounds box;
  for (const Triangle& triangle : mesh.triangles)
    if (is_finite(mesh, triangle))
      for (const Index v : triangle) box.add(mesh.positions[static_cast<std::size_t>(v)]);
  return box;
}

/// The triangles in two meshes: as they should be, and turned.
std::vector<MotionMesh> face_meshes(const SurfaceMesh& mesh, const MeshDamage& damage, const StudioPlace& place) {
  std::vector<MotionMesh> meshes{studio_mesh("surface", kSurface, kLine, kLineWidth),
                                 studio_mesh("turned", kTurned, kLine, kLineWidth)};
  const PolygonSides sides(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    if (!is_finite(mesh, triangle)) continue;
    const bool turned = std::binary_search(damage.turned.begin(), damage.turned.end(), static_cast<Index>(t));
    MotionMesh& to = meshes[turned ? 1 : 0];
    unsigned drawn = 0;
    for (unsigned k = 0; k < 3; ++k)
      if (sides.has(triangle[k], triangle[(k + 1) % 3], mesh.triangle_polygon[t])) drawn |= 1U << k;
    to.lines->drawn.push_back(static_cast<std::uint8_t>(drawn));
    const auto at = [&](std::size_t k) { return place(mesh.positions[static_cast<std::size_t>(triangle[k])]); };
    add_triangle(to, at(0), at(1), at(2));
  }
  return meshes;
}

/// A hexagonal tube from a to b, as much longer as it is wide: tubes that meet close the corner between them.
void add_tube(MotionMesh& mesh, Vec3f a, Vec3f b) {
  const Vec3f along = (b - a).normalized(), u = along.unitOrthogonal(), v = along.cross(u);
  a -= 0.5f * kTubeRadius * along;
  b += 0.5f * kTubeRadius * along;
  const auto spoke = [&](int k) -> Vec3f {
    const float angle = static_cast<float>(std::numbers::pi) / 3 * static_cast<float>(k);
    return kTubeRadius * (std::cos(angle) * u + std::sin(angle) * v);
  };
  for (int k = 0; k < 6; ++k) {
    const Vec3f r = spoke(k), s = spoke(k + 1);
    add_triangle(mesh, a + r, a + s, b + s);
    add_triangle(mesh, a + r, b + s, b + r);
  }
}

MotionMesh tubes(const SurfaceMesh& mesh, const std::vector<MeshDamage::Edge>& edges, const Vec3f& color,
                 const StudioPlace& place) {
  MotionMesh to = studio_mesh("edges", color, Vec3f::Zero(), 0);
  for (const auto& [low, high] : edges) {
    const Vec3 &a = mesh.positions[static_cast<std::size_t>(low)], &b = mesh.positions[static_cast<std::size_t>(high)];
    if (a.allFinite() && b.allFinite()) add_tube(to, place(a), place(b));
  }
  return to;
}

std::vector<char> damaged_vertices(const SurfaceMesh& mesh, const MeshDamage& damage) {
  std::vector<char> damaged(mesh.positions.size(), 0);
  for (const auto* edges : {&damage.boundary, &damage.non_manifold, &damage.flipped})
    for (const MeshDamage::Edge& edge : *edges)
      for (const Index v : edge) damaged[static_cast<std::size_t>(v)] = 1;
  for (const Index t : damage.turned)
    for (const Index v : mesh.triangles[static_cast<std::size_t>(t)]) damaged[static_cast<std::size_t>(v)] = 1;
  return damaged;
}

/// Where to look against: the way that most of the damage faces, as the triangles round it do; where it faces all ways,
/// or there is none, the horizontal axis along which the box is shorter.
Vec3 best_facing(const SurfaceMesh& mesh, const SurfaceMesh& repaired, const MeshDamage& damage, const Bounds& box) {
  const std::vector<char> damaged = damaged_vertices(mesh, damage);
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (const auto& [a, b, c] : repaired.triangles) {
    const auto at = [](Index v) { return static_cast<std::size_t>(v); };
    if (damaged[at(a)] + damaged[at(b)] + damaged[at(c)] == 0) continue;
    const std::vector<Vec3>& x = repaired.positions;
    const Vec3 normal = (x[at(b)] - x[at(a)]).cross(x[at(c)] - x[at(a)]);
    sum += normal;
    area += normal.norm();
  }
  constexpr double kOneWay = 0.3;
  if (sum.norm() > kOneWay * area) return sum;
  return box.size().x() < box.size().z() ? Vec3::UnitX() : Vec3::UnitZ();
}

std::string describe_shown(const MeshDamage& damage) {
  std::vector<std::string> parts;
  const auto say = [&](std::size_t count, const char* what) {
    if (count > 0) parts.push_back(fmt::format("{} {}", count, what));
  };
  say(damage.boundary.size(), "boundary edges red");
  say(damage.non_manifold.size(), "edges of more than two faces orange");
  say(damage.flipped.size(), "edges between faces that point to opposite sides purple");
  say(damage.turned.size(), "faces that point the wrong way purple");
  return parts.empty() ? "no damage" : fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace

std::string draw_surface_picture(const SurfaceMesh& mesh, const SurfaceMesh& repaired, const PictureOptions& options,
                                 const Threads& threads) {
  const Bounds box = box_of(mesh);
  if (box.empty() || !(box.diagonal() > 0))
    throw input_error(
        fmt::format("--picture {}: the mesh has no triangle that could be drawn.\n  Accepted: a surface "
                    "with extent. Correct the mesh.",
                    options.path));
  const MeshDamage damage = find_damage(mesh, repaired);
  const StudioPlace place(box);
  std::vector<MotionMesh> meshes = face_meshes(mesh, damage, place);
  meshes.push_back(tubes(mesh, damage.boundary, kBoundary, place));
  meshes.push_back(tubes(mesh, damage.non_manifold, kNonManifold, place));
  meshes.push_back(tubes(mesh, damage.flipped, kFlipped, place));
  draw_in_studio(std::move(meshes), best_facing(mesh, repaired, damage, box), options, threads);
  return fmt::format("{}: {}", options.path, describe_shown(damage));
}

}  // namespace softreel
