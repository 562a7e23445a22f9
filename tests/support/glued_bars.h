/// Two bars end to end along x, for tests of glue.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "core/dynamics/joined_model.h"
#include "tests/core/dynamics/dynamics_support.h"

namespace softreel::testing {

/// The outside of a mesh whose surface points are its nodes.
inline std::vector<Index> all_points(const BodyModel& model) {
  std::vector<Index> points;
  for (std::size_t i = 0; i < model.surface_points.size(); ++i) points.push_back(static_cast<Index>(i));
  return points;
}

/// A body_model moved by `offset`.
inline BodyModel moved_model(TetMesh mesh, const ElementMaterial& material, const Vec3& offset, const char* name) {
  for (Vec3& node : mesh.nodes) node += offset;
  mesh.lattice.origin += offset;
  BodyModel model = body_model(std::move(mesh), material);
  model.name = name;
  return model;
}

/// All of the first body's surface may stick to the second's.
inline Glue glue_between(const BodyModel& first, const BodyModel& second, double distance) {
  Glue glue;
  glue.name = "glue[0]";
  glue.body = first.name;
  glue.other = second.name;
  glue.points = make_glue_points(first.surface_points, boundary_faces(first.mesh), all_points(first), first.mesh,
                                 first.embedding, std::min(spacing_of(first.mesh), spacing_of(second.mesh)));
  for (Triangle triangle : boundary_faces(second.mesh)) {
    for (Index& vertex : triangle) vertex += static_cast<Index>(first.surface_points.size());
    glue.triangles.push_back(triangle);
  }
  const auto tets = static_cast<Index>(first.mesh.tets.size());
  glue.elements = {tets, tets + static_cast<Index>(second.mesh.tets.size())};
  glue.distance = distance;
  return glue;
}

/// Two models and the glue between them as one.
inline BodyModel glued(const BodyModel& first, const BodyModel& second, double distance) {
  BodyModel joined = join_models({first, second});
  joined.glues.push_back(glue_between(first, second, distance));
  return joined;
}

}  // namespace softreel::testing
