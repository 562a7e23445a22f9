/// Signed distances of a sculpture at the nodes of a lattice of cubes, drawn together by its lenses.
#pragma once

#include <array>
#include <vector>

#include "assets/generator/sculpture.h"
#include "core/base/parallel.h"

namespace softreel::sculpt {

/// Samples blocks of cells near the surface; elsewhere only the sign is right.
class Lattice {
 public:
  Lattice(const Sculpture& sculpture, const Threads& threads);

  std::size_t size() const { return values_.size(); }
  std::size_t index(const std::array<int, 3>& node) const {
    return (static_cast<std::size_t>(node[2]) * static_cast<std::size_t>(nodes_[1]) +
            static_cast<std::size_t>(node[1])) *
               static_cast<std::size_t>(nodes_[0]) +
           static_cast<std::size_t>(node[0]);
  }
  double value(const std::array<int, 3>& node) const { return values_[index(node)]; }
  /// Where a node lies, seen through the sculpture's lenses.
  Vec3 point(const std::array<int, 3>& node) const;

  /// Calls visit(cell) for each cell, named by its lowest node, in order of memory.
  template <typename Visit>
  void for_each_cell(const Visit& visit) const {
    for (int z = 0; z + 1 < nodes_[2]; ++z)
      for (int y = 0; y + 1 < nodes_[1]; ++y)
        for (int x = 0; x + 1 < nodes_[0]; ++x) visit(std::array<int, 3>{x, y, z});
  }

 private:
  void fill_block(const Sculpture& sculpture, const std::array<int, 3>& first);

  Vec3 origin_;
  double cell_;
  std::vector<Lens> lenses_;
  std::array<int, 3> nodes_{};
  std::vector<double> values_;
};

}  // namespace softreel::sculpt
