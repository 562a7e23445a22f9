/// find_lane_curvatures on lanes of doubles.
#include <experimental/simd>

#include "core/elasticity/curvature_batch.h"
#include "core/elasticity/principal_axes.h"

namespace softreel {
namespace {

namespace stdx = std::experimental;
using Lanes = stdx::simd<double, stdx::simd_abi::deduce_t<double, kElementLanes>>;

Lanes load(const double* from) {
  return Lanes(from, stdx::vector_aligned);
}

}  // namespace

void find_lane_curvatures(bool positive_part, CurvatureLanes& lanes) {
  detail::Symmetric3<Lanes> strain;
  detail::Matrix9<Lanes> rotation;
  for (std::size_t k = 0; k < 6; ++k) strain[k] = load(lanes.strain[k]);
  for (std::size_t k = 0; k < 9; ++k) rotation[k] = load(lanes.rotation[k]);
  detail::PrincipalAxes<Lanes> principal = detail::find_principal_axes(strain);
  const detail::Vector3<Lanes> strains = principal.values;
  const Lanes pressure = load(lanes.pressure), two_mu = load(lanes.mu) + load(lanes.mu);
  for (std::size_t k = 0; k < 3; ++k) {
    Lanes kappa = detail::find_kappa(strains[(k + 1) % 3], strains[(k + 2) % 3], pressure, two_mu);
    if (positive_part) kappa = stdx::max(kappa, Lanes(0));
    principal.values[k] = Lanes(0.5) * kappa;
    principal.axes[k] = detail::product(rotation, principal.axes[k]);
  }
  const detail::Symmetric3<Lanes> curvature = detail::matrix_of(principal);
  for (std::size_t k = 0; k < 6; ++k) curvature[k].copy_to(lanes.curvature[k], stdx::vector_aligned);
}

}  // namespace softreel
