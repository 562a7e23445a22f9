#include "core/mesh/corner_normals.h"

#include "core/base/number_table.h"
#include "core/mesh/disjoint_sets.h"
#include "core/mesh/edge_angles.h"

namespace softreel {
namespace {

/// Radians by which equal angles may differ: positions of files are in single precision.
constexpr double kAngleRounding = 1e-5;
/// An edge of more triangles than this connects none of them: no surface goes on there.
constexpr std::size_t kMostAtEdge = 16;

/// Corner k of triangle t is corner 3 t + k.
Index corner_at(const FacingTriangles& facing, Index triangle, Index vertex) {
  const Triangle& corners = facing.triangles[at(triangle)];
  return 3 * triangle + (corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2);
}

/// The corners that smooth edges connect about a vertex.
DisjointSets connect_corners(const FacingTriangles& facing, double crease) {
  DisjointSets parts(3 * facing.triangles.size());
  for_each_edge(facing.half_edges, [&](std::span<const HalfEdge> edge) {
    if (edge.size() > kMostAtEdge) return;
    for (std::size_t i = 0; i < edge.size(); ++i)
      for (std::size_t j = i + 1; j < edge.size(); ++j) {
        const Vec3 &a = facing.directions[at(edge[i].triangle)], &b = facing.directions[at(edge[j].triangle)];
        if (a.isZero(0) || b.isZero(0) || angle_between(a, b) > crease + kAngleRounding) continue;
        for (const Index vertex : {edge[i].low, edge[i].high})
          parts.join(corner_at(facing, edge[i].triangle, vertex), corner_at(facing, edge[j].triangle, vertex));
      }
  });
  return parts;
}

/// The smooth parts at the vertices of a surface, by number.
struct SmoothParts {
  std::vector<Index> of_corner;       ///< -1: of a triangle without direction
  std::vector<std::uint8_t> meet_at;  ///< per welded vertex whether it has several
  bool any_meet = false;
  Index count = 0;
};

SmoothParts number_parts(const FacingTriangles& facing, DisjointSets sets) {
  SmoothParts parts;
  parts.of_corner.assign(3 * facing.triangles.size(), -1);
  parts.meet_at.assign(facing.weld.size(), 0);
  std::vector<Index> part_of_vertex(facing.weld.size(), -1);
  for (std::size_t c = 0; c < parts.of_corner.size(); ++c) {
    if (facing.directions[c / 3].isZero(0)) continue;
    const Index root = sets.root(static_cast<Index>(c));  // the smallest: it has its number already
    parts.of_corner[c] = at(root) == c ? parts.count++ : parts.of_corner[at(root)];
    const Index vertex = facing.triangles[c / 3][c % 3];
    Index& known = part_of_vertex[at(vertex)];
    if (known < 0) known = parts.of_corner[c];
    if (known == parts.of_corner[c]) continue;
    parts.meet_at[at(vertex)] = 1;
    parts.any_meet = true;
  }
  return parts;
}

/// Unit normals of the parts, angle-weighted; zero where there is none.
std::vector<Vec3> normals_of(const SmoothParts& parts, const FacingTriangles& facing, const SurfaceMesh& mesh) {
  std::vector<Vec3> sums(at(parts.count), Vec3::Zero());
  for (std::size_t c = 0; c < parts.of_corner.size(); ++c) {
    if (parts.of_corner[c] < 0) continue;
    const Triangle& triangle = mesh.triangles[c / 3];
    const auto corner = [&](std::size_t k) -> const Vec3& { return mesh.positions[at(triangle[k % 3])]; };
    const double angle = angle_between(corner(c + 1) - corner(c), corner(c + 2) - corner(c));
    sums[at(parts.of_corner[c])] += angle * facing.directions[c / 3];
  }
  for (Vec3& sum : sums)
    if (const double length = sum.norm(); length > 0) sum /= length;
  return sums;
}

/// Hands out numbers of normals for vertices and the parts at them.
class NormalNumbers {
 public:
  NormalNumbers(std::vector<Vec3> vertex_normals, const std::vector<Vec3>& part_normals)
      : part_normals_(part_normals), part_of_(vertex_normals.size(), -1) {
    result_.normals = std::move(vertex_normals);
    for (std::size_t v = 0; v < result_.normals.size(); ++v) result_.vertex_of.push_back(static_cast<Index>(v));
  }

  /// The first part that is asked for at a vertex has the vertex's own number.
  Index of(Index vertex, Index part) {
    if (part_of_[at(vertex)] < 0) set(vertex, part);
    if (part_of_[at(vertex)] == part) return vertex;
    const auto is_wanted = [&](Index n) { return result_.vertex_of[at(n)] == vertex && part_of_[at(n)] == part; };
    const Index known = added_.find(hash(vertex, part), is_wanted);
    return known >= 0 ? known : add(vertex, part);
  }

  CornerNormals take() { return std::move(result_); }

 private:
  static std::uint64_t hash(Index vertex, Index part) {
    return (static_cast<std::uint64_t>(vertex) << 32 | static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15ULL;
  }
  void set(Index number, Index part) {
    part_of_[at(number)] = part;
    if (const Vec3& normal = part_normals_[at(part)]; !normal.isZero(0)) result_.normals[at(number)] = normal;
  }
  Index add(Index vertex, Index part) {
    const auto number = static_cast<Index>(result_.normals.size());
    result_.vertex_of.push_back(vertex);
    result_.normals.push_back(result_.normals[at(vertex)]);
    part_of_.push_back(part);
    set(number, part);
    added_.insert(number, [&](Index n) { return hash(result_.vertex_of[at(n)], part_of_[at(n)]); });
    return number;
  }

  const std::vector<Vec3>& part_normals_;
  CornerNormals result_;
  std::vector<Index> part_of_;  ///< per normal; -1: a vertex that has asked for none
  NumberTable added_;
};

}  // namespace

CornerNormals corner_normals(const SurfaceMesh& mesh, double crease) {
  const FacingTriangles facing = facing_triangles(mesh);
  const SmoothParts parts = number_parts(facing, connect_corners(facing, crease));
  if (!parts.any_meet) return {};
  const std::vector<Vec3> part_normals = normals_of(parts, facing, mesh);
  NormalNumbers numbers(vertex_normals(mesh, mesh.positions), part_normals);
  std::vector<Triangle> triangles = mesh.triangles;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index part = parts.of_corner[3 * t + k];
      if (part >= 0 && parts.meet_at[at(facing.triangles[t][k])] != 0)
        triangles[t][k] = numbers.of(triangles[t][k], part);
    }
  CornerNormals result = numbers.take();
  result.triangles = std::move(triangles);
  return result;
}

}  // namespace softreel
