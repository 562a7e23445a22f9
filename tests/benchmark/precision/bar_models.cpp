#include "tests/benchmark/precision/bar_models.h"

#include <cmath>

#include "tests/support/bcc_bar.h"
#include "tests/support/elastic_box.h"

namespace softreel::bench {
namespace {

constexpr double kFar = 1e4;  ///< of a dead load's target, in lengths of the bar

/// Covers the flat end of the bar at x, seen from its inside along `outward` (-1 or 1), with tetrahedra on its
/// triangles, and pins them: so the nodes of the end's plane are held, and no others of the bar.
Pin clamp_end(BodyModel& model, const std::string& name, double x, double outward) {
  TetMesh& mesh = model.mesh;
  const double height = 0.5 * mesh.lattice.spacing, slack = 1e-6 * mesh.lattice.spacing;
  std::vector<Tet> covers;
  for (const Triangle& face : boundary_faces(mesh)) {
    Vec3 apex(outward * height, 0, 0);
    bool flat = true;
    for (const Index node : face) {
      const Vec3& X = mesh.nodes[static_cast<std::size_t>(node)];
      flat = flat && std::abs(X.x() - x) < slack;
      apex += X / 3;
    }
    if (!flat) continue;
    covers.push_back({face[0], face[1], face[2], static_cast<Index>(mesh.nodes.size())});
    mesh.nodes.push_back(apex);
  }
  Pin pin{name, {}, {{{0, Transform{}, Ease::Constant}}}, {}};
  for (const Tet& cover : covers) {
    pin.points.push_back(static_cast<Index>(model.surface_points.size()));
    model.embedding.elements.push_back(static_cast<Index>(mesh.tets.size()));
    model.embedding.weights.push_back({0.25, 0.25, 0.25, 0.25});
    mesh.tets.push_back(testing::oriented(cover, mesh.nodes));
    model.surface_points.push_back(testing::centroid(mesh, mesh.tets.size() - 1));
  }
  return pin;
}

}  // namespace

Bar make_clamped_bar(Index across, int slenderness, double width, const ElementMaterial& material, Clamped clamped) {
  Bar bar;
  bar.width = width;
  bar.length = slenderness * width;
  BodyModel& model = bar.model;
  model.name = "bar";
  model.mesh = test_support::make_box({slenderness * across, across, across}, width / across);
  const Vec3 shift(0, -0.5 * width, -0.5 * width);
  for (Vec3& node : model.mesh.nodes) node += shift;
  model.mesh.lattice.origin += shift;
  model.surface_points = model.mesh.nodes;
  model.embedding = testing::embed_nodes(model.mesh);
  model.pins.push_back(clamp_end(model, "bar.pin[0]", 0, -1));
  if (clamped == Clamped::BothEnds) model.pins.push_back(clamp_end(model, "bar.pin[1]", bar.length, 1));
  model.materials.assign(model.mesh.tets.size(), material);
  return bar;
}

std::vector<Index> section_nodes(const Bar& bar, double x) {
  return testing::select_nodes(bar.model.mesh,
                               [&](const Vec3& node) { return std::abs(node.x() - x) < 1e-9 * bar.length; });
}

Vec3 mean_displacement(const Bar& bar, const std::vector<Index>& nodes, std::span<const Vec3> positions) {
  Vec3 sum = Vec3::Zero();
  for (const Index node : nodes) {
    const auto i = static_cast<std::size_t>(node);
    sum += positions[i] - bar.model.mesh.nodes[i];
  }
  return sum / static_cast<double>(nodes.size());
}

double section_twist(const Bar& bar, const std::vector<Index>& nodes, std::span<const Vec3> positions) {
  double moment = 0, squares = 0;
  for (const Index node : nodes) {
    const Vec3& X = bar.model.mesh.nodes[static_cast<std::size_t>(node)];
    const Vec3 u = positions[static_cast<std::size_t>(node)] - X;
    moment += X.y() * u.z() - X.z() * u.y();
    squares += X.y() * X.y() + X.z() * X.z();
  }
  return moment / squares;
}

Pull make_dead_load(const Bar& bar, const std::vector<Index>& nodes, const Vec3& force) {
  const double distance = kFar * bar.length;
  Transform away;
  away.translate = distance * force.normalized();
  // Twice as stiff as needed, so that the limit decides, wherever the nodes are.
  const double stiffness = 2 * force.norm() / distance;
  Pull pull{"bar.pull[0]", nodes, {}, {{{0, away, Ease::Constant}}}, {{{0, stiffness, Ease::Constant}}},
            force.norm(),  {}};
  pull.weights.assign(nodes.size(), 1.0 / static_cast<double>(nodes.size()));
  return pull;
}

}  // namespace softreel::bench
