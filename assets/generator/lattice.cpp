#include "assets/generator/lattice.h"

#include <algorithm>
#include <cmath>

namespace softreel::sculpt {

namespace {

constexpr int kBlock = 8;  // nodes along an edge of the blocks that are sampled or skipped as one

}  // namespace

Lattice::Lattice(const Sculpture& sculpture, const Threads& threads)
    : origin_(sculpture.bounds.min), cell_(sculpture.cell), lenses_(sculpture.lenses) {
  for (int k = 0; k < 3; ++k)
    nodes_[static_cast<std::size_t>(k)] = static_cast<int>(std::ceil(sculpture.bounds.size()[k] / cell_)) + 1;
  values_.resize(static_cast<std::size_t>(nodes_[0]) * static_cast<std::size_t>(nodes_[1]) *
                 static_cast<std::size_t>(nodes_[2]));
  const std::int64_t slabs = (nodes_[2] + kBlock - 1) / kBlock;
  threads.for_chunks(slabs, 1, [&](std::int64_t slab, std::int64_t) {
    for (int y = 0; y < nodes_[1]; y += kBlock)
      for (int x = 0; x < nodes_[0]; x += kBlock) fill_block(sculpture, {x, y, static_cast<int>(slab) * kBlock});
  });
}

Vec3 Lattice::point(const std::array<int, 3>& node) const {
  Vec3 p = origin_ + cell_ * Vec3(double(node[0]), double(node[1]), double(node[2]));
  for (const Lens& lens : lenses_) {
    const Vec3 offset = p - lens.center;
    const double inside = std::max(0.0, 1 - offset.squaredNorm() / (lens.radius * lens.radius));
    p -= lens.strength * inside * inside * offset;
  }
  return p;
}

void Lattice::fill_block(const Sculpture& sculpture, const std::array<int, 3>& first) {
  const double half = 0.5 * (kBlock - 1) * cell_;
  const double middle =
      sculpture.distance(point({first[0] + kBlock / 2, first[1] + kBlock / 2, first[2] + kBlock / 2}));
  // Three times the half diagonal: the slope of the distances may pass 1, and a lens widens the cells at its rim.
  const bool far = std::abs(middle) > 3 * std::sqrt(3.0) * half;
  std::array<int, 3> end{};
  for (std::size_t k = 0; k < 3; ++k) end[k] = std::min(first[k] + kBlock, nodes_[k]);
  for (int z = first[2]; z < end[2]; ++z)
    for (int y = first[1]; y < end[1]; ++y)
      for (int x = first[0]; x < end[0]; ++x)
        values_[index({x, y, z})] = far ? middle : sculpture.distance(point({x, y, z}));
}

}  // namespace softreel::sculpt
