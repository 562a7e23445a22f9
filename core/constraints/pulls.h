/// Springs of the pulls that are active at a frame: force, energy and stiffness.
///
/// A limited pull (max_force) measures its pull as k d, with k its whole stiffness and d the root mean square distance
/// of its points, weighted by their stiffness: never less than the length of the summed force, and equal to it where
/// all points are equally far. Beyond the limit all springs soften by the same factor, max_force / (k d). So the force
/// has an energy (k d^2 / 2, growing linearly beyond the limit), and the factor times the stiffness is its secant
/// stiffness: a step by one solve takes the least of the factors along its way, so that the pull stays implicit,
/// does not overshoot, and is stronger than its limit by a hundredth at most (more where eight solves do not do).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/base/types.h"
#include "core/constraints/constraints.h"
#include "core/skinning/embedding.h"
#include "core/sparse/block_matrix.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// One spring from a surface point, which lies at offset + sum weights[k] x_k, to a target; or one between two points
/// of the material (glue.h): then the nodes are those of both, the weights of the second are negative, and offset and
/// target are zero. The weights of a point outside of its element extrapolate, as far as it is: rigid motion of the
/// element takes the point along.
struct Spring {
  std::array<Index, 8> nodes{};
  std::array<double, 8> weights{};
  std::size_t count = 4;       ///< of the nodes: those of one element, or of two
  Vec3 offset = Vec3::Zero();  ///< m; round-off, as the weights give the point
  Vec3 target = Vec3::Zero();  ///< m
  double stiffness = 0;        ///< N/m
  bool joins_material() const { return count == 8; }
  bool operator==(const Spring&) const = default;
};

/// A pull at one frame.
struct ActivePull {
  std::vector<Spring> springs;
  double stiffness = 0;  ///< N/m, of all springs
  double max_force = 0;  ///< N; 0: no limit
  bool operator==(const ActivePull&) const = default;
};

/// Pulls that are active at `frame` with stiffness above 0; one that grabs pulls with what it grabbed, not before.
/// grabs: per pull.
std::vector<ActivePull> active_pulls(const std::vector<Pull>& pulls, const std::vector<Vec3>& surface_points,
                                     const Embedding& embedding, const TetMesh& mesh, double frame,
                                     std::span<const Grab> grabs = {});

/// Where the springs of a pull are fixed at `frame`, per point. surface_points: at rest.
std::vector<Vec3> pull_targets(const Pull& pull, const std::vector<Vec3>& surface_points, double frame,
                               const Grab& grab = {});

/// What grabbing pulls hold once a step has ended at `frame` with the nodes at `positions`. grabs: per pull.
void update_grabs(const std::vector<Pull>& pulls, const std::vector<Vec3>& surface_points, const Embedding& embedding,
                  const TetMesh& mesh, std::span<const Vec3> positions, double frame, std::span<Grab> grabs);

/// Factor on the stiffness that keeps to max_force, in (0, 1].
double pull_factor(const ActivePull& pull, std::span<const Vec3> positions);

/// The pull without a limit whose springs are `factor` times as stiff.
ActivePull softened(ActivePull pull, double factor);

/// Energy of the springs, J.
double pull_energy(const ActivePull& pull, std::span<const Vec3> positions);

/// Adds scale * the springs' forces at `positions` to the nodes, N: minus the gradient of pull_energy. Cost: the
/// springs alone, however many nodes there are.
void add_pull_forces(const ActivePull& pull, std::span<const Vec3> positions, std::span<Vec3> forces, double scale = 1);

/// Adds scale * (secant) stiffness, blocks factor k w_i w_j I of each spring's element, to a matrix whose pattern has
/// them.
void add_pull_stiffness(const ActivePull& pull, std::span<const Vec3> positions, double scale, BlockMatrixd& matrix);

}  // namespace softreel
