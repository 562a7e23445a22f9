#include "render/preview/corner_vertices.h"

#include "core/base/check.h"

namespace softreel {
namespace {

/// The coordinates of a triangle's corners; -1 for all unless it has all.
Triangle coordinates_of(const MotionMesh& mesh, std::size_t t) {
  const SurfaceColoring& coloring = mesh.coloring;
  if (coloring.triangles.empty()) return {-1, -1, -1};
  const Triangle& corners = coloring.triangles[t];
  return corners[0] >= 0 && corners[1] >= 0 && corners[2] >= 0 ? corners : Triangle{-1, -1, -1};
}

/// Hands out vertices for what the corners of a mesh share. The few of one mesh vertex are a chain.
class SharedCorners {
 public:
  SharedCorners(std::size_t mesh_vertices, CornerVertices& result) : first_(mesh_vertices, -1), result_(result) {}

  Index of(Index vertex, Index normal, Index coordinate) {
    Index* link = &first_[static_cast<std::size_t>(vertex)];
    while (*link >= 0) {
      const auto here = static_cast<std::size_t>(*link);
      if (result_.coordinate_of[here] == coordinate && result_.normal_of[here] == normal) return *link;
      link = &next_[here];
    }
    const auto added = static_cast<Index>(next_.size());
    *link = added;
    next_.push_back(-1);
    result_.vertex_of.push_back(vertex);
    result_.normal_of.push_back(normal);
    result_.coordinate_of.push_back(coordinate);
    return added;
  }

 private:
  std::vector<Index> first_, next_;
  CornerVertices& result_;
};

}  // namespace

CornerVertices split_at_seams(const MotionMesh& mesh) {
  CornerVertices result;
  result.triangles.reserve(mesh.triangles.size());
  SharedCorners shared(mesh.times.back().positions.size(), result);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle coordinates = coordinates_of(mesh, t), &normals = mesh.corners_of_normals()[t];
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = shared.of(mesh.triangles[t][k], normals[k], coordinates[k]);
    result.triangles.push_back(corners);
  }
  return result;
}

CornerVertices split_all_corners(const MotionMesh& mesh) {
  CornerVertices result;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle coordinates = coordinates_of(mesh, t);
    const auto first = static_cast<Index>(3 * t);
    result.triangles.push_back({first, first + 1, first + 2});
    for (std::size_t k = 0; k < 3; ++k) {
      result.vertex_of.push_back(mesh.triangles[t][k]);
      result.normal_of.push_back(mesh.corners_of_normals()[t][k]);
      result.coordinate_of.push_back(coordinates[k]);
    }
  }
  return result;
}

std::vector<Vec3f> edge_weights(const MotionMesh& mesh) {
  CHECK(mesh.lines.has_value());
  const std::vector<std::uint8_t>& drawn = mesh.lines->drawn;
  std::vector<Vec3f> weights;
  weights.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Vec3f raised = Vec3f::Zero();
    for (int edge = 0; edge < 3; ++edge)
      if (!drawn.empty() && (drawn[t] >> edge & 1) == 0) raised[(edge + 2) % 3] = 1;
    for (int k = 0; k < 3; ++k) weights.emplace_back(raised + Vec3f::Unit(k));
  }
  return weights;
}

std::vector<Vec3f> face_normals(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles) {
  std::vector<Vec3f> normals;
  normals.reserve(3 * triangles.size());
  const auto at = [&](Index p) -> const Vec3f& { return positions[static_cast<std::size_t>(p)]; };
  for (const Triangle& t : triangles)
    normals.insert(normals.end(), 3, (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).normalized());
  return normals;
}

}  // namespace softreel
