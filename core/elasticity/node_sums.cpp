#include "core/elasticity/node_sums.h"

#include <algorithm>
#include <limits>

#include "core/base/check.h"

namespace softreel {
namespace {

constexpr std::int64_t kSumGrain = 1024;
constexpr std::size_t kSlabElements = kSlabBatches * kElementLanes;
static_assert(4 * kSlabElements <= std::numeric_limits<std::uint16_t>::max());

}  // namespace

NodeSlabs make_node_slabs(const std::vector<Tet>& tets, std::size_t nodes) {
  const std::size_t batches = (tets.size() + kElementLanes - 1) / kElementLanes;
  NodeSlabs slabs;
  slabs.places.resize(4 * kElementLanes * batches);
  slabs.slab_offsets.push_back(0);
  slabs.node_offsets.assign(nodes + 1, 0);
  std::vector<Index> own;
  for (std::size_t first = 0; first < tets.size(); first += kSlabElements) {
    const std::size_t end = std::min(first + kSlabElements, tets.size());
    own.clear();
    for (std::size_t e = first; e < end; ++e) own.insert(own.end(), tets[e].begin(), tets[e].end());
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    const std::size_t padded = kElementLanes * ((end + kElementLanes - 1) / kElementLanes);
    for (std::size_t e = first; e < padded; ++e)
      for (std::size_t k = 0; k < 4; ++k) {
        const auto place = std::lower_bound(own.begin(), own.end(), tets[std::min(e, end - 1)][k]) - own.begin();
        slabs.places[4 * kElementLanes * (e / kElementLanes) + kElementLanes * k + e % kElementLanes] =
            static_cast<std::uint16_t>(place);
      }
    slabs.nodes.insert(slabs.nodes.end(), own.begin(), own.end());
    slabs.slab_offsets.push_back(static_cast<std::uint32_t>(slabs.nodes.size()));
  }
  CHECK(slabs.nodes.size() < std::numeric_limits<std::uint32_t>::max());
  for (const Index node : slabs.nodes) ++slabs.node_offsets[static_cast<std::size_t>(node) + 1];
  for (std::size_t i = 1; i < slabs.node_offsets.size(); ++i) slabs.node_offsets[i] += slabs.node_offsets[i - 1];
  slabs.node_sums.resize(slabs.nodes.size());
  std::vector<std::uint32_t> next(slabs.node_offsets.begin(), slabs.node_offsets.end() - 1);
  for (std::size_t s = 0; s < slabs.nodes.size(); ++s)
    slabs.node_sums[next[static_cast<std::size_t>(slabs.nodes[s])]++] = static_cast<std::uint32_t>(s);
  slabs.nodes.shrink_to_fit();
  return slabs;
}

std::vector<std::uint8_t> nodes_of_slabs(const NodeSlabs& slabs, std::span<const std::uint8_t> chosen) {
  CHECK(chosen.size() + 1 == slabs.slab_offsets.size());
  std::vector<std::uint8_t> nodes(slabs.node_offsets.size() - 1, 0);
  for (std::size_t slab = 0; slab < chosen.size(); ++slab) {
    if (chosen[slab] == 0) continue;
    for (std::uint32_t sum = slabs.slab_offsets[slab]; sum < slabs.slab_offsets[slab + 1]; ++sum)
      nodes[static_cast<std::size_t>(slabs.nodes[sum])] = 1;
  }
  return nodes;
}

void choose_slabs_of(const NodeSlabs& slabs, Index node, std::span<std::uint8_t> chosen) {
  const auto i = static_cast<std::size_t>(node);
  for (std::uint32_t k = slabs.node_offsets[i]; k < slabs.node_offsets[i + 1]; ++k) {
    const auto after = std::upper_bound(slabs.slab_offsets.begin(), slabs.slab_offsets.end(), slabs.node_sums[k]);
    chosen[static_cast<std::size_t>(after - slabs.slab_offsets.begin()) - 1] = 1;
  }
}

void add_slabs(const NodeSlabs& slabs, const AlignedVector<double>& sums, std::span<Vec3> vectors,
               const Threads& threads) {
  using Lanes = Eigen::Array4d;
  CHECK(vectors.size() + 1 == slabs.node_offsets.size());
  CHECK(sums.size() == 4 * slabs.sums());
  threads.for_chunks(static_cast<std::int64_t>(vectors.size()), kSumGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      Lanes sum = Lanes::Zero();
      for (std::uint32_t k = slabs.node_offsets[i]; k < slabs.node_offsets[i + 1]; ++k)
        sum += Eigen::Map<const Lanes>(sums.data() + std::size_t{4} * slabs.node_sums[k]);
      vectors[i] = sum.head<3>();
    }
  });
}

}  // namespace softreel
