/// Linear elastic material of one element.
#pragma once

namespace softreel {

/// SI units; per element, so that bodies may be heterogeneous.
struct ElementMaterial {
  double youngs_modulus = 1e5;   ///< E, Pa, above 0
  double poisson_ratio = 0.4;    ///< nu, in [0, 0.5)
  double density = 1000;         ///< kg/m^3, above 0
  double damping_mass = 0;       ///< Rayleigh: C = damping_mass M + damping_stiffness K; 1/s
  double damping_stiffness = 0;  ///< s

  /// Lame's first parameter, Pa.
  double lame_lambda() const {
    return youngs_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
  }
  /// Shear modulus, Pa.
  double lame_mu() const { return youngs_modulus / (2 * (1 + poisson_ratio)); }
};

}  // namespace softreel
