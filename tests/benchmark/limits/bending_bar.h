/// A bar of 1 x 0.25 x 0.25 m, its end at x = 0 clamped, that its weight bends: the problem of limits.cpp.
#pragma once

#include "tests/benchmark/limits/tet_remedies.h"

namespace softreel::bench {

/// E, Pa, and density, kg/m^3: a tip that sags by 2.4 % of the length.
inline constexpr double kBarModulus = 1e7, kBarDensity = 1000;

struct BarAnswer {
  double tip = 0;  ///< mean sag of the four corners of the free end, m
  HeldDisplacements statics;
};

/// BCC tetrahedra, `across` cubes across. Clamped are the nodes at x = 0, so that all meshes have the same problem.
BarAnswer bend_bar(Index across, TetRemedy remedy, double poisson_ratio);

/// The bar's sag by boxes of polynomials of degree `degree` in each direction, fine towards the edges of the clamp,
/// where stress is singular: what the others are compared with. A quarter of the bar is enough: the load is mirrored in
/// z and its reverse in y.
BarAnswer bend_bar_by_polynomials(int degree, double poisson_ratio);

}  // namespace softreel::bench
