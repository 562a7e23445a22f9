/// Meshes and marks in buffers of OpenGL. Part of the EGL back end, which alone may include it.
#pragma once

#include <cstddef>
#include <vector>

#include <epoxy/gl.h>

#include "render/preview/closed_surface.h"
#include "render/preview/corner_vertices.h"
#include "render/preview/gizmo_marks.h"
#include "render/scene/scene.h"

namespace softreel {

/// A mesh at the closing of the shutter, in buffers that live on from frame to frame.
class GpuMesh {
 public:
  GpuMesh();
  ~GpuMesh();
  GpuMesh(const GpuMesh&) = delete;
  GpuMesh& operator=(const GpuMesh&) = delete;

  /// Where it has no colour of its own at the vertices it takes base_color.
  void upload(const MotionMesh& mesh);
  void draw() const;
  /// The same without what looks away from the viewer, where a solid hides that anyway.
  void draw_outside() const;
  /// Whether there is a normal at each vertex.
  bool has_normals() const { return has_normals_; }

 private:
  /// Places of attributes in the shaders, and of their buffers.
  enum Attribute : GLuint { kPosition, kNormal, kColor, kCoordinate, kCorner, kTriangles, kBuffers };
  /// An attribute per vertex; without values the vertices share one.
  void fill(Attribute attribute, const std::vector<Vec3f>& values) const;
  void upload_whole(const MotionMesh& mesh, const std::vector<Vec3f>& colors) const;
  void upload_split(const MotionMesh& mesh, const std::vector<Vec3f>& colors) const;
  /// What depends on triangles alone; they seldom change from frame to frame.
  void upload_triangles(const MotionMesh& mesh);

  GLuint array_ = 0;
  GLuint buffers_[kBuffers] = {};
  std::vector<Triangle> triangles_, normal_triangles_, coordinate_triangles_;  ///< that were sent, of the mesh
  bool has_own_corners_ = false, is_split_ = false;
  CornerVertices corners_;  ///< where vertices are split
  SolidSide solid_ = SolidSide::None;
  bool has_colors_ = false, has_normals_ = false;
  Vec3f base_color_ = Vec3f::Zero();
};

/// Buffers of the triangles that marks are drawn as.
class GpuMarks {
 public:
  GpuMarks();
  ~GpuMarks();
  GpuMarks(const GpuMarks&) = delete;
  GpuMarks& operator=(const GpuMarks&) = delete;

  void draw(const std::vector<OverlayVertex>& triangles) const;

 private:
  GLuint array_ = 0, buffer_ = 0;
};

}  // namespace softreel
