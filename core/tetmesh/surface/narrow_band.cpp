#include "core/tetmesh/surface/narrow_band.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/tetmesh/key_index.h"
#include "core/tetmesh/surface/triangle_halves.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

/// Triangles are sorted into cubes of so many voxels, which are measured one by one; the band adds half of that on
/// either side.
constexpr std::int32_t kBlockSize = 8;

std::int32_t block_of(double voxel) {
  return static_cast<std::int32_t>(std::floor(voxel / kBlockSize));
}

/// The box of a triangle and its band.
struct Reach {
  Vec3 min, max;
  explicit Reach(const TriangleCorners& x)
      : min(x[0].cwiseMin(x[1]).cwiseMin(x[2]).array() - kBandVoxels),
        max(x[0].cwiseMax(x[1]).cwiseMax(x[2]).array() + kBandVoxels) {}
};

/// Triangles near each block of the lattice.
class Blocks {
 public:
  struct Block {
    LatticeNode place;  // in blocks
    std::vector<Index> triangles;
  };

  Blocks(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles, const LatticeFrame& frame)
      : positions_(positions), triangles_(triangles), frame_(frame) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const TriangleCorners x = corners(static_cast<Index>(t));
      if (!x[0].allFinite() || !x[1].allFinite() || !x[2].allFinite()) continue;
      add(x, static_cast<Index>(t));
    }
  }

  const std::vector<Block>& list() const { return blocks_; }

  /// Corners in voxels; the origin is subtracted in double, so that nothing is lost far from the world's origin.
  TriangleCorners corners(Index triangle) const {
    TriangleCorners x;
    for (std::size_t k = 0; k < 3; ++k)
      x[k] = (positions_[static_cast<std::size_t>(triangles_[static_cast<std::size_t>(triangle)][k])] - frame_.origin) *
             (2.0 / frame_.spacing);
    return x;
  }

 private:
  /// A large triangle is halved first, so that it does not fill the whole of its box.
  void add(const TriangleCorners& x, Index triangle) {
    const Reach reach(x);
    if ((reach.max - reach.min).maxCoeff() > 2 * kBlockSize) {
      for (const TriangleCorners& half : halved(x)) add(half, triangle);
      return;
    }
    for (std::int32_t i = block_of(reach.min[0]); i <= block_of(reach.max[0]); ++i)
      for (std::int32_t j = block_of(reach.min[1]); j <= block_of(reach.max[1]); ++j)
        for (std::int32_t k = block_of(reach.min[2]); k <= block_of(reach.max[2]); ++k) add_to({i, j, k}, triangle);
  }

  void add_to(const LatticeNode& place, Index triangle) {
    const auto [number, is_new] = index_.insert(lattice_key(place));
    if (is_new) blocks_.push_back({place, {}});
    std::vector<Index>& list = blocks_[static_cast<std::size_t>(number)].triangles;
    if (list.empty() || list.back() != triangle) list.push_back(triangle);
  }

  const std::vector<Vec3>& positions_;
  const std::vector<Triangle>& triangles_;
  const LatticeFrame& frame_;
  KeyIndex index_;
  std::vector<Block> blocks_;
};

/// The nodes of one block while they are measured: those of the even and the odd sublattice.
class BlockBand {
 public:
  explicit BlockBand(const LatticeNode& place)
      : low_{place[0] * kBlockSize, place[1] * kBlockSize, place[2] * kBlockSize} {
    squared_.fill(kBandVoxels * kBandVoxels * (1 + 1e-12));
    nearest_.fill(-1);
  }

  /// Triangles come in ascending order: of equal distances the first stays.
  void add(const TriangleCorners& x, Index triangle) {
    const Reach reach(x);
    const Vec3 area = (x[1] - x[0]).cross(x[2] - x[0]);
    const double most = kBandVoxels * kBandVoxels * area.squaredNorm() * (1 + 1e-9);
    std::array<std::int32_t, 3> begin, end;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<int>(k);
      begin[k] = std::max(low_[k], static_cast<std::int32_t>(std::ceil(std::max(reach.min[axis], -1e9))));
      end[k] = std::min(low_[k] + kBlockSize - 1, static_cast<std::int32_t>(std::floor(reach.max[axis])));
    }
    for (std::int32_t i = begin[0]; i <= end[0]; ++i)
      for (std::int32_t j = begin[1] + ((begin[1] ^ i) & 1); j <= end[1]; j += 2)
        for (std::int32_t k = begin[2] + ((begin[2] ^ i) & 1); k <= end[2]; k += 2) {
          const Vec3 p(i, j, k);
          const double height = area.dot(p - x[0]);
          if (height * height <= most) meet({i, j, k}, p, x, triangle);
        }
  }

  void append_to(std::vector<BandNode>& band) const {
    for (std::int32_t odd = 0; odd < 2; ++odd)
      for (std::int32_t i = odd; i < kBlockSize; i += 2)
        for (std::int32_t j = odd; j < kBlockSize; j += 2)
          for (std::int32_t k = odd; k < kBlockSize; k += 2) {
            const LatticeNode node{low_[0] + i, low_[1] + j, low_[2] + k};
            const std::size_t s = slot(node);
            if (nearest_[s] >= 0) band.push_back({node, std::sqrt(squared_[s]), nearest_[s]});
          }
  }

 private:
  static constexpr std::size_t kNodes = kBlockSize * kBlockSize * kBlockSize / 4;

  std::size_t slot(const LatticeNode& node) const {
    const auto i = static_cast<unsigned>(node[0] - low_[0]), j = static_cast<unsigned>(node[1] - low_[1]),
               k = static_cast<unsigned>(node[2] - low_[2]);
    return ((i & 1) * kNodes / 2) + ((i >> 1) * 4 + (j >> 1)) * 4 + (k >> 1);
  }

  void meet(const LatticeNode& node, const Vec3& p, const TriangleCorners& x, Index triangle) {
    const double squared = (nearest_on_triangle(p, x[0], x[1], x[2]) - p).squaredNorm();
    const std::size_t s = slot(node);
    if (!(squared < squared_[s])) return;
    squared_[s] = squared;
    nearest_[s] = triangle;
  }

  LatticeNode low_;
  std::array<double, kNodes> squared_;
  std::array<Index, kNodes> nearest_;
};

}  // namespace

std::vector<BandNode> measure_narrow_band(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                                          const LatticeFrame& frame, const Threads& threads) {
  const Blocks blocks(positions, triangles, frame);
  constexpr std::int64_t kGrain = 16;
  const auto n = static_cast<std::int64_t>(blocks.list().size());
  std::vector<std::vector<BandNode>> chunks(static_cast<std::size_t>((n + kGrain - 1) / kGrain));
  threads.for_chunks(n, kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto b = static_cast<std::size_t>(begin); b < static_cast<std::size_t>(end); ++b) {
      const Blocks::Block& block = blocks.list()[b];
      BlockBand measured(block.place);
      for (const Index triangle : block.triangles) measured.add(blocks.corners(triangle), triangle);
      measured.append_to(chunks[static_cast<std::size_t>(begin / kGrain)]);
    }
  });
  std::vector<BandNode> band;
  for (const auto& chunk : chunks) band.insert(band.end(), chunk.begin(), chunk.end());
  return band;
}

}  // namespace softreel
