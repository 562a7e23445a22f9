#include "core/multigrid/transfer.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/base/check.h"

namespace softreel {
namespace {

/// One fine node's dependence on one lattice node; `coarse` is found last.
struct Dependence {
  std::uint64_t key;
  Index fine;
  LatticeNode corner;
  double weight;
  Index coarse;
};

/// Kept weights of a point in its lattice tetrahedron, renormalised. The largest is at least 1/4 and is never dropped.
void add_dependences(const LatticeFrame& frame, const Vec3& point, Index fine, double dropped_weight,
                     std::vector<Dependence>& all) {
  const LatticeTet tet = locate_in_lattice(frame, point);
  const double largest = *std::max_element(tet.weights.begin(), tet.weights.end());
  const double limit = std::min(dropped_weight, largest);
  double kept = 0;
  for (const double weight : tet.weights) kept += weight >= limit ? weight : 0;
  for (std::size_t k = 0; k < 4; ++k)
    if (tet.weights[k] >= limit && tet.weights[k] > 0)
      all.push_back({lattice_key(tet.nodes[k]), fine, tet.nodes[k], tet.weights[k] / kept, -1});
}

/// Joins the fine nodes that depend on one lattice node into connected parts.
class PartFinder {
 public:
  PartFinder(const LevelNodes& fine, const BlockPattern& pattern, double contrast)
      : fine_(fine), pattern_(pattern), contrast_(contrast), place_(fine.positions.size(), -1) {
    if (fine.block_stiffness.empty()) return;
    for (Index i = 0; i < pattern.rows(); ++i)
      node_stiffness_.push_back(fine.block_stiffness[static_cast<std::size_t>(pattern.find(i, i))]);
  }

  /// Sets `coarse` of each dependence to first + the number of its part, numbered by first node; returns the count.
  /// The dependences are those of one lattice node, ordered by fine node.
  Index number_parts(std::span<Dependence> group, Index first) {
    for (std::size_t g = 0; g < group.size(); ++g) {
      place_[static_cast<std::size_t>(group[g].fine)] = static_cast<Index>(g);
      group[g].coarse = -1;
    }
    Index parts = 0;
    for (std::size_t g = 0; g < group.size(); ++g)
      if (group[g].coarse < 0) flood(group, static_cast<Index>(g), first + parts++);
    for (const Dependence& member : group) place_[static_cast<std::size_t>(member.fine)] = -1;
    return parts;
  }

 private:
  void flood(std::span<Dependence> group, Index start, Index part) {
    open_.assign(1, start);
    group[static_cast<std::size_t>(start)].coarse = part;
    while (!open_.empty()) {
      const auto node = static_cast<std::size_t>(group[static_cast<std::size_t>(open_.back())].fine);
      open_.pop_back();
      for (std::int64_t b = pattern_.row_offsets[node]; b < pattern_.row_offsets[node + 1]; ++b) {
        const auto neighbor = static_cast<std::size_t>(pattern_.column_indices[static_cast<std::size_t>(b)]);
        const Index place = place_[neighbor];
        if (place < 0 || group[static_cast<std::size_t>(place)].coarse >= 0 || separated(node, neighbor, b)) continue;
        group[static_cast<std::size_t>(place)].coarse = part;
        open_.push_back(place);
      }
    }
  }

  /// Whether the edge a-b, block `block`, is much softer than what it would join.
  bool separated(std::size_t a, std::size_t b, std::int64_t block) const {
    if (node_stiffness_.empty()) return false;
    const double stiffer_end = std::max(node_stiffness_[a], node_stiffness_[b]);
    return stiffer_end > contrast_ * fine_.block_stiffness[static_cast<std::size_t>(block)];
  }

  const LevelNodes& fine_;
  const BlockPattern& pattern_;
  double contrast_;
  std::vector<double> node_stiffness_;
  std::vector<Index> place_;  ///< of each fine node in the present group, -1 outside
  std::vector<Index> open_;
};

/// A node is replaced by those of a coarse lattice if that is so much coarser: of fewer fine nodes than that coarse
/// ones could not be told apart.
constexpr double kLeastCoarsening = 1.4;

bool stays(const LevelNodes& fine, std::size_t node, const LatticeFrame& frame) {
  return !fine.spacings.empty() && frame.spacing < kLeastCoarsening * fine.spacings[node];
}

std::vector<Dependence> find_dependences(const LevelNodes& fine, const LatticeFrame& frame, double dropped_weight) {
  std::vector<Dependence> all;
  all.reserve(3 * fine.positions.size());
  for (std::size_t i = 0; i < fine.positions.size(); ++i)
    if (!stays(fine, i, frame)) add_dependences(frame, fine.positions[i], static_cast<Index>(i), dropped_weight, all);
  std::sort(all.begin(), all.end(),
            [](const Dependence& a, const Dependence& b) { return a.key != b.key ? a.key < b.key : a.fine < b.fine; });
  return all;
}

/// Weights by coarse rows; fine nodes ascend within a group and groups of one part are contiguous in `all`.
WeightMatrix make_restriction(std::vector<Dependence>& all, Index coarse_nodes, Index fine_nodes) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Dependence& a, const Dependence& b) { return a.coarse < b.coarse; });
  WeightMatrix restriction;
  restriction.columns = fine_nodes;
  restriction.row_offsets.assign(static_cast<std::size_t>(coarse_nodes) + 1, 0);
  for (const Dependence& d : all) {
    ++restriction.row_offsets[static_cast<std::size_t>(d.coarse) + 1];
    restriction.column_indices.push_back(d.fine);
    restriction.weights.push_back(d.weight);
  }
  std::partial_sum(restriction.row_offsets.begin(), restriction.row_offsets.end(), restriction.row_offsets.begin());
  return restriction;
}

}  // namespace

