#include "core/tetmesh/surface/signed_distance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/mesh/surface_mesh.h"
#include "core/mesh/winding_number.h"
#include "core/tetmesh/surface/narrow_band.h"
#include "core/tetmesh/surface/overlaps.h"
#include "core/tetmesh/surface/row_crossings.h"

namespace softreel {
namespace {

/// In a hole the distance is this many voxels a unit of winding number: steep, so that it rules in the hole only.
constexpr double kHoleSlope = 8.0 * kBandVoxels;

constexpr std::int64_t kDistanceGrain = 256;

/// No triangle is within this share of a node's distance, whatever the round-off.
constexpr double kFree = 0.999;

/// So many rows along the box's diagonal are looked at for overlaps.
constexpr double kRows = 800;

/// A lattice node with its distance, which is signed once it is known; nearest is -1 beyond the band.
using KnownNode = BandNode;

/// Signs from the exact crossings of a closed surface; the inside beyond the band is appended.
void sign_closed(std::vector<KnownNode>& nodes, LatticeNodeSet& known, const RowCrossings& crossings) {
  for (KnownNode& node : nodes)
    if (crossings.winding(node.node) != 0) node.distance = -node.distance;
  crossings.visit_inside([&](const LatticeNode& node) {
    if (known.insert(node)) nodes.push_back({node, -kBandVoxels, -1});
  });
}

/// Signs from the winding numbers of an open surface. Near the surface |winding| is 1 or 0 and the distance stands; in
/// the holes it passes 1/2 smoothly, and the distance shrinks with it, so that the sign still changes at a zero.
void sign_open(std::vector<KnownNode>& nodes, std::size_t begin, const WindingNumber& winding,
               const LatticeFrame& frame, const Threads& threads) {
  threads.for_chunks(
      static_cast<std::int64_t>(nodes.size() - begin), kDistanceGrain, [&](std::int64_t from, std::int64_t to) {
        for (auto i = begin + static_cast<std::size_t>(from); i < begin + static_cast<std::size_t>(to); ++i) {
          const double beyond = std::abs(winding(lattice_position(frame, nodes[i].node))) - 0.5;
          const double limit = kHoleSlope * std::abs(beyond);
          nodes[i].distance = std::min(nodes[i].distance, limit);
          if (beyond > 0) nodes[i].distance = -nodes[i].distance;
        }
      });
}

/// Appends what is missing of the neighbours of inside nodes, as outside; in waves, so that the order does not depend
/// on threads. Round an open surface signs are measured at every step, and the walk goes on through the inside.
void add_neighbors(std::vector<KnownNode>& nodes, LatticeNodeSet& known,
                   const std::function<void(std::size_t)>& sign_from) {
  for (std::size_t begin = 0; begin < nodes.size();) {
    const std::size_t end = nodes.size();
    for (std::size_t i = begin; i < end; ++i) {
      if (!(nodes[i].distance < 0)) continue;
      const LatticeNode node = nodes[i].node;
      for (std::size_t k = 0; k < kNeighbors; ++k)
        if (const LatticeNode neighbor = lattice_neighbor(node, k); known.insert(neighbor))
          nodes.push_back({neighbor, kBandVoxels, -1});
    }
    sign_from(end);
    begin = end;
  }
}

}  // namespace

SurfaceDistance measure_distance(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                                 const LatticeFrame& frame, const Threads& threads) {
  std::vector<KnownNode> nodes = measure_narrow_band(positions, triangles, frame, threads);
  SurfaceDistance result;
  LatticeNodeSet& known = result.lattice.nodes;
  for (const KnownNode& node : nodes) known.insert(node.node);
  if (has_integer_windings(positions, triangles)) {
    sign_closed(nodes, known, RowCrossings(positions, triangles, frame));
    add_neighbors(nodes, known, [](std::size_t) {});
  } else {
    const WindingNumber winding(positions, triangles);
    sign_open(nodes, 0, winding, frame, threads);
    add_neighbors(nodes, known, [&](std::size_t begin) { sign_open(nodes, begin, winding, frame, threads); });
  }
  known.number_nodes();
  result.lattice.frame = frame;
  result.lattice.values.resize(nodes.size());
  result.nearest_triangles.resize(nodes.size());
  for (const KnownNode& node : nodes) {
    const auto i = static_cast<std::size_t>(known.find(node.node));
    result.lattice.values[i] = node.distance * 0.5 * frame.spacing;
    result.nearest_triangles[i] = node.nearest;
  }
  return result;
}

DistanceSampler::DistanceSampler(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles)
    : tree_(positions, triangles) {
  if (!has_integer_windings(positions, triangles)) {
    winding_.emplace(positions, triangles);
    return;
  }
  Bounds box;
  for (const Triangle& triangle : triangles)
    for (const Index v : triangle) box.add(positions[static_cast<std::size_t>(v)]);
  if (triangles.empty() || !(box.diagonal() > 0)) return;
  near_overlaps_ = find_near_overlaps(positions, triangles, {box.center(), box.diagonal() / kRows});
}

double DistanceSampler::sign(double distance, const LatticeFrame& frame, const LatticeNode& node, const Vec3& p,
                             const SignedPlace& last) const {
  if (winding_) {
    const double beyond = std::abs((*winding_)(p)) - 0.5;
    const double limited = std::min(distance, 0.5 * frame.spacing * kHoleSlope * std::abs(beyond));
    return beyond > 0 ? -limited : limited;
  }
  // What lies within the distance of a place is on its side of the surface.
  const bool is_known = last.value != 0 && (p - last.point).norm() < kFree * std::max(distance, std::abs(last.value));
  const bool inside = is_known ? last.value < 0 : winding_of_node(tree_, frame, node) != 0;
  return inside ? -distance : distance;
}

SurfaceDistance DistanceSampler::sample(const LatticeFrame& frame, LatticeNodeSet nodes,
                                        const std::vector<double>& reaches, const SurfaceDistance& known,
                                        const Threads& threads) const {
  SurfaceDistance result;
  result.lattice.frame = frame;
  result.lattice.nodes = std::move(nodes);
  const std::vector<LatticeNode>& list = result.lattice.nodes.nodes();
  result.lattice.values.resize(list.size());
  result.nearest_triangles.resize(list.size());
  threads.for_chunks(static_cast<std::int64_t>(list.size()), kDistanceGrain, [&](std::int64_t begin, std::int64_t end) {
    SignedPlace last{Vec3::Zero(), 0};
    Index guess = -1;
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const Vec3 p = lattice_position(frame, list[i]);
      if (const Index number = known.lattice.nodes.find(list[i]); number >= 0) {
        last = {p, known.lattice.values[static_cast<std::size_t>(number)]};
        result.nearest_triangles[i] = known.nearest_triangles[static_cast<std::size_t>(number)];
      } else {
        const TriangleTree::Nearest found = tree_.nearest_from(p, guess, -1, reaches[i] * reaches[i]);
        if (found.place >= 0) guess = found.place;
        last = {p, sign(std::sqrt(found.squared_distance), frame, list[i], p, last)};
        result.nearest_triangles[i] = found.triangle;
      }
      result.lattice.values[i] = last.value;
    }
  });
  return result;
}

}  // namespace softreel
