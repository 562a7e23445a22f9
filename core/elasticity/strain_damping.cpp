#include "core/elasticity/strain_damping.h"

#include <limits>

#include "core/elasticity/element_rotation.h"

namespace softreel {
namespace {

constexpr std::int64_t kDampingGrain = 256;

/// Polar ones, or identities with rotation None.
std::vector<Quaternion> find_polar_rotations(const ElasticBody& body, RotationMethod rotation,
                                             std::span<const Vec3> positions, std::span<const Quaternion> guesses,
                                             const Threads& threads) {
  std::vector<Quaternion> rotations(guesses.begin(), guesses.end());
  find_rotations(body, rotation == RotationMethod::None ? rotation : RotationMethod::Consistent, positions, rotations,
                 threads);
  return rotations;
}

Mat3 find_stretch(const Mat3& rotation, const Mat3& F) {
  return corotated_strain(rotation, F) + Mat3::Identity();
}

Mat3 gradient_of(const ElasticBody& body, std::size_t e, std::span<const Vec3> positions) {
  return deformation_gradient(body.shapes[e].gradients, nodes_of(body.tets[e], positions));
}

/// What rounding the element's positions does to its F.
double gradient_noise(const ElasticBody& body, std::size_t e, std::span<const Vec3> positions) {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k)
    sum += body.shapes[e].gradients.col(static_cast<Index>(k)).norm() *
           positions[static_cast<std::size_t>(body.tets[e][k])].norm();
  return std::numeric_limits<double>::epsilon() * (sum + 4);
}

/// Energy density over b / r; stress: first Piola, the same.
double find_density(const StrainDamping& damping, std::size_t e, double mu, const Mat3& F, const Quaternion& polar,
                    Mat3& stress) {
  const Mat3& before = damping.stretches[e];
  const Mat3 R = polar.toRotationMatrix(), stretch = find_stretch(R, F);
  const double growth = stretch.trace() - before.trace();
  const bool turns = damping.rotation != RotationMethod::None;
  const Mat3 nearest = turns ? Mat3(find_rotation(F * before, polar).toRotationMatrix() * before) : before;
  const Mat3 away = (turns ? F : stretch) - nearest;
  stress = 2 * mu * away + damping.slopes[e] * growth * R;
  return mu * away.squaredNorm() + 0.5 * damping.slopes[e] * growth * growth;
}

}  // namespace

std::vector<Mat3> find_stretches(const ElasticBody& body, RotationMethod rotation, std::span<const Vec3> positions,
                                 std::span<const Quaternion> guesses, const Threads& threads) {
  const std::vector<Quaternion> rotations = find_polar_rotations(body, rotation, positions, guesses, threads);
  std::vector<Mat3> stretches(body.tets.size());
  const auto chunk = [&](std::int64_t begin, std::int64_t end) {
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e)
      stretches[e] = find_stretch(rotations[e].toRotationMatrix(), gradient_of(body, e, positions));
  };
  threads.for_chunks(static_cast<std::int64_t>(stretches.size()), kDampingGrain, chunk);
  return stretches;
}

DampingEnergy find_damping(const ElasticBody& body, const StrainDamping& damping, std::span<const Vec3> positions,
                           std::span<const Quaternion> rotations, std::span<Mat3> stresses, const Threads& threads) {
  std::vector<Quaternion> found;
  if (damping.rotation != RotationMethod::None && damping.rotation != RotationMethod::Consistent) {
    found = find_polar_rotations(body, damping.rotation, positions, rotations, threads);
    rotations = found;
  }
  const auto elements = static_cast<std::int64_t>(body.tets.size());
  DampingEnergy energy;
  energy.value = threads.sum_chunks(elements, kDampingGrain, [&](std::int64_t begin, std::int64_t end) {
    double sum = 0;
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
      const double factor = damping.ratios[e] * body.shapes[e].volume;
      stresses[e].setZero();
      if (factor == 0) continue;
      sum += factor *
             find_density(damping, e, body.laws[e].mu, gradient_of(body, e, positions), rotations[e], stresses[e]);
      stresses[e] *= factor;
    }
    return sum;
  });
  energy.noise = threads.sum_chunks(elements, kDampingGrain, [&](std::int64_t begin, std::int64_t end) {
    double sum = 0;
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e)
      if (damping.ratios[e] != 0) sum += stresses[e].norm() * gradient_noise(body, e, positions);
    return sum;
  });
  return energy;
}

void add_damping_curvature(const ElasticLaw& law, const StrainDamping& damping, std::size_t element,
                           const Mat3& rotation, const Mat3& F, double factor, CurvatureBatch& batch, Mat3& matrix) {
  const Mat3 strain = find_stretch(rotation, F) - damping.stretches[element];
  batch.add({damping.slopes[element], law.mu, false}, rotation, strain, factor * damping.ratios[element], matrix);
}

}  // namespace softreel
