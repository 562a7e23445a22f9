/// A simulator with its surroundings, made in one line.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "core/dynamics/simulator.h"
#include "tests/support/bcc_bar.h"

namespace softreel::testing {

inline constexpr double kFps = 24;

/// Of two lists of positions of the same points, m.
inline double greatest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double greatest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) greatest = std::max(greatest, (a[i] - b[i]).norm());
  return greatest;
}

/// A body whose surface points are its nodes, so that pins and pulls select nodes.
inline BodyModel body_model(TetMesh mesh, const ElementMaterial& material) {
  BodyModel model;
  model.name = "body.bar";
  model.materials.assign(mesh.tets.size(), material);
  model.surface_points = mesh.nodes;
  model.embedding = embed_nodes(mesh);
  model.mesh = std::move(mesh);
  return model;
}

/// A track that has one value at all frames.
template <typename T>
Track<T> constant(const T& value) {
  return {{{0, value, Ease::Constant}}};
}

inline Pin make_pin(std::vector<Index> points, const Transform& transform = {}) {
  return {"body.bar.pin[0]", std::move(points), constant(transform), {}};
}

inline Pull make_pull(std::vector<Index> points, const Transform& transform, double stiffness) {
  Pull pull{"body.bar.pull[0]", std::move(points), {}, constant(transform), constant(stiffness), 0, {}};
  pull.weights.assign(pull.points.size(), 1.0 / static_cast<double>(pull.points.size()));
  return pull;
}

/// A damped bar of blocks of two cubes, in turn soft and `contrast` times as stiff, held at one end.
inline BodyModel bar_of_blocks(double contrast) {
  BodyModel model = body_model(kuhn_bar({8, 2, 2}, Vec3(0.8, 0.2, 0.2)), {2e4, 0.35, 1000, 2, 0.005});
  for (std::size_t e = 0; e < model.mesh.tets.size(); ++e)
    if (static_cast<int>(centroid(model.mesh, e).x() / 0.2) % 2 == 1) model.materials[e].youngs_modulus *= contrast;
  model.pins = {make_pin(select_nodes(model.mesh, [](const Vec3& p) { return p.x() < 1e-9; }))};
  return model;
}

/// Keeps what a Simulator refers to.
struct Bench {
  explicit Bench(BodyModel model, const SolverParams& params = {}, int thread_count = 1)
      : threads(thread_count), simulator(std::move(model), params, threads, log, times) {}

  Threads threads;
  Log log;
  StageTimes times;
  Simulator simulator;
};

/// Tight tolerances: what is compared to round-off should not see the solver.
inline SolverParams exact_params() {
  SolverParams params;
  params.tolerance = 1e-12;
  params.force_tolerance = 1e-12;
  return params;
}

}  // namespace softreel::testing
