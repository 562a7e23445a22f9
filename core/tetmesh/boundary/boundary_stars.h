/// The boundary of stuffed tetrahedra by its nodes: the elements, faces and edges round each, and what angles they
/// have.
#pragma once

#include <array>
#include <numeric>
#include <span>
#include <vector>

#include "core/tetmesh/stuffing/isosurface_stuffing.h"

namespace softreel {

/// Lists of numbers of different lengths in one block of memory.
class CompressedList {
 public:
  CompressedList() = default;
  /// visit(with) calls with(list, item) for all items, in the order that they are to have in their lists; twice.
  template <typename Visit>
  CompressedList(std::size_t lists, const Visit& visit) : offsets_(lists + 1, 0) {
    visit([&](std::size_t list, Index) { ++offsets_[list + 1]; });
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    items_.resize(static_cast<std::size_t>(offsets_.back()));
    std::vector<Index> next(offsets_.begin(), offsets_.end() - 1);
    visit([&](std::size_t list, Index item) { items_[static_cast<std::size_t>(next[list]++)] = item; });
  }

  std::span<const Index> of(std::size_t list) const {
    return {items_.data() + offsets_[list], static_cast<std::size_t>(offsets_[list + 1] - offsets_[list])};
  }

 private:
  std::vector<Index> offsets_, items_;
};

/// Cosines of the dihedral angles of some elements; `positive` if all have volume.
struct CosineRange {
  double low = 1, high = -1;
  bool positive = true;

  void add(const std::array<Vec3, 4>& x);
  bool is_within(const CosineRange& bounds) const { return positive && low >= bounds.low && high <= bounds.high; }
};

struct BoundaryStars {
  explicit BoundaryStars(const StuffedMesh& stuffed);

  /// Of the elements at boundary node `b`.
  CosineRange cosines(const TetMesh& mesh, std::size_t b) const;

  /// Where the nodes of each face are.
  std::vector<std::array<Vec3, 3>> face_corners(const TetMesh& mesh) const;

  std::vector<BoundaryFace> faces;                 ///< nodes of each ascending
  std::vector<std::array<Index, 2>> edges;         ///< of the boundary, nodes ascending
  std::vector<Index> nodes, numbers;               ///< nodes on the boundary; per mesh node its place there, -1 inside
  CompressedList elements_of, faces_of, edges_of;  ///< per boundary node
};

}  // namespace softreel
