/// A surface as its file has it (vertex order, polygons, texture coordinates, groups) and as triangles for work.
#pragma once

#include <string>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// A named set of vertices: an OBJ group or object, a mesh or material of a glTF file.
struct VertexGroup {
  std::string name;
  std::vector<Index> vertices;  ///< sorted, unique
};

/// Polygons as the file has them, but for the winding of those that repair_mesh turned; polygon p owns the corners
/// [offsets[p], offsets[p + 1]).
struct PolygonList {
  std::vector<Index> offsets{0};         ///< polygons + 1
  std::vector<Index> corner_vertices;    ///< index into positions, per corner
  std::vector<Index> corner_textures;    ///< into texture_coordinates, per corner, -1: none; empty if the file has none
  std::vector<Index> polygon_groups;     ///< index into groups, per polygon, -1 for none; empty if the file has none
  std::vector<Index> polygon_materials;  ///< the same of its material, which is a group too; empty if none has any

  std::size_t size() const { return offsets.size() - 1; }
};

/// A triangle mesh over the file's own vertices. Vertex v is vertex v of the file (design 4.7), used by a face or not.
///
/// Triangles are counter-clockwise seen from outside once the mesh was repaired. Duplicate positions are kept: whoever
/// needs connectivity welds them on the way (`weld_positions`).
struct SurfaceMesh {
  std::vector<Vec3> positions;            ///< vertices x 3, m after placement, file units before
  std::vector<Vec2> texture_coordinates;  ///< as in the file
  std::vector<Vec3f> colors;              ///< per vertex, linear RGB; empty if the file has none
  PolygonList polygons;                   ///< as in the file, see there
  std::vector<VertexGroup> groups;

  /// Per vertex the one that it counts as where triangles are connected; empty: the first of exactly its position.
  /// Filled by repair_mesh where rims nearly meet.
  std::vector<Index> joined;

  std::vector<Triangle> triangles;          ///< polygons cut into triangles
  std::vector<Index> triangle_polygon;      ///< polygon of each triangle
  std::vector<Triangle> triangle_textures;  ///< per triangle corner, -1 for none; empty if the file has none
};

/// Axis-aligned box; of no points: min > max.
struct Bounds {
  Vec3 min = Vec3::Constant(1e300);
  Vec3 max = Vec3::Constant(-1e300);

  Vec3 size() const { return max - min; }
  Vec3 center() const { return 0.5 * (min + max); }
  double diagonal() const { return size().norm(); }
  bool empty() const { return (min.array() > max.array()).any(); }
  void add(const Vec3& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
};

/// Box of the vertices that triangles use; far unused vertices do not count.
Bounds used_bounds(const SurfaceMesh& mesh);

/// Per vertex whether a triangle uses it; files may hold others beside.
std::vector<bool> used_vertices(const SurfaceMesh& mesh);

/// Vertex normals: angle-weighted over the triangles of all vertices that count as one (`joined`), so that texture
/// seams and rims that repair closed do not show. positions: as mesh.positions, in any deformed state. Unit length; (0,
/// 1, 0) where undefined.
std::vector<Vec3> vertex_normals(const SurfaceMesh& mesh, const std::vector<Vec3>& positions);

/// For each vertex the first vertex with exactly the same position (itself if there is none before it).
std::vector<Index> weld_positions(const std::vector<Vec3>& positions);

}  // namespace softreel
