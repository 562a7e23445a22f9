#include "core/dynamics/joined_model.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace softreel {
namespace {

template <typename T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

void append_mesh(const TetMesh& mesh, Index first_node, TetMesh& joined) {
  append(mesh.nodes, joined.nodes);
  for (Tet tet : mesh.tets) {
    for (Index& node : tet) node += first_node;
    joined.tets.push_back(tet);
  }
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) joined.fill.push_back(mesh.fill_of(e));
  const double spacing = spacing_of(mesh);
  joined.spacings.insert(joined.spacings.end(), mesh.nodes.size(), spacing);
  if (joined.lattice.spacing == 0 || spacing < joined.lattice.spacing) joined.lattice = {mesh.lattice.origin, spacing};
}

void append_constraints(const BodyModel& model, Index first_point, BodyModel& joined) {
  const auto shifted = [first_point](auto constraint) {
    for (Index& point : constraint.points) point += first_point;
    return constraint;
  };
  for (const Pin& pin : model.pins) joined.pins.push_back(shifted(pin));
  for (const Pull& pull : model.pulls) joined.pulls.push_back(shifted(pull));
}

template <typename T>
std::vector<T> slice(const std::vector<T>& all, Index first, std::size_t count) {
  if (all.empty()) return {};
  const auto begin = all.begin() + first;
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace

double spacing_of(const TetMesh& mesh) {
  if (mesh.lattice.spacing > 0) return mesh.lattice.spacing;
  double volume = 0;
  for (const Tet& tet : mesh.tets) {
    const TetNodes x = nodes_of(tet, mesh.nodes);
    volume += tet_volume(x[0], x[1], x[2], x[3]);
  }
  return std::cbrt(12 * volume / static_cast<double>(mesh.tets.size()));
}

std::vector<ModelOffsets> find_offsets(const std::vector<BodyModel>& models) {
  std::vector<ModelOffsets> offsets;
  ModelOffsets next;
  for (const BodyModel& model : models) {
    offsets.push_back(next);
    next.node += static_cast<Index>(model.mesh.nodes.size());
    next.tet += static_cast<Index>(model.mesh.tets.size());
    next.point += static_cast<Index>(model.surface_points.size());
  }
  return offsets;
}

BodyModel join_models(const std::vector<BodyModel>& models) {
  CHECK(!models.empty());
  const std::vector<ModelOffsets> offsets = find_offsets(models);
  BodyModel joined;
  joined.gravity = models.front().gravity;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const BodyModel& model = models[m];
    joined.name += (m == 0 ? "" : " + ") + model.name;
    joined.parts.push_back({model.name, offsets[m].node, offsets[m].tet});
    append_mesh(model.mesh, offsets[m].node, joined.mesh);
    append(model.materials, joined.materials);
    append(model.surface_points, joined.surface_points);
    for (const Index element : model.embedding.elements) joined.embedding.elements.push_back(element + offsets[m].tet);
    append(model.embedding.weights, joined.embedding.weights);
    append_constraints(model, offsets[m].point, joined);
  }
  std::vector<double>& fill = joined.mesh.fill;
  if (std::all_of(fill.begin(), fill.end(), [](double share) { return share == 1; })) fill.clear();
  return joined;
}

SimulationState part_of(const SimulationState& joined, const ModelOffsets& from, std::size_t nodes, std::size_t tets) {
  SimulationState part;
  part.positions = slice(joined.positions, from.node, nodes);
  part.velocities = slice(joined.velocities, from.node, nodes);
  part.rotations = slice(joined.rotations, from.tet, tets);
  part.previous_positions = slice(joined.previous_positions, from.node, nodes);
  part.previous_velocities = slice(joined.previous_velocities, from.node, nodes);
  part.accelerations = slice(joined.accelerations, from.node, nodes);
  part.previous_accelerations = slice(joined.previous_accelerations, from.node, nodes);
  part.previous_error = joined.previous_error;
  part.previous_seconds = joined.previous_seconds;
  part.constraints = joined.constraints;
  part.troubles = slice(joined.troubles, from.tet, tets);
  return part;
}

}  // namespace softreel
