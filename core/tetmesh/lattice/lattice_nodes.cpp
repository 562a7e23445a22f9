#include "core/tetmesh/lattice/lattice_nodes.h"

#include <algorithm>
#include <bit>

#include "core/base/check.h"

namespace softreel {
namespace {

/// Spreads the low 20 bits of a number to every third bit.
std::uint64_t spread_bits(std::uint64_t v) {
  v = (v | (v << 32)) & 0x001f00000000ffffULL;
  v = (v | (v << 16)) & 0x001f0000ff0000ffULL;
  v = (v | (v << 8)) & 0x100f00f00f00f00fULL;
  v = (v | (v << 4)) & 0x10c30c30c30c30c3ULL;
  return (v | (v << 2)) & 0x1249249249249249ULL;
}

std::uint32_t gather_bits(std::uint64_t v) {
  v &= 0x1249249249249249ULL;
  v = (v | (v >> 2)) & 0x10c30c30c30c30c3ULL;
  v = (v | (v >> 4)) & 0x100f00f00f00f00fULL;
  v = (v | (v >> 8)) & 0x001f0000ff0000ffULL;
  v = (v | (v >> 16)) & 0x001f00000000ffffULL;
  return static_cast<std::uint32_t>(v | (v >> 32));
}

constexpr std::int32_t kCellOffset = 1 << 19;

/// Morton code of the node's cubic cell, then its sublattice: 61 bits. The low 7 bits lie within a block.
std::uint64_t morton_key(const LatticeNode& node) {
  const auto cell = [](std::int32_t x) { return static_cast<std::uint64_t>((x >> 1) + kCellOffset); };
  return 2 * (spread_bits(cell(node[0])) | (spread_bits(cell(node[1])) << 1) | (spread_bits(cell(node[2])) << 2)) +
         static_cast<std::uint64_t>(node[0] & 1);
}

LatticeNode node_of_key(std::uint64_t key) {
  const auto odd = static_cast<std::int32_t>(key & 1);
  LatticeNode node;
  for (unsigned k = 0; k < 3; ++k)
    node[k] = 2 * (static_cast<std::int32_t>(gather_bits(key >> (1 + k))) - kCellOffset) + odd;
  return node;
}

constexpr unsigned kBlockBits = 7;

std::size_t word_of(std::uint64_t key) {
  return static_cast<std::size_t>(key >> 6) & 1;
}
std::uint64_t bit_of(std::uint64_t key) {
  return std::uint64_t{1} << (key & 63);
}

}  // namespace

const std::array<LatticeNode, kNeighbors> kNeighborOffsets{{{-2, 0, 0},
                                                            {2, 0, 0},
                                                            {0, -2, 0},
                                                            {0, 2, 0},
                                                            {0, 0, -2},
                                                            {0, 0, 2},
                                                            {-1, -1, -1},
                                                            {1, -1, -1},
                                                            {-1, 1, -1},
                                                            {1, 1, -1},
                                                            {-1, -1, 1},
                                                            {1, -1, 1},
                                                            {-1, 1, 1},
                                                            {1, 1, 1}}};

void LatticeNodeSet::list_block(std::size_t number) {
  table_.insert(static_cast<Index>(number), [&](Index n) { return blocks_[static_cast<std::size_t>(n)].key; });
}

bool LatticeNodeSet::insert(const LatticeNode& node) {
  const std::uint64_t key = morton_key(node);
  Index number = find_block(key >> kBlockBits);
  if (number < 0) {
    number = static_cast<Index>(blocks_.size());
    blocks_.push_back({key >> kBlockBits, {}, 0});
    list_block(blocks_.size() - 1);
  }
  std::uint64_t& bits = blocks_[static_cast<std::size_t>(number)].bits[word_of(key)];
  const bool added = (bits & bit_of(key)) == 0;
  bits |= bit_of(key);
  return added;
}

bool LatticeNodeSet::contains(const LatticeNode& node) const {
  const std::uint64_t key = morton_key(node);
  const Index number = find_block(key >> kBlockBits);
  return number >= 0 && (blocks_[static_cast<std::size_t>(number)].bits[word_of(key)] & bit_of(key)) != 0;
}

void LatticeNodeSet::number_nodes() {
  std::sort(blocks_.begin(), blocks_.end(), [](const Block& a, const Block& b) { return a.key < b.key; });
  blocks_.shrink_to_fit();
  table_.clear();
  Index first = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    list_block(b);
    blocks_[b].first = first;
    first += std::popcount(blocks_[b].bits[0]) + std::popcount(blocks_[b].bits[1]);
  }
  nodes_.clear();
  nodes_.reserve(static_cast<std::size_t>(first));
  for (const Block& block : blocks_)
    for (std::uint64_t word = 0; word < 2; ++word)
      for (std::uint64_t bits = block.bits[word]; bits != 0; bits &= bits - 1)
        nodes_.push_back(
            node_of_key((block.key << kBlockBits) + 64 * word + static_cast<std::uint64_t>(std::countr_zero(bits))));
}

Index LatticeNodeSet::find(const LatticeNode& node) const {
  const std::uint64_t key = morton_key(node);
  const Index number = find_block(key >> kBlockBits);
  if (number < 0) return -1;
  const Block& block = blocks_[static_cast<std::size_t>(number)];
  const std::size_t word = word_of(key);
  if ((block.bits[word] & bit_of(key)) == 0) return -1;
  const int before =
      std::popcount(block.bits[word] & (bit_of(key) - 1)) + (word == 1 ? std::popcount(block.bits[0]) : 0);
  return block.first + before;
}

}  // namespace softreel
