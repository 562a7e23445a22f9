/// Signed distance from the nodes of a BCC lattice to a triangle surface.
///
/// Distances are exact in a narrow band and not asked for beyond it. Signs are winding numbers, generalised where the
/// surface is open, so that dirty surfaces have an inside too.
#pragma once

#include <optional>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/mesh/winding_number.h"
#include "core/tetmesh/lattice/lattice_nodes.h"
#include "core/tetmesh/surface/row_crossings.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {

/// Signed distances of all inside nodes and their neighbours.
struct SurfaceDistance {
  LatticeDistance lattice;
  std::vector<Index> nearest_triangles;  ///< per lattice node: a triangle near it, -1 beyond the narrow band
};

/// Distances (m, negative inside, at most one spacing where the sign is beyond doubt) from the nodes of the lattice at
/// `frame` to the surface. Inside is where the winding number is nearer to 1 or -1 than to 0. In the holes of an open
/// surface the distance follows the winding number.
/// Cost: the band and the inside, never the bounding box.
SurfaceDistance measure_distance(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                                 const LatticeFrame& frame, const Threads& threads);

/// The same for nodes of any choice: those of an octree, whose sizes differ.
class DistanceSampler {
 public:
  DistanceSampler(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles);

  /// Distances of all `nodes` (numbered, of the lattice at `frame`), m; at most `reaches`, one a node. What `known`, an
  /// earlier result, has is taken from there.
  SurfaceDistance sample(const LatticeFrame& frame, LatticeNodeSet nodes, const std::vector<double>& reaches,
                         const SurfaceDistance& known, const Threads& threads) const;

  const TriangleTree& tree() const { return tree_; }
  /// Triangles near a place that the surface, if it is closed, goes more than once round on some of the lattice's rows:
  /// 1 where overlapping pieces may hide one. Empty: no row has such a place.
  const std::vector<std::uint8_t>& near_overlaps() const { return near_overlaps_; }

 private:
  struct SignedPlace {
    Vec3 point;
    double value;  ///< its signed distance, m
  };

  /// The distance of a node at `p` with its sign. last: a place near it, of value 0 if there is none.
  double sign(double distance, const LatticeFrame& frame, const LatticeNode& node, const Vec3& p,
              const SignedPlace& last) const;

  TriangleTree tree_;
  std::vector<std::uint8_t> near_overlaps_;
  std::optional<WindingNumber> winding_;  ///< of an open surface
};

}  // namespace softreel
