#include "render/preview/egl/gpu_meshes.h"

#include "render/scene/color_map.h"

namespace softreel {
namespace {

template <typename T>
void send(GLenum target, GLuint buffer, const std::vector<T>& values) {
  glBindBuffer(target, buffer);
  glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data(), GL_STREAM_DRAW);
}

/// The mesh's values at the vertices of the card, given where each comes from; none of none.
std::vector<Vec3f> gathered(const std::vector<Vec3f>& values, const std::vector<Index>& from) {
  std::vector<Vec3f> result;
  if (values.empty()) return result;
  result.reserve(from.size());
  for (const Index v : from) result.push_back(values[static_cast<std::size_t>(v)]);
  return result;
}

/// u, v, and 1 where textures hold; nothing for a mesh without textures.
std::vector<Vec3f> gathered_coordinates(const SurfaceColoring& coloring, const std::vector<Index>& coordinate_of) {
  std::vector<Vec3f> result;
  if (coloring.maps.empty()) return result;
  result.reserve(coordinate_of.size());
  for (const Index c : coordinate_of) {
    const Vec2f at = c < 0 ? Vec2f(Vec2f::Zero()) : coloring.coordinates[static_cast<std::size_t>(c)];
    result.emplace_back(at.x(), at.y(), c < 0 ? 0.0f : 1.0f);
  }
  return result;
}

/// Triangles with corners of their own have normals there, if the mesh has none.
bool has_flat_corners(const MotionMesh& mesh) {
  return mesh.lines && mesh.times.back().normals.empty();
}

void add_overlay_attribute(GLuint attribute, GLint numbers, std::size_t offset) {
  glVertexAttribPointer(attribute, numbers, GL_FLOAT, GL_FALSE, sizeof(OverlayVertex),
                        reinterpret_cast<const void*>(offset));
  glEnableVertexAttribArray(attribute);
}

}  // namespace

GpuMesh::GpuMesh() {
  glGenVertexArrays(1, &array_);
  glGenBuffers(kBuffers, buffers_);
}

GpuMesh::~GpuMesh() {
  glDeleteBuffers(kBuffers, buffers_);
  glDeleteVertexArrays(1, &array_);
}

void GpuMesh::upload(const MotionMesh& mesh) {
  const std::vector<Vec3f> colors = vertex_base_colors(mesh);
  base_color_ = mesh.appearance.base_color;
  has_colors_ = !colors.empty();
  has_normals_ = has_flat_corners(mesh) || !mesh.times.back().normals.empty();
  glBindVertexArray(array_);
  upload_triangles(mesh);
  if (is_split_)
    upload_split(mesh, colors);
  else
    upload_whole(mesh, colors);
}

void GpuMesh::upload_triangles(const MotionMesh& mesh) {
  const bool own = mesh.lines.has_value();
  const bool split = own || !mesh.coloring.maps.empty() || !mesh.normal_triangles.empty();
  const bool same = own == has_own_corners_ && split == is_split_ && mesh.triangles == triangles_ &&
                    mesh.normal_triangles == normal_triangles_ && mesh.coloring.triangles == coordinate_triangles_;
  if (same) return;
  has_own_corners_ = own;
  is_split_ = split;
  triangles_ = mesh.triangles;
  normal_triangles_ = mesh.normal_triangles;
  coordinate_triangles_ = mesh.coloring.triangles;
  corners_ = own ? split_all_corners(mesh) : split ? split_at_seams(mesh) : CornerVertices{};
  solid_ = solid_side(mesh.times.back().positions, mesh.triangles);
  send(GL_ELEMENT_ARRAY_BUFFER, buffers_[kTriangles], split ? corners_.triangles : mesh.triangles);
}

void GpuMesh::upload_whole(const MotionMesh& mesh, const std::vector<Vec3f>& colors) const {
  const MotionMesh::Time& time = mesh.times.back();
  fill(kPosition, time.positions);
  fill(kNormal, time.normals);
  fill(kColor, colors);
  fill(kCoordinate, {});
  fill(kCorner, {});
}

void GpuMesh::upload_split(const MotionMesh& mesh, const std::vector<Vec3f>& colors) const {
  const MotionMesh::Time& time = mesh.times.back();
  fill(kPosition, gathered(time.positions, corners_.vertex_of));
  fill(kNormal, has_flat_corners(mesh) ? face_normals(time.positions, mesh.triangles)
                                       : gathered(time.normals, corners_.normal_of));
  fill(kColor, gathered(colors, corners_.vertex_of));
  fill(kCoordinate, gathered_coordinates(mesh.coloring, corners_.coordinate_of));
  fill(kCorner, mesh.lines ? edge_weights(mesh) : std::vector<Vec3f>{});
}

void GpuMesh::fill(Attribute attribute, const std::vector<Vec3f>& values) const {
  if (values.empty()) {
    glDisableVertexAttribArray(attribute);
    return;
  }
  send(GL_ARRAY_BUFFER, buffers_[attribute], values);
  glVertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  glEnableVertexAttribArray(attribute);
}

void GpuMesh::draw() const {
  glBindVertexArray(array_);
  if (!has_colors_) glVertexAttrib3fv(kColor, base_color_.data());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * triangles_.size()), GL_UNSIGNED_INT, nullptr);
}

void GpuMesh::draw_outside() const {
  if (solid_ == SolidSide::None) return draw();
  glEnable(GL_CULL_FACE);
  glCullFace(solid_ == SolidSide::Behind ? GL_BACK : GL_FRONT);
  draw();
  glDisable(GL_CULL_FACE);
}

GpuMarks::GpuMarks() {
  glGenVertexArrays(1, &array_);
  glGenBuffers(1, &buffer_);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  add_overlay_attribute(0, 4, offsetof(OverlayVertex, clip));
  add_overlay_attribute(1, 2, offsetof(OverlayVertex, disk));
  add_overlay_attribute(2, 3, offsetof(OverlayVertex, color));
}

GpuMarks::~GpuMarks() {
  glDeleteBuffers(1, &buffer_);
  glDeleteVertexArrays(1, &array_);
}

void GpuMarks::draw(const std::vector<OverlayVertex>& triangles) const {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size() * sizeof(OverlayVertex)), triangles.data(),
               GL_STREAM_DRAW);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(triangles.size()));
}

}  // namespace softreel
