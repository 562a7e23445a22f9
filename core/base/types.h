/// The scalar, vector and index types of the whole project; the only place where they are chosen.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace softreel {

/// Double precision: the state of everything that is simulated (m, kg, s, N, Pa).
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Vec4 = Eigen::Vector4d;
using Mat3 = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

/// Single precision: pictures and files.
using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;
using Mat3f = Eigen::Matrix3f;

/// Index of a vertex, node, triangle or element. Counts that may pass 2^31 (matrix entries) are std::int64_t.
using Index = std::int32_t;

/// An index as the standard containers take it; not negative.
inline std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

using Triangle = std::array<Index, 3>;
using Tet = std::array<Index, 4>;

}  // namespace softreel
