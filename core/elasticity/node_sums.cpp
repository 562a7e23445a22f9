#include "core/elasticity/node_sums.h"

#include <algorithm>
#include <limits>

#include "core/base/check.h"

namespace softreel {
namespace {

constexpr std::int64_t kNodeGrain = 1024;
constexpr std::size_t kSlabElements = kSlabBatches * kElementLanes;
static_assert(4 * kSlabElements <= std::numeric_limits<std::uint16_t>::max());

}  // namespace

NodeSlabs make_node_slabs(const std::vector<Tet>& tets, std::size_t nodes) {
  const std::size_t batches = (tets.size() + kElementLanes - 1) / kElementLanes;
  NodeSlabs slabs;
  slabs.places.resize(4 * kElementLanes * batches);
  slabs.slab_offsets.push_back(0);
  slabs.node_offsets.assign(nodes + 1, 0);
  std::vector<Index> node_of_sum, own;
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
    node_of_sum.insert(node_of_sum.end(), own.begin(), own.end());
    slabs.slab_offsets.push_back(static_cast<std::uint32_t>(node_of_sum.size()));
  }
  CHECK(node_of_sum.size() < std::numeric_limits<std::uint32_t>::max());
  for (const Index node : node_of_sum) ++slabs.node_offsets[static_cast<std::size_t>(node) + 1];
  for (std::size_t i = 1; i < slabs.node_offsets.size(); ++i) slabs.node_offsets[i] += slabs.node_offsets[i - 1];
  slabs.node_sums.resize(node_of_sum.size());
  std::vector<std::uint32_t> next(slabs.node_offsets.begin(), slabs.node_offsets.end() - 1);
  for (std::size_t s = 0; s < node_of_sum.size(); ++s)
    slabs.node_sums[next[static_cast<std::size_t>(node_of_sum[s])]++] = static_cast<std::uint32_t>(s);
  return slabs;
}

void add_slabs(const NodeSlabs& slabs, const AlignedVector<double>& sums, std::span<Vec3> vectors,
               const Threads& threads) {
  using Lanes = Eigen::Array4d;
  CHECK(vectors.size() + 1 == slabs.node_offsets.size());
  CHECK(sums.size() == 4 * slabs.sums());
  threads.for_chunks(static_cast<std::int64_t>(vectors.size()), kNodeGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      Lanes sum = Lanes::Zero();
      for (std::uint32_t k = slabs.node_offsets[i]; k < slabs.node_offsets[i + 1]; ++k)
        sum += Eigen::Map<const Lanes>(sums.data() + std::size_t{4} * slabs.node_sums[k]);
      vectors[i] = sum.head<3>();
    }
  });
}

}  // namespace softreel
