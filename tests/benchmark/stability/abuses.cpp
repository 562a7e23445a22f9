#include <cmath>

#include <fmt/format.h>

#include "tests/benchmark/stability/abuse_study.h"
#include "tests/benchmark/stability/bar_body.h"
#include "tests/support/bcc_bar.h"

namespace softreel::bench {
namespace {

const BarBody kBar{{8, 2, 2}, 0.1, {1e5, 0.35, 1000, 2, 0.005}};
const Vec3 kGravity(0, -9.81, 0);

BodyModel hanging(const BarBody& bar) {
  BodyModel model = make_cantilever_model(bar);
  model.gravity = kGravity;
  return model;
}

BodyModel undamped_free_bar() {
  BarBody bar = kBar;
  bar.material.damping_mass = bar.material.damping_stiffness = 0;
  BodyModel model = make_cantilever_model(bar);
  model.pins.clear();
  return model;
}

/// Stretched by 30 % and spinning, and on its way.
SimulationState flying(const Simulator& simulator) {
  SimulationState state = simulator.state();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    const Vec3 rest = state.positions[i];
    state.positions[i].x() *= 1.3;
    state.velocities[i] = Vec3(0.3, -0.2, 0.1) + Vec3(0, 1, 3).cross(rest - Vec3(0.4, 0.1, 0.1));
  }
  return state;
}

/// Blocks of two cubes along the bar, in turn soft and `contrast` times as stiff.
BodyModel with_contrast(double contrast) {
  BarBody bar = kBar;
  bar.material.youngs_modulus = 2e4;
  BodyModel model = hanging(bar);
  for (std::size_t e = 0; e < model.mesh.tets.size(); ++e)
    if (static_cast<int>(testing::centroid(model.mesh, e).x() / 0.2) % 2 == 1)
      model.materials[e].youngs_modulus *= contrast;
  return model;
}

Abuse step_length(double seconds, bool quick) {
  Abuse abuse{fmt::format("steps of {:g} s", seconds), undamped_free_bar, flying, seconds, quick ? 60 : 400, true, 0};
  return abuse;
}

/// The pin and all it holds are elsewhere, turned, from one frame to the next.
BodyModel with_jump() {
  BodyModel model = hanging(kBar);
  Transform away;
  away.translate = Vec3(0, 10 * length_of(kBar), 0);
  away.rotate = Vec3(0, 0, 2);
  model.pins[0].track = {{{0, {}, Ease::Constant}, {12, away, Ease::Constant}}};
  return model;
}

Pull pull_of(const char* name, std::vector<Index> points, const Vec3& by, double stiffness) {
  Transform there;
  there.translate = by;
  Pull pull{name, std::move(points), {}, {{{0, there, Ease::Constant}}}, {{{0, stiffness, Ease::Constant}}}, 0, {}};
  pull.weights.assign(pull.points.size(), 1.0 / static_cast<double>(pull.points.size()));
  return pull;
}

std::vector<Index> far_end(const BodyModel& model) {
  return testing::select_nodes(model.mesh, [](const Vec3& p) { return p.x() > length_of(kBar) - 1e-9; });
}

BodyModel with_pull(double stiffness) {
  BodyModel model = hanging(kBar);
  model.pulls = {pull_of("body.bar.pull[0]", far_end(model), Vec3(0, length_of(kBar), 0), stiffness)};
  return model;
}

/// Two pulls that want the far end on opposite sides, and one that wants what is pinned.
BodyModel with_conflict() {
  BodyModel model = hanging(kBar);
  model.pulls = {pull_of("body.bar.pull[0]", far_end(model), Vec3(0, 3, 0), 1e6),
                 pull_of("body.bar.pull[1]", far_end(model), Vec3(0, -3, 0), 1e6),
                 pull_of("body.bar.pull[2]", model.pins[0].points, Vec3(5, 0, 0), 1e6)};
  return model;
}

BodyModel with_slivers(const TetMesh& mesh) {
  BodyModel model = hanging(kBar);
  model.mesh = mesh;
  model.materials.assign(mesh.tets.size(), kBar.material);
  model.surface_points = mesh.nodes;
  model.embedding = testing::embed_nodes(mesh);
  model.pins[0].points = testing::select_nodes(mesh, [](const Vec3& p) { return p.x() < 1e-9; });
  return model;
}

BodyModel with_poisson_ratio(double nu) {
  BarBody bar = kBar;
  bar.material.poisson_ratio = nu;
  return hanging(bar);
}

}  // namespace

TetMesh sliver_bar(double degrees) {
  TetMesh mesh = testing::kuhn_bar(kBar.cells, {length_of(kBar), 0.2, 0.2});
  const std::size_t whole = mesh.tets.size();
  for (std::size_t e = 0; e < whole; e += 8) {
    const Tet tet = mesh.tets[e];
    const auto at = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
    // Over the incentre of the face 0-1-2, so that its three dihedral angles there are equal.
    const double a = (at(1) - at(2)).norm(), b = (at(0) - at(2)).norm(), c = (at(0) - at(1)).norm();
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
    const double inradius = normal.norm() / (a + b + c);
    const Vec3 incentre = (a * at(0) + b * at(1) + c * at(2)) / (a + b + c);
    const double height = inradius * std::tan(degrees * EIGEN_PI / 180);
    const Vec3 inward = normal.dot(at(3) - at(0)) > 0 ? normal.normalized() : Vec3(-normal.normalized());
    const auto middle = static_cast<Index>(mesh.nodes.size());
    mesh.nodes.push_back(incentre + height * inward);
    for (std::size_t k = 0; k < 4; ++k) {
      Tet part = tet;
      part[k] = middle;
      if (k == 0)
        mesh.tets[e] = part;
      else
        mesh.tets.push_back(part);
    }
  }
  mesh.lattice.spacing = 0;  // it is of no lattice any more
  return mesh;
}

std::vector<Abuse> abuses(const TetMesh& slivers, bool quick) {
  std::vector<Abuse> all;
  for (const double seconds : {1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0}) all.push_back(step_length(seconds, quick));
  for (const double contrast : {1e2, 1e4, 1e6, 1e8})
    all.push_back({fmt::format("stiffness contrast {:g}", contrast), [contrast] { return with_contrast(contrast); }});
  for (const double nu : {0.45, 0.49, 0.499})
    all.push_back({fmt::format("Poisson's ratio {:g}", nu), [nu] { return with_poisson_ratio(nu); }});
  all.push_back({"slivers of 0.1 degree", [slivers] { return with_slivers(slivers); }});
  Abuse jump{"pins jump ten lengths", with_jump};
  jump.last_work = 12;
  all.push_back(jump);
  all.push_back({"pulls that contradict each other and a pin", with_conflict});
  for (const double stiffness : {1e6, 1e12, 1e18, 1e30})
    all.push_back({fmt::format("pull of {:g} N/m", stiffness), [stiffness] { return with_pull(stiffness); }});
  return all;
}

}  // namespace softreel::bench
