/// The linear systems that solvers are measured on: a clamped bar, twisted, bent and shaken (targets, section 4).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/elasticity/material.h"
#include "core/sparse/block_matrix.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel::benchmark_support {

/// E = 1e6 Pa, nu = 0.4, 1000 kg/m^3, damping 0.1 M + 0.002 K.
inline constexpr ElementMaterial kBarMaterial{1e6, 0.4, 1000, 0.1, 0.002};

/// Step of the dynamic problem, s.
inline constexpr double kBarStep = 1.0 / 96;

/// What is solved at the deformed state.
enum class SystemKind {
  Dynamic,  ///< one implicit Euler step from standstill: S = M + h Ma + (h^2 + h b) K
  Static    ///< K with the positive part of its rotations' curvature: the tangent that is always definite
};

std::string name_of(SystemKind kind);

/// A matrix with pins at the bar's low x end and the load that goes with it.
struct LinearSystem {
  BlockMatrixd matrix;
  std::vector<std::uint8_t> pinned;
  std::vector<Vec3> load;  ///< h (elastic forces + weight), or without h; zero on pinned nodes
};

/// The mesh's nodes after a twist of 180 degrees about its x axis, a bend of 86 degrees over its length, and noise of
/// at most 10 % of `element_size` in each coordinate; nodes at x = 0 stay. Seeded: the same on every call.
std::vector<Vec3> deform_bar(const std::vector<Vec3>& rest, double element_size);

/// materials: per element. positions: the state.
LinearSystem make_system(const TetMesh& mesh, const std::vector<ElementMaterial>& materials,
                         const std::vector<Vec3>& positions, SystemKind kind, const Threads& threads);

/// Cubes across the bar of make_bar whose number of tetrahedra is nearest to `tets`.
Index cubes_for(double tets);

/// Middle one of `repeats` times of work, s: processor time on one thread, which other jobs of a shared machine disturb
/// least; wall time on several.
template <typename Work>
double median_seconds(const Threads& threads, int repeats, const Work& work);

/// Now, s, by that clock.
double now(const Threads& threads);
double median(std::vector<double> values);

template <typename Work>
double median_seconds(const Threads& threads, int repeats, const Work& work) {
  std::vector<double> seconds;
  for (int i = 0; i < repeats; ++i) {
    const double start = now(threads);
    work();
    seconds.push_back(now(threads) - start);
  }
  return median(std::move(seconds));
}

}  // namespace softreel::benchmark_support
