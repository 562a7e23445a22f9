/// Which tetrahedron carries a point of the material best, in any shape of the mesh.
#pragma once

#include <array>
#include <span>

#include "core/base/types.h"
#include "core/elasticity/elastic_body.h"

namespace softreel {

/// A tetrahedron and the barycentric weights of a point in it, never bounded: they give exactly that point. For a point
/// outside they extrapolate.
struct Carrier {
  Index element = -1;  ///< -1: none
  std::array<double, 4> weights{};
  /// Sum of the absolute weights: 1 inside, more the farther outside.
  double reach = 0;
};

/// A mesh in some shape.
struct CarrierMesh {
  const std::vector<Tet>& tets;
  const NodeElements& node_elements;
  const std::vector<Vec3>& rest_positions;
  std::span<const Vec3> positions;  ///< nodes x 3, m
};

/// Weights of a point in an element; none if the element is flat or turned inside out: below a thousandth of its volume
/// at rest.
Carrier carrier_in(const CarrierMesh& mesh, Index element, const Vec3& point);

/// Of the elements that share a node with `element`, itself included, the one of least reach; the lowest of several.
Carrier best_carrier_around(const CarrierMesh& mesh, Index element, const Vec3& point);

/// From `start` from neighbour to neighbour to where the reach is least: never across a gap, as elements that no node
/// joins are no neighbours. Where that way ends far from the point (around a bend, say), all elements in [first, last)
/// are looked at.
Carrier walk_to_carrier(const CarrierMesh& mesh, Index start, Index first, Index last, const Vec3& point);

}  // namespace softreel
