#include "core/tetmesh/lattice/bcc_lattice.h"

#include <algorithm>
#include <cmath>

namespace softreel {

Vec3 lattice_position(const LatticeFrame& frame, const LatticeNode& node) {
  return frame.origin + 0.5 * frame.spacing * Vec3(node[0], node[1], node[2]);
}

LatticeTet locate_in_lattice(const LatticeFrame& frame, const Vec3& point) {
  // The centre of the cube that holds the point, and the point seen from there; the cube is [-1, 1]^3.
  const Vec3 scaled = (point - frame.origin) * (2.0 / frame.spacing);
  LatticeNode center;
  Vec3 d;
  for (int k = 0; k < 3; ++k) {
    const double cell = std::floor(0.5 * scaled[k]);
    center[static_cast<std::size_t>(k)] = 2 * static_cast<std::int32_t>(cell) + 1;
    d[k] = scaled[k] - (2.0 * cell + 1.0);
  }
  // The largest coordinate names the face of the cube, the second the edge of that face.
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return std::abs(d[a]) > std::abs(d[b]); });
  const auto [c, a, b] = axes;
  const int sign_c = d[c] < 0 ? -1 : 1, sign_a = d[a] < 0 ? -1 : 1;
  LatticeTet tet{{center, center, center, center}, {}};
  tet.nodes[1][static_cast<std::size_t>(c)] += 2 * sign_c;
  for (std::size_t end = 2; end < 4; ++end) {
    tet.nodes[end][static_cast<std::size_t>(c)] += sign_c;
    tet.nodes[end][static_cast<std::size_t>(a)] += sign_a;
    tet.nodes[end][static_cast<std::size_t>(b)] += end == 2 ? -1 : 1;
  }
  const double edge = std::abs(d[a]), beyond = 0.5 * (std::abs(d[c]) - edge);
  tet.weights = {1.0 - edge - beyond, beyond, 0.5 * (edge - d[b]), 0.5 * (edge + d[b])};
  return tet;
}

}  // namespace softreel
