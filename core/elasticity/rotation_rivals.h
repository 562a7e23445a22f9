/// Element rotations that others use beside the paper's and ours, to be compared with (paper secs. 1 and 5).
///
/// Polar with smoothing: paper sec. 5. Gram-Schmidt: Nesme, Payan and Faure, Efficient, physically plausible finite
/// elements, Eurographics 2005, the paper's [NPF05].
#pragma once

#include <span>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/elasticity/elastic_body.h"
#include "core/elasticity/element.h"

namespace softreel {

/// Rotation Q of the QR decomposition of F in the element's own rest frame: by Gram-Schmidt the first axis follows edge
/// 0-1, the second stays in the face 0-1-2.
///
/// Equals the polar rotation only without strain, and depends on the order of the nodes: that is the method, not an
/// accident. The third axis is the product of the first two, so it never reflects. Where edge and face say nothing: the
/// guess, turned the least that aligns edge 0-1, or the guess itself if that edge has no length.
/// rest, deformed: 4 nodes, m, same order. guess: unit quaternion; the result has the sign nearest to it.
Quaternion find_qr_rotation(const TetNodes& rest, const TetNodes& deformed, const Quaternion& guess) noexcept;

/// Averages of sec. 5, sum w_i q_i / |sum w_i q_i| over the elements that share a node with each element and itself, w
/// the rest volumes, q_i with the sign nearest to the element's own. rotations, smoothed: one per element, not aliased.
///
/// The sum never vanishes: its product with the element's own quaternion is at least the element's volume.
void smooth_rotations(const ElasticBody& body, std::span<const Quaternion> rotations, std::span<Quaternion> smoothed,
                      const Threads& threads);

/// find_rotations of the methods Paper, PolarSmooth and Qr.
void find_rival_rotations(const ElasticBody& body, RotationMethod method, std::span<const Vec3> positions,
                          std::span<Quaternion> rotations, const Threads& threads);

}  // namespace softreel
