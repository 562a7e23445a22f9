#include "assets/generator/lattice.h"

#include <algorithm>
#include <cmath>

namespace softreel::sculpt {

namespace {

constexpr int kBlock = 8;  // nodes along an edge of the blocks that are sampled or skipped as one

}  // namespace

Lattice::Lattice(const Sculpture& sculpture) : origin_(sculpture.bounds.min), cell_(sculpture.cell) {
  for (int k = 0; k < 3; ++k)
    nodes_[static_cast<std::size_t>(k)] = static_cast<int>(std::ceil(sculpture.bounds.size()[k] / cell_)) + 1;
  values_.resize(static_cast<std::size_t>(nodes_[0]) * static_cast<std::size_t>(nodes_[1]) *
                 static_cast<std::size_t>(nodes_[2]));
  for (int z = 0; z < nodes_[2]; z += kBlock)
    for (int y = 0; y < nodes_[1]; y += kBlock)
      for (int x = 0; x < nodes_[0]; x += kBlock) fill_block(sculpture, {x, y, z});
}

void Lattice::fill_block(const Sculpture& sculpture, const std::array<int, 3>& first) {
  const double half = 0.5 * (kBlock - 1) * cell_;
  const double middle = sculpture.distance(point(first) + Vec3::Constant(half));
  // Twice the half diagonal: the distances are bounds, whose slope may pass 1.
  const bool far = std::abs(middle) > 2 * std::sqrt(3.0) * half;
  std::array<int, 3> end{};
  for (std::size_t k = 0; k < 3; ++k) end[k] = std::min(first[k] + kBlock, nodes_[k]);
  for (int z = first[2]; z < end[2]; ++z)
    for (int y = first[1]; y < end[1]; ++y)
      for (int x = first[0]; x < end[0]; ++x)
        values_[index({x, y, z})] = far ? middle : sculpture.distance(point({x, y, z}));
}

}  // namespace softreel::sculpt
