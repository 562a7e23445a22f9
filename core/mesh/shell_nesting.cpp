#include "core/mesh/shell_nesting.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/mesh_topology.h"

namespace softreel {
namespace {

struct Shell {
  Index piece;
  std::vector<Triangle> triangles;
  Bounds bounds;
  double volume6 = 0;
  bool wanted_outward = true;
};

std::vector<Shell> collect_shells(const SurfaceMesh& mesh, const std::vector<Index>& piece,
                                  const std::vector<char>& closed) {
  std::vector<Shell> shells;
  std::vector<Index> shell_of(closed.size(), -1);
  for (std::size_t p = 0; p < closed.size(); ++p) {
    if (closed[p] == 0) continue;
    shell_of[p] = static_cast<Index>(shells.size());
    shells.push_back({static_cast<Index>(p), {}, {}});
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Index s = shell_of[static_cast<std::size_t>(piece[t])];
    if (s < 0) continue;
    Shell& shell = shells[static_cast<std::size_t>(s)];
    shell.triangles.push_back(mesh.triangles[t]);
    for (const Index v : mesh.triangles[t]) shell.bounds.add(mesh.positions[static_cast<std::size_t>(v)]);
  }
  for (Shell& shell : shells) {
    const Vec3 center = shell.bounds.center();
    const auto at = [&](Index v) -> Vec3 { return mesh.positions[static_cast<std::size_t>(v)] - center; };
    for (const Triangle& t : shell.triangles) shell.volume6 += signed_volume6(at(t[0]), at(t[1]), at(t[2]));
  }
  return shells;
}

bool box_contains(const Bounds& outer, const Bounds& inner) {
  return (outer.min.array() <= inner.min.array()).all() && (outer.max.array() >= inner.max.array()).all();
}

/// Parity of the crossings of a ray from `from`. Its direction is a fixed one that no modelled face or edge has.
bool is_inside(const SurfaceMesh& mesh, const Shell& shell, const Vec3& from) {
  const Vec3 direction = Vec3(0.5377, 0.2361, 0.8093).normalized();
  const Vec3 u = direction.unitOrthogonal(), v = direction.cross(u);
  bool inside = false;
  for (const Triangle& triangle : shell.triangles) {
    std::array<Vec3, 3> p;  // u, v: in the plane across the ray; z: along it
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 d = mesh.positions[static_cast<std::size_t>(triangle[k])] - from;
      p[k] = Vec3(u.dot(d), v.dot(d), direction.dot(d));
    }
    std::array<double, 3> w;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
      w[k] = a.x() * b.y() - a.y() * b.x();
    }
    const bool left = w[0] >= 0 && w[1] >= 0 && w[2] >= 0, right = w[0] < 0 && w[1] < 0 && w[2] < 0;
    if (!left && !right) continue;
    const double sum = w[0] + w[1] + w[2];
    if (sum != 0 && (w[0] * p[0].z() + w[1] * p[1].z() + w[2] * p[2].z()) / sum > 0) inside = !inside;
  }
  return inside;
}

/// A shell is inside of another if most of a few points spread over it are.
bool contains_shell(const SurfaceMesh& mesh, const Shell& outer, const Shell& inner) {
  if (!box_contains(outer.bounds, inner.bounds)) return false;
  int inside = 0;
  const std::size_t n = inner.triangles.size();
  for (const std::size_t t : {std::size_t{0}, n / 2, n - 1}) {
    Vec3 centroid = Vec3::Zero();
    for (const Index v : inner.triangles[t]) centroid += mesh.positions[static_cast<std::size_t>(v)] / 3;
    inside += is_inside(mesh, outer, centroid) ? 1 : 0;
  }
  return inside >= 2;
}

}  // namespace

std::vector<char> find_inverted_shells(const SurfaceMesh& mesh, const std::vector<Index>& piece,
                                       const std::vector<char>& closed) {
  std::vector<Shell> shells = collect_shells(mesh, piece, closed);
  // Larger shells first: a container comes before what it contains, and the last container found is the innermost.
  std::stable_sort(shells.begin(), shells.end(),
                   [](const Shell& a, const Shell& b) { return std::abs(a.volume6) > std::abs(b.volume6); });
  std::vector<char> inverted(closed.size(), 0);
  for (std::size_t s = 0; s < shells.size(); ++s) {
    for (std::size_t outer = s; outer-- > 0;) {
      if (!contains_shell(mesh, shells[outer], shells[s])) continue;
      const bool alike = (shells[outer].volume6 > 0) == (shells[s].volume6 > 0);
      shells[s].wanted_outward = shells[outer].wanted_outward == alike;
      break;
    }
    if (shells[s].volume6 == 0) continue;
    inverted[static_cast<std::size_t>(shells[s].piece)] = (shells[s].volume6 > 0) != shells[s].wanted_outward;
  }
  return inverted;
}

}  // namespace softreel