Coarsening coarsen(const LevelNodes& fine, const BlockPattern& pattern, const LatticeFrame& frame,
                   const CoarseningParams& params) {
  if (!fine.block_stiffness.empty()) CHECK(static_cast<std::int64_t>(fine.block_stiffness.size()) == pattern.blocks());
  std::vector<Dependence> all = find_dependences(fine, frame, params.dropped_weight);
  PartFinder finder(fine, pattern, params.stiffness_contrast);
  Coarsening result;
  Index count = 0;
  for (std::size_t begin = 0; begin < all.size();) {
    std::size_t end = begin;
    while (end < all.size() && all[end].key == all[begin].key) ++end;
    count += finder.number_parts(std::span(all).subspan(begin, end - begin), count);
    result.nodes.positions.resize(static_cast<std::size_t>(count), lattice_position(frame, all[begin].corner));
    begin = end;
  }
  if (!fine.spacings.empty()) result.nodes.spacings.assign(static_cast<std::size_t>(count), frame.spacing);
  for (std::size_t i = 0; i < fine.positions.size(); ++i) {
    if (!stays(fine, i, frame)) continue;
    all.push_back({0, static_cast<Index>(i), {}, 1.0, count++});
    result.nodes.positions.push_back(fine.positions[i]);
    result.nodes.spacings.push_back(fine.spacings[i]);
    ++result.staying;
  }
  result.prolongation = transpose(make_restriction(all, count, static_cast<Index>(fine.positions.size())));
  return result;
}

std::vector<double> restrict_stiffness(const std::vector<double>& block_stiffness, const BlockPattern& pattern,
                                       const WeightMatrix& prolongation, const BlockPattern& coarse_pattern) {
  if (block_stiffness.empty()) return {};
  std::vector<double> result(static_cast<std::size_t>(coarse_pattern.blocks()), 0.0);
  const auto parents = [&](std::size_t node) {
    return std::span(prolongation.column_indices)
        .subspan(static_cast<std::size_t>(prolongation.row_offsets[node]),
                 static_cast<std::size_t>(prolongation.row_offsets[node + 1] - prolongation.row_offsets[node]));
  };
  for (std::size_t l = 0; l < static_cast<std::size_t>(pattern.rows()); ++l)
    for (std::int64_t b = pattern.row_offsets[l]; b < pattern.row_offsets[l + 1]; ++b) {
      const auto k = static_cast<std::size_t>(pattern.column_indices[static_cast<std::size_t>(b)]);
      for (const Index i : parents(l))
        for (const Index j : parents(k)) {
          double& stiffest = result[static_cast<std::size_t>(coarse_pattern.find(i, j))];
          stiffest = std::max(stiffest, block_stiffness[static_cast<std::size_t>(b)]);
        }
    }
  return result;
}

namespace {

/// Weighted sum of the nodes of `from` that row `i` names.
template <typename Scalar>
NodeLanes<Scalar> weighted_sum(const WeightMatrix& weights, std::int64_t i, const NodeVector<Scalar>& from) {
  const std::int64_t* const offsets = weights.row_offsets.data();
  NodeLanes<Scalar> sum = NodeLanes<Scalar>::Zero();
  for (std::int64_t entry = offsets[i]; entry < offsets[i + 1]; ++entry)
    sum += static_cast<Scalar>(weights.weights.data()[entry]) * lanes(from, weights.column_indices.data()[entry]);
  return sum;
}

}  // namespace

template <typename Scalar>
void restrict_to(const WeightMatrix& restriction, const NodeVector<Scalar>& fine, NodeVector<Scalar>& coarse,
                 const Threads& threads) {
  threads.for_chunks(restriction.rows(), kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) lanes(coarse, i) = weighted_sum(restriction, i, fine);
  });
}

template <typename Scalar>
void prolong_add(const WeightMatrix& prolongation, std::span<const std::uint8_t> fixed,
                 const NodeVector<Scalar>& coarse, NodeVector<Scalar>& fine, const Threads& threads) {
  threads.for_chunks(prolongation.rows(), kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      if (fixed.empty() || !fixed[static_cast<std::size_t>(i)]) lanes(fine, i) += weighted_sum(prolongation, i, coarse);
  });
}

template void restrict_to(const WeightMatrix&, const NodeVector<float>&, NodeVector<float>&, const Threads&);
template void restrict_to(const WeightMatrix&, const NodeVector<double>&, NodeVector<double>&, const Threads&);
template void prolong_add(const WeightMatrix&, std::span<const std::uint8_t>, const NodeVector<float>&,
                          NodeVector<float>&, const Threads&);
template void prolong_add(const WeightMatrix&, std::span<const std::uint8_t>, const NodeVector<double>&,
                          NodeVector<double>&, const Threads&);

}  // namespace softreel
