/// An octree over the body-centred cubic lattice, and the tetrahedra of different sizes between its cells.
///
/// Labelle and Shewchuk, Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles, 2007, section 3.3. The
/// nodes are the corners and centres of the leaves. Leaves that touch at a face or an edge differ by at most one level.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/lattice/lattice_nodes.h"

namespace softreel {

/// A cube of the octree. At level 0 it is a cubic cell of the lattice, 2 units of half the spacing wide; each level
/// doubles that.
struct OctreeCell {
  LatticeNode low;  ///< its corner with the smallest coordinates
  std::int32_t level;
  Index first_child = -1;  ///< of 8 that follow one another; -1: a leaf

  std::int32_t width() const { return std::int32_t{2} << level; }
  LatticeNode center() const {
    const std::int32_t half = std::int32_t{1} << level;
    return {low[0] + half, low[1] + half, low[2] + half};
  }
};

class GradedOctree {
 public:
  /// Cells of level `top` that cover `box` and a layer round it. frame: the lattice of level 0.
  GradedOctree(const LatticeFrame& frame, const Bounds& box, std::int32_t top);

  /// Splits the leaves near a triangle until they are of `level` or below; neighbours follow.
  void refine(const std::array<Vec3, 3>& triangle, std::int32_t level);
  /// Splits the leaf that holds a point, and those within `margin` of their widths of it (at most 0.5), likewise.
  void refine(const Vec3& point, std::int32_t level, double margin);

  /// Width of the smallest leaf, m.
  double finest_edge() const;

  /// Level of the leaf that holds a point; the top level outside.
  std::int32_t level_at(const Vec3& point) const;

  const LatticeFrame& frame() const { return frame_; }
  /// All cells, leaves and others, in an order that depends on the calls alone.
  const std::vector<OctreeCell>& cells() const { return cells_; }

  /// Corners and centres of all leaves, numbered.
  LatticeNodeSet nodes() const;

  /// Per node of `set`, which is nodes(): the width of the largest leaf it belongs to, m. No edge there is longer.
  std::vector<double> widths(const LatticeNodeSet& set) const;

  /// Calls visit(nodes) for all tetrahedra between leaves: positive orientation, every face shared by two or on the
  /// outside. `set`: nodes(). Their dihedral angles are 45, 60, 90 or 120 degrees.
  void visit_tets(const LatticeNodeSet& set, const std::function<void(const std::array<LatticeNode, 4>&)>& visit) const;

 private:
  Index find_leaf(const LatticeNode& unit) const;  ///< that holds the unit cube with this low corner; -1 outside
  void split(Index cell);
  template <typename Overlaps>
  void refine_where(const Overlaps& overlaps, const Bounds& box, std::int32_t level);
  Vec3 in_units(const Vec3& point) const { return (point - frame_.origin) * (2.0 / frame_.spacing); }

  LatticeFrame frame_;
  std::int32_t top_;
  LatticeNode low_, counts_;  // of the cells of the top level: first corner, numbers along the axes
  std::vector<OctreeCell> cells_;
};

}  // namespace softreel
