#include "core/mesh/edge_angles.h"

#include <algorithm>
#include <cmath>

namespace softreel {
namespace {

/// Twice the area over the square of the longest edge: below this the normal is rounding of single precision.
constexpr double kNeedle = 1e-6;

using TrianglePoints = std::array<Vec3, 3>;

TrianglePoints points_of(const SurfaceMesh& mesh, const Triangle& triangle) {
  return {mesh.positions[at(triangle[0])], mesh.positions[at(triangle[1])], mesh.positions[at(triangle[2])]};
}

/// Of the edges from corner k to the next.
std::array<double, 3> squared_edges(const TrianglePoints& p) {
  return {(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()};
}

/// Zero for a needle.
Vec3 own_direction(const TrianglePoints& p) {
  const Vec3 area = (p[1] - p[0]).cross(p[2] - p[0]);
  const std::array<double, 3> edges = squared_edges(p);
  const double length = area.norm();
  return length > kNeedle * *std::max_element(edges.begin(), edges.end()) ? Vec3(area / length) : Vec3(Vec3::Zero());
}

/// Whether a side is the longest edge of its triangle.
bool is_longest(const SurfaceMesh& mesh, const FacingTriangles& facing, const HalfEdge& side) {
  const std::array<double, 3> edges = squared_edges(points_of(mesh, mesh.triangles[at(side.triangle)]));
  const auto longest = static_cast<std::size_t>(std::max_element(edges.begin(), edges.end()) - edges.begin());
  const Triangle& t = facing.triangles[at(side.triangle)];
  const auto [low, high] = std::minmax(t[longest], t[(longest + 1) % 3]);
  return low == side.low && high == side.high;
}

void lend_to_needles(const SurfaceMesh& mesh, FacingTriangles& facing) {
  const std::vector<Vec3> own = facing.directions;
  for_each_edge(facing.half_edges, [&](std::span<const HalfEdge> edge) {
    const auto has_own = [&](const HalfEdge& side) { return !own[at(side.triangle)].isZero(0); };
    const auto lender = std::find_if(edge.begin(), edge.end(), has_own);
    if (lender == edge.end()) return;
    for (const HalfEdge& side : edge)
      if (!has_own(side) && is_longest(mesh, facing, side))
        facing.directions[at(side.triangle)] = own[at(lender->triangle)];
  });
}

}  // namespace

FacingTriangles facing_triangles(const SurfaceMesh& mesh) {
  FacingTriangles facing;
  facing.weld = mesh.joined.empty() ? weld_positions(mesh.positions) : mesh.joined;
  facing.triangles = welded_triangles(mesh.triangles, facing.weld);
  facing.half_edges = sorted_half_edges(facing.triangles);
  facing.directions.assign(mesh.triangles.size(), Vec3::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (!is_collapsed(facing.triangles[t])) facing.directions[t] = own_direction(points_of(mesh, mesh.triangles[t]));
  lend_to_needles(mesh, facing);
  return facing;
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

EdgeLengths measure_edges(const SurfaceMesh& mesh, double bent, double sharp) {
  EdgeLengths lengths;
  const FacingTriangles facing = facing_triangles(mesh);
  for_each_edge(facing.half_edges, [&](std::span<const HalfEdge> edge) {
    if (edge.size() != 2) return;
    const Vec3 &a = facing.directions[at(edge[0].triangle)], &b = facing.directions[at(edge[1].triangle)];
    if (a.isZero(0) || b.isZero(0)) return;
    const double length = (mesh.positions[at(edge[0].high)] - mesh.positions[at(edge[0].low)]).norm();
    const double angle = angle_between(a, b);
    lengths.all += length;
    if (angle > sharp)
      lengths.sharp += length;
    else if (angle > bent)
      lengths.bent += length;
  });
  return lengths;
}

}  // namespace softreel
