#include "core/constraints/carrier.h"

#include <cmath>

namespace softreel {
namespace {

constexpr double kFlatElement = 1e-3;  ///< share of the volume at rest below which an element carries nothing
constexpr double kInside = 1 + 1e-9;
/// A walk that ends with more has lost its way: a surface is within an element or so of the tetrahedra that carry it.
constexpr double kLost = 4;

void take_better(const Carrier& candidate, Carrier& best) {
  if (candidate.element < 0) return;
  const bool better = best.element < 0 || candidate.reach < best.reach ||
                      (candidate.reach == best.reach && candidate.element < best.element);
  if (better) best = candidate;
}

}  // namespace

Carrier carrier_in(const CarrierMesh& mesh, Index element, const Vec3& point) {
  const Tet& tet = mesh.tets[static_cast<std::size_t>(element)];
  const TetNodes x = nodes_of(tet, mesh.positions), rest = nodes_of(tet, mesh.rest_positions);
  const double volume = 6 * tet_volume(x[0], x[1], x[2], x[3]);
  if (!(volume > kFlatElement * 6 * tet_volume(rest[0], rest[1], rest[2], rest[3]))) return {};
  const std::array<Vec3, 4> d{x[0] - point, x[1] - point, x[2] - point, x[3] - point};
  Carrier carrier{element, {}, 0};
  std::array<double, 4>& w = carrier.weights;
  w[1] = d[0].dot(d[3].cross(d[2])) / volume;
  w[2] = d[0].dot(d[1].cross(d[3])) / volume;
  w[3] = d[0].dot(d[2].cross(d[1])) / volume;
  w[0] = 1.0 - w[1] - w[2] - w[3];
  for (const double weight : w) carrier.reach += std::abs(weight);
  return carrier;
}

Carrier best_carrier_around(const CarrierMesh& mesh, Index element, const Vec3& point) {
  Carrier best = carrier_in(mesh, element, point);
  if (best.element >= 0 && best.reach <= kInside) return best;
  for (const Index node : mesh.tets[static_cast<std::size_t>(element)]) {
    const auto i = static_cast<std::size_t>(node);
    for (std::int64_t k = mesh.node_elements.offsets[i]; k < mesh.node_elements.offsets[i + 1]; ++k) {
      const auto neighbor = static_cast<Index>(mesh.node_elements.entries[static_cast<std::size_t>(k)] / 4);
      take_better(carrier_in(mesh, neighbor, point), best);
    }
  }
  return best;
}

Carrier walk_to_carrier(const CarrierMesh& mesh, Index start, Index first, Index last, const Vec3& point) {
  Carrier best = best_carrier_around(mesh, start, point);
  while (best.element >= 0 && best.reach > kInside) {
    const Carrier next = best_carrier_around(mesh, best.element, point);
    if (!(next.reach < best.reach)) break;
    best = next;
  }
  if (best.element >= 0 && best.reach <= kLost) return best;
  for (Index element = first; element < last; ++element) take_better(carrier_in(mesh, element, point), best);
  return best;
}

}  // namespace softreel
