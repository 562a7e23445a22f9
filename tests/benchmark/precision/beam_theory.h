/// What beam theory says of prismatic bars of square section: the truth of the benchmark's bars.
///
/// Timoshenko, On the transverse vibrations of bars of uniform cross-section, 1922; Cowper, The shear coefficient in
/// Timoshenko's beam theory, 1966; Saint-Venant, De la torsion des prismes, 1855; for the elastica Mattiasson,
/// Numerical results from large deflection beam and frame problems, 1981.
#pragma once

namespace softreel::bench {

/// A cantilever of square section, clamped at x = 0.
struct Beam {
  double length = 1, width = 0.1;  ///< m
  double youngs_modulus = 1e6;     ///< Pa
  double poisson_ratio = 0;
  double density = 1000;  ///< kg/m^3

  double area() const { return width * width; }                                        ///< m^2
  double inertia() const { return width * width * width * width / 12; }                ///< second moment, m^4
  double shear_modulus() const { return youngs_modulus / (2 * (1 + poisson_ratio)); }  ///< Pa
  /// Cowper's coefficient of a rectangle; 5/6 at nu = 0.
  double shear_coefficient() const { return 10 * (1 + poisson_ratio) / (12 + 11 * poisson_ratio); }
};

/// Deflection of the tip under its own weight at `gravity` (m/s^2), in m: q L^4 / (8 E I) + q L^2 / (2 kappa G A).
double timoshenko_tip(const Beam& beam, double gravity);

/// First bending frequency in Hz, with shear and rotary inertia.
double timoshenko_frequency(const Beam& beam);

/// The same without shear and rotary inertia: 1.8751^2 / (2 pi) sqrt(E I / (rho A L^4)).
double euler_bernoulli_frequency(const Beam& beam);

/// Tip of an inextensible cantilever without shear under a dead load across its tip, over its length.
struct ElasticaTip {
  double across = 0;      ///< along the load, w / L
  double shortening = 0;  ///< along the axis, u / L
};

/// load: P L^2 / (E I), above 0. Shooting with fourth-order Runge-Kutta; right to 1e-9.
ElasticaTip elastica_tip(double load);

/// Torque over shear modulus, width^4 and twist per length where the section may warp: 0.140577.
double square_torsion_factor();

}  // namespace softreel::bench
