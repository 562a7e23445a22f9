/// Loads of element batches into vector lanes; included by the vector kernels of this folder only.
#pragma once

#include <algorithm>
#include <span>

#include "core/elasticity/element_lanes.h"
#include "core/elasticity/lane_algebra.h"

namespace softreel::detail {

/// Component c of `vectors` at the nodes that the lanes name.
template <typename Lanes>
[[gnu::always_inline]] inline Lanes gather(std::span<const Vec3> vectors, const Index* nodes, int c) {
  const double* const data = vectors.data()->data();
  return Lanes([&](auto lane) { return data[3 * static_cast<std::ptrdiff_t>(nodes[lane]) + c]; });
}

/// Lanes that start on their own alignment.
template <typename Lanes, typename Flag>
[[gnu::always_inline]] inline Vector3<Lanes> load_vector(const double (*from)[kElementLanes], Flag aligned) {
  return {Lanes(from[0], aligned), Lanes(from[1], aligned), Lanes(from[2], aligned)};
}

/// Sum of vectors[node k] b_k^T: the deformation gradient, of positions.
template <typename Lanes, typename Flag>
[[gnu::always_inline]] inline Matrix9<Lanes> gradient(const ElementBatch& batch, std::span<const Vec3> vectors,
                                                      Flag aligned) {
  const Vector3<Lanes> b1 = load_vector<Lanes>(batch.gradients, aligned),
                       b2 = load_vector<Lanes>(batch.gradients + 3, aligned),
                       b3 = load_vector<Lanes>(batch.gradients + 6, aligned);
  Matrix9<Lanes> G;
  for (std::size_t r = 0; r < 3; ++r) {
    const auto at = [&](int node) { return gather<Lanes>(vectors, batch.nodes[node], static_cast<int>(r)); };
    const Lanes first = at(0), d1 = at(1) - first, d2 = at(2) - first, d3 = at(3) - first;
    for (std::size_t c = 0; c < 3; ++c) G[3 * r + c] = d1 * b1[c] + d2 * b2[c] + d3 * b3[c];
  }
  return G;
}

/// Rotations of the batch that starts at element `first`; past the end, the last one again.
template <typename Lanes>
[[gnu::always_inline]] inline Quad<Lanes> load_rotations(std::span<const Quaternion> rotations, std::size_t first) {
  const std::size_t last = rotations.size() - 1;
  const auto coefficient = [&](int c) {
    return Lanes([&](auto lane) { return rotations[std::min(first + lane, last)].coeffs()[c]; });
  };
  return {coefficient(3), coefficient(0), coefficient(1), coefficient(2)};  // Eigen has w last
}

}  // namespace softreel::detail
