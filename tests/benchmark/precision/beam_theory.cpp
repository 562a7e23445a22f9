#include "tests/benchmark/precision/beam_theory.h"

#include <cmath>
#include <numbers>

#include "core/base/types.h"

namespace softreel::bench {
namespace {

constexpr double kPi = std::numbers::pi;

using Mat4 = Eigen::Matrix<double, 4, 4>;

/// Shear force and moment that are left at the free end for a unit shear force and moment at the clamp: zero at an
/// eigenfrequency. The state (deflection, section's angle, moment, shear force) follows a linear equation along the
/// beam: w' = phi + V / (kappa G A), phi' = M / (E I), M' = -V - rho I omega^2 phi, V' = -rho A omega^2 w.
double free_end_determinant(const Beam& beam, double omega) {
  Mat4 rate = Mat4::Zero();
  const double squared = omega * omega;
  rate(0, 1) = 1;
  rate(0, 3) = 1 / (beam.shear_coefficient() * beam.shear_modulus() * beam.area());
  rate(1, 2) = 1 / (beam.youngs_modulus * beam.inertia());
  rate(2, 1) = -beam.density * beam.inertia() * squared;
  rate(2, 3) = -1;
  rate(3, 0) = -beam.density * beam.area() * squared;
  constexpr int kPieces = 64, kTerms = 12;
  const Mat4 piece = rate * (beam.length / kPieces);
  Mat4 transfer = Mat4::Identity(), term = Mat4::Identity();
  for (int k = 1; k <= kTerms; ++k) {
    term = term * piece / k;
    transfer += term;
  }
  for (int doubled = 1; doubled < kPieces; doubled *= 2) transfer = transfer * transfer;
  return transfer.block<2, 2>(2, 2).determinant();
}

/// State of the elastica along its length: angle, curvature, deflection, axial way.
struct Arc {
  double angle = 0, curvature = 0, across = 0, along = 0;
};

Arc rate_of(const Arc& arc, double load) {
  return {arc.curvature, -load * std::cos(arc.angle), std::sin(arc.angle), std::cos(arc.angle)};
}

Arc moved(const Arc& from, const Arc& rate, double by) {
  return {from.angle + by * rate.angle, from.curvature + by * rate.curvature, from.across + by * rate.across,
          from.along + by * rate.along};
}

/// The free end of the arc that leaves the clamp with this curvature.
Arc shoot(double load, double curvature) {
  constexpr int kSteps = 1000;
  constexpr double kStep = 1.0 / kSteps;
  Arc arc{0, curvature, 0, 0};
  for (int i = 0; i < kSteps; ++i) {
    const Arc a = rate_of(arc, load), b = rate_of(moved(arc, a, kStep / 2), load),
              c = rate_of(moved(arc, b, kStep / 2), load), d = rate_of(moved(arc, c, kStep), load);
    for (const auto& [rate, share] : {std::pair(a, 1.0), std::pair(b, 2.0), std::pair(c, 2.0), std::pair(d, 1.0)})
      arc = moved(arc, rate, share * kStep / 6);
  }
  return arc;
}

}  // namespace

double timoshenko_tip(const Beam& beam, double gravity) {
  const double q = beam.density * beam.area() * gravity, L = beam.length;
  return q * std::pow(L, 4) / (8 * beam.youngs_modulus * beam.inertia()) +
         q * L * L / (2 * beam.shear_coefficient() * beam.shear_modulus() * beam.area());
}

double euler_bernoulli_frequency(const Beam& beam) {
  constexpr double kRoot = 1.875104068711961;
  return kRoot * kRoot / (2 * kPi) *
         std::sqrt(beam.youngs_modulus * beam.inertia() / (beam.density * beam.area() * std::pow(beam.length, 4)));
}

double timoshenko_frequency(const Beam& beam) {
  // Shear and rotary inertia lower the frequency of Euler and Bernoulli, by less than half in any beam.
  double high = 2 * kPi * euler_bernoulli_frequency(beam), low = 0.5 * high;
  const bool sign = free_end_determinant(beam, low) > 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (free_end_determinant(beam, middle) > 0) == sign ? low = middle : high = middle;
  }
  return low / (2 * kPi);
}

ElasticaTip elastica_tip(double load) {
  double low = 0, high = load;  // curvature at the clamp: the moment is at most load times length
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (shoot(load, middle).curvature < 0 ? low : high) = middle;
  }
  const Arc tip = shoot(load, low);
  return {tip.across, 1 - tip.along};
}

double square_torsion_factor() {
  double sum = 0;
  for (int n = 1; n < 100; n += 2) sum += std::tanh(n * kPi / 2) / std::pow(n, 5);
  return (1 - 192 / std::pow(kPi, 5) * sum) / 3;
}

}  // namespace softreel::bench
