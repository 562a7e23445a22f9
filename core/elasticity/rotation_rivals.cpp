#include "core/elasticity/rotation_rivals.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/base/check.h"
#include "core/elasticity/paper_rotation.h"

namespace softreel {
namespace {

/// Elements per chunk: some hundred microseconds of work.
constexpr std::int64_t kRivalGrain = 512;

/// Share of the longer of two edges below which a shorter edge, or a distance from a line, is round-off.
constexpr double kSmallestShare = 1e-12;

Quaternion nearest_sign(const Quaternion& q, const Quaternion& guess) {
  return q.dot(guess) < 0 ? Quaternion(-q.coeffs()) : q;
}

/// Edges 0-1 and 0-2, divided by their greatest coordinate, so that no square overflows or vanishes.
struct Edges {
  Vec3 first, second;
};

Edges scaled_edges(const TetNodes& nodes) {
  const Vec3 first = nodes[1] - nodes[0], second = nodes[2] - nodes[0];
  const double size = std::max(first.cwiseAbs().maxCoeff(), second.cwiseAbs().maxCoeff());
  if (!(size > 0)) return {Vec3::Zero(), Vec3::Zero()};
  return {first / size, second / size};
}

/// Part of `second` across the unit vector `axis`; zero if it is round-off.
Vec3 across(const Vec3& axis, const Vec3& second) {
  const Vec3 part = second - axis.dot(second) * axis;
  return part.norm() > kSmallestShare * second.norm() ? part : Vec3(Vec3::Zero());
}

/// Columns: the orthonormal frame of axis and `second`, right-handed.
Mat3 frame(const Vec3& axis, const Vec3& part_across) {
  Mat3 axes;
  axes.col(0) = axis;
  axes.col(1) = part_across.normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

/// True if `other` shares one of the nodes `tet`[0 .. count).
bool has_earlier_node(const Tet& other, const Tet& tet, std::size_t count) {
  return std::any_of(tet.begin(), tet.begin() + static_cast<std::ptrdiff_t>(count),
                     [&](Index node) { return std::find(other.begin(), other.end(), node) != other.end(); });
}

Quaternion smoothed_rotation(const ElasticBody& body, std::span<const Quaternion> rotations, std::size_t e) {
  const NodeElements& gather = body.node_elements;
  const Quaternion& own = rotations[e];
  Vec4 sum = Vec4::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    const auto node = static_cast<std::size_t>(body.tets[e][k]);
    for (std::int64_t at = gather.offsets[node]; at < gather.offsets[node + 1]; ++at) {
      const std::size_t other = gather.entries[static_cast<std::size_t>(at)] / 4;
      if (has_earlier_node(body.tets[other], body.tets[e], k)) continue;  // it was added there
      sum += body.shapes[other].volume * nearest_sign(rotations[other], own).coeffs();
    }
  }
  return Quaternion(Vec4(sum.normalized()));
}

/// The shortest turn that takes a unit vector to another. Eigen's own answers the same, by an SVD of 2 x 3 that takes
/// 15 s to compile.
Quaternion shortest_turn(const Vec3& from, const Vec3& to) {
  const Vec3 axis = from.cross(to);
  const Quaternion turn(1 + from.dot(to), axis.x(), axis.y(), axis.z());
  if (turn.coeffs().norm() > 0) return turn.normalized();
  const Vec3 side = from.unitOrthogonal();
  return {0, side.x(), side.y(), side.z()};
}

}  // namespace

Quaternion find_qr_rotation(const TetNodes& rest, const TetNodes& deformed, const Quaternion& guess) noexcept {
  const Edges from = scaled_edges(rest), to = scaled_edges(deformed);
  if (!to.first.allFinite() || !to.second.allFinite() || !(to.first.norm() > kSmallestShare)) return guess;
  const Vec3 rest_axis = from.first.normalized(), axis = to.first.normalized();
  const Vec3 part_across = across(axis, to.second);
  if (part_across.isZero(0)) return nearest_sign((shortest_turn(guess * rest_axis, axis) * guess).normalized(), guess);
  const Mat3 rotation = frame(axis, part_across) * frame(rest_axis, across(rest_axis, from.second)).transpose();
  return nearest_sign(Quaternion(rotation).normalized(), guess);
}

void smooth_rotations(const ElasticBody& body, std::span<const Quaternion> rotations, std::span<Quaternion> smoothed,
                      const Threads& threads) {
  threads.for_chunks(static_cast<std::int64_t>(body.tets.size()), kRivalGrain,
                     [&](std::int64_t begin, std::int64_t end) {
                       for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e)
                         smoothed[e] = smoothed_rotation(body, rotations, e);
                     });
}

void find_rival_rotations(const ElasticBody& body, RotationMethod method, std::span<const Vec3> positions,
                          std::span<Quaternion> rotations, const Threads& threads) {
  if (method == RotationMethod::PolarSmooth) {
    std::vector<Quaternion> polar(rotations.begin(), rotations.end());
    find_rotations(body, RotationMethod::Consistent, positions, polar, threads);
    smooth_rotations(body, polar, rotations, threads);
    return;
  }
  CHECK((method == RotationMethod::Paper || method == RotationMethod::Qr));
  const auto find = method == RotationMethod::Paper ? find_paper_rotation : find_qr_rotation;
  threads.for_chunks(
      static_cast<std::int64_t>(body.tets.size()), kRivalGrain, [&](std::int64_t begin, std::int64_t end) {
        for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e)
          rotations[e] =
              find(nodes_of(body.tets[e], body.rest_positions), nodes_of(body.tets[e], positions), rotations[e]);
      });
}

}  // namespace softreel
