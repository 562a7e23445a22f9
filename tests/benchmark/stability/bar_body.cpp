#include "tests/benchmark/stability/bar_body.h"

#include <cmath>

#include "tests/support/bcc_bar.h"

namespace softreel::bench {
namespace {

constexpr double kCell = 0.1;

std::vector<Index> nodes_at(const TetMesh& mesh, double x) {
  return testing::select_nodes(mesh, [x](const Vec3& p) { return std::abs(p.x() - x) < 1e-9; });
}

}  // namespace

double length_of(const BarBody& bar) {
  return bar.cell_length * bar.cells[0];
}

Vec3 axis_of(const BarBody& bar) {
  return {0, 0.5 * kCell * bar.cells[1], 0.5 * kCell * bar.cells[2]};
}

BodyModel make_cantilever_model(const BarBody& bar) {
  BodyModel model;
  model.name = "body.bar";
  model.mesh = testing::kuhn_bar(bar.cells, Vec3(length_of(bar), kCell * bar.cells[1], kCell * bar.cells[2]));
  model.materials.assign(model.mesh.tets.size(), bar.material);
  model.surface_points = model.mesh.nodes;
  model.embedding = testing::embed_nodes(model.mesh);
  model.gravity.setZero();
  model.pins = {{"body.bar.pin[0]", nodes_at(model.mesh, 0), {{{0, Transform{}, Ease::Constant}}}, {}}};
  return model;
}

BodyModel make_bar_model(const BarBody& bar, const Track<Transform>& far_end) {
  BodyModel model = make_cantilever_model(bar);
  model.pins.push_back({"body.bar.pin[1]", nodes_at(model.mesh, length_of(bar)), far_end, {}});
  return model;
}

}  // namespace softreel::bench
