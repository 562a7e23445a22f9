/// Vertices as a graphics card takes them: with one texture coordinate and one normal each, or one a corner of a
/// triangle.
#pragma once

#include <vector>

#include "render/scene/scene.h"

namespace softreel {

/// Corners of triangles that share a vertex of the mesh, a normal and a texture coordinate share a vertex here.
struct CornerVertices {
  std::vector<Index> vertex_of;      ///< per vertex here, that of the mesh
  std::vector<Index> normal_of;      ///< per vertex here, among the mesh's normals, if it has any
  std::vector<Index> coordinate_of;  ///< per vertex here, in coloring.coordinates; -1: none
  std::vector<Triangle> triangles;   ///< of vertices here
};

/// Splits the vertices of a mesh where its texture coordinates or normals differ. A triangle without all three
/// coordinates has none. Linear time.
CornerVertices split_at_seams(const MotionMesh& mesh);
/// The same with three vertices of its own for each triangle, in the order of the triangles.
CornerVertices split_all_corners(const MotionMesh& mesh);

/// Barycentric weights at three corners for each triangle; that of a corner across from an edge that mesh.lines does
/// not draw is 1 larger, so that no place in the triangle is near that edge.
std::vector<Vec3f> edge_weights(const MotionMesh& mesh);

/// Unit normals of flat triangles, three times each; zero for one without area.
std::vector<Vec3f> face_normals(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles);

}  // namespace softreel
