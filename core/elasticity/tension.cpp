#include "core/elasticity/tension.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace softreel {
namespace {

constexpr std::int64_t kTensionGrain = 1024;

/// False where no kappa_k exceeds `least`; the twin of that in the kernel of a step.
bool may_be_tense(const ElasticLaw& law, const Mat3& strain, double least) {
  const double mean = strain.trace() / 3, p = law.pressure(strain.trace());
  const double sum = 2 + 2 * mean + std::sqrt(2.0 / 3 * (strain - mean * Mat3::Identity()).squaredNorm());
  return (2 * law.mu - least) * sum >= 2 * (2 * law.mu - p) || p > 2 * law.mu;
}

double greatest_value(const Mat3& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(symmetric, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

/// That of the step's start, turned to the axes of the extrapolated place, and no greater than the one there.
Mat3 tension_at_start(const ElasticBody& body, const StepSource& source, std::size_t e, const Mat3& there,
                      double least) {
  const Mat3 Q = source.start_rotations[e].toRotationMatrix(),
             F = deformation_gradient(body.shapes[e].gradients, nodes_of(body.tets[e], source.start_positions));
  const Mat3 then = tension_curvature(body.laws[e], Q, F, least);
  const double most = greatest_value(then);
  if (!(most > 0)) return Mat3::Zero();
  const Mat3 turn = source.rotations[e].toRotationMatrix() * Q.transpose();
  return std::min(1.0, greatest_value(there) / most) * (turn * then * turn.transpose());
}

}  // namespace

AlignedVector<double> find_tension_limits(const ElasticBody& body, std::span<const double> thickness,
                                          const std::vector<ElementMaterial>& materials, double share) {
  AlignedVector<double> limits(kElementLanes * body.batches.size(), std::numeric_limits<double>::infinity());
  for (std::size_t e = 0; e < thickness.size(); ++e)
    limits[e] = share * thickness[e] * std::sqrt(materials[e].youngs_modulus * materials[e].density / 3);
  return limits;
}

Mat3 tension_curvature(const ElasticLaw& law, const Mat3& rotation, const Mat3& F, double least) {
  const Mat3 beyond = rotation_curvature(law, rotation, F, false) - 0.5 * least * Mat3::Identity();
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(beyond);
  const Mat3& axes = principal.eigenvectors();
  return axes * principal.eigenvalues().cwiseMax(0.0).asDiagonal() * axes.transpose();
}

std::vector<Mat3> find_tension_curvatures(const ElasticBody& body, const StepSource& source, const Threads& threads) {
  if (source.tension_limits.empty()) return {};
  const double reach = source.seconds.position, share = std::sqrt(source.seconds.velocity * reach);
  std::vector<Mat3> curvatures(body.tets.size(), Mat3::Zero());
  const double tense = threads.sum_chunks(
      static_cast<std::int64_t>(curvatures.size()), kTensionGrain, [&](std::int64_t begin, std::int64_t end) {
        double found = 0;
        for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
          const ElasticLaw& law = body.laws[e];
          const Mat3 Q = source.rotations[e].toRotationMatrix(),
                     F = deformation_gradient(body.shapes[e].gradients, nodes_of(body.tets[e], source.positions));
          const double least = source.tension_limits[e] / share;
          if (!may_be_tense(law, corotated_strain(Q, F), least)) continue;
          Mat3 tension = tension_curvature(law, Q, F, least);
          if (!source.start_positions.empty()) tension = tension_at_start(body, source, e, tension, least);
          curvatures[e] = reach / ((reach + source.damping_stiffness[e]) * law.mu) * tension;
          ++found;
        }
        return found;
      });
  if (tense == 0) curvatures.clear();
  return curvatures;
}

}  // namespace softreel
