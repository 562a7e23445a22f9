#include "core/sparse/galerkin_gather.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "core/base/check.h"

namespace softreel {
namespace {

constexpr std::int64_t kTargetGrain = 512;

/// A block summed in registers: 8 lanes and one more.
template <typename Scalar>
struct BlockSum {
  using Head = Eigen::Array<Scalar, 8, 1>;
  Head head = Head::Zero();
  Scalar tail = 0;

  void add(const Scalar* block, Scalar weight) {
    head += weight * Eigen::Map<const Head>(block);
    tail += weight * block[8];
  }
  void store(Scalar* block) const {
    Eigen::Map<Head>{block} = head;
    block[8] = tail;
  }
};

/// Calls visit(e, transposed, weight) for each term that block K_lk, l <= k, adds to block e of E, with
/// e = E_ij or, transposed, e = E_ji of the upper triangle.
template <typename Visit>
void for_each_term(const WeightMatrix& Rt, std::size_t l, std::size_t k, const BlockPattern& E, const Visit& visit) {
  for (std::int64_t a = Rt.row_offsets[l]; a < Rt.row_offsets[l + 1]; ++a)
    for (std::int64_t c = Rt.row_offsets[k]; c < Rt.row_offsets[k + 1]; ++c) {
      const Index i = Rt.column_indices[static_cast<std::size_t>(a)];
      const Index j = Rt.column_indices[static_cast<std::size_t>(c)];
      // The pair (j, i) of a diagonal block of K belongs to the lower triangle of E.
      if (l == k && i > j) continue;
      const double weight = Rt.weights[static_cast<std::size_t>(a)] * Rt.weights[static_cast<std::size_t>(c)];
      // A diagonal block of E is added to its own transpose, which would count K_ll twice.
      const double share = l == k && i == j ? 0.5 * weight : weight;
      visit(i <= j ? E.find(i, j) : E.find(j, i), i > j, share);
    }
}

/// Calls visit(b, l, k) for each block b = K_lk with l <= k.
template <typename Visit>
void for_each_upper_block(const BlockPattern& K, const Visit& visit) {
  for (std::size_t l = 0; l < static_cast<std::size_t>(K.rows()); ++l)
    for (std::int64_t b = K.row_offsets[l]; b < K.row_offsets[l + 1]; ++b) {
      const auto k = static_cast<std::size_t>(K.column_indices[static_cast<std::size_t>(b)]);
      if (l <= k) visit(b, l, k);
    }
}

}  // namespace

template <typename Scalar>
auto GalerkinGather<Scalar>::make_targets(const BlockPattern& E_pattern, std::vector<std::uint32_t>& target_of)
    -> std::vector<Target> {
  std::vector<Target> targets;
  target_of.resize(static_cast<std::size_t>(E_pattern.blocks()));
  for (Index i = 0; i < E_pattern.rows(); ++i)
    for (std::int64_t e = E_pattern.row_offsets[static_cast<std::size_t>(i)];
         e < E_pattern.row_offsets[static_cast<std::size_t>(i) + 1]; ++e) {
      const Index j = E_pattern.column_indices[static_cast<std::size_t>(e)];
      if (i > j) continue;
      target_of[static_cast<std::size_t>(e)] = static_cast<std::uint32_t>(targets.size());
      targets.push_back({0, 0, static_cast<std::uint32_t>(e), static_cast<std::uint32_t>(E_pattern.find(j, i))});
    }
  targets.push_back({0, 0, 0, 0});
  return targets;
}

template <typename Scalar>
void GalerkinGather<Scalar>::order_targets(const std::vector<Index>& first, std::vector<Target>& targets,
                                           std::vector<std::uint32_t>& target_of) {
  std::vector<std::uint32_t> order(targets.size() - 1);
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return first[a] < first[b]; });
  std::vector<Target> sorted;
  for (const std::uint32_t t : order) {
    target_of[targets[t].block] = static_cast<std::uint32_t>(sorted.size());
    sorted.push_back(targets[t]);
  }
  sorted.push_back(targets.back());
  targets = std::move(sorted);
}

template <typename Scalar>
GalerkinGather<Scalar>::GalerkinGather(const BlockPattern& K_pattern, const WeightMatrix& R_transposed,
                                       const BlockPattern& E_pattern, std::span<const Index> rank) {
  constexpr std::int64_t kLimit = std::numeric_limits<std::uint32_t>::max();
  CHECK(R_transposed.rows() == K_pattern.rows());
  CHECK(K_pattern.blocks() < kLimit);
  CHECK(E_pattern.blocks() < kLimit);
  std::vector<std::uint32_t> target_of;
  targets_ = make_targets(E_pattern, target_of);
  // Counting sort of the terms by target and kind: counts, then first positions, then the terms in order of K.
  std::vector<Index> first(targets_.size(), std::numeric_limits<Index>::max());  // rank that the target gathers from
  for_each_upper_block(K_pattern, [&](std::int64_t, std::size_t l, std::size_t k) {
    for_each_term(R_transposed, l, k, E_pattern, [&](std::int64_t e, bool transposed, double) {
      const std::size_t t = target_of[static_cast<std::size_t>(e)];
      ++(transposed ? targets_[t].transposed : targets_[t].direct);
      if (!rank.empty()) first[t] = std::min(first[t], rank[l]);
    });
  });
  if (!rank.empty()) order_targets(first, targets_, target_of);
  std::vector<std::int64_t> position;
  std::int64_t sum = 0;
  for (Target& target : targets_)
    for (std::int64_t* start : {&target.direct, &target.transposed}) {
      const std::int64_t count = *start;
      *start = sum;
      position.push_back(sum);
      sum += count;
    }
  const auto bucket = [&](std::int64_t e, bool transposed) {
    return 2 * static_cast<std::size_t>(target_of[static_cast<std::size_t>(e)]) + (transposed ? 1 : 0);
  };
  terms_.resize(static_cast<std::size_t>(sum));
  for_each_upper_block(K_pattern, [&](std::int64_t b, std::size_t l, std::size_t k) {
    for_each_term(R_transposed, l, k, E_pattern, [&](std::int64_t e, bool t, double weight) {
      terms_[static_cast<std::size_t>(position[bucket(e, t)]++)] = {static_cast<std::uint32_t>(b),
                                                                    static_cast<Scalar>(weight)};
    });
  });
}

template <typename Scalar>
void GalerkinGather<Scalar>::run(const BlockMatrix<Scalar>& K, BlockMatrix<Scalar>& E, const Threads& threads) const {
  CHECK(static_cast<std::int64_t>(E.values.size()) >= 9 * E.pattern.blocks());
  const auto count = static_cast<std::int64_t>(targets_.size()) - 1;
  threads.for_chunks(count, kTargetGrain, [&](std::int64_t begin, std::int64_t end) {
    const Term* const terms = terms_.data();
    for (std::int64_t t = begin; t < end; ++t) {
      const Target& target = targets_[static_cast<std::size_t>(t)];
      const std::int64_t next = targets_[static_cast<std::size_t>(t) + 1].direct;
      BlockSum<Scalar> direct, transposed;
      for (std::int64_t s = target.direct; s < target.transposed; ++s)
        direct.add(K.block(terms[s].source), terms[s].weight);
      for (std::int64_t s = target.transposed; s < next; ++s) transposed.add(K.block(terms[s].source), terms[s].weight);
      if (target.block == target.mirror) transposed = direct;
      Scalar d[9], m[9];
      direct.store(d);
      transposed.store(m);
      Scalar* const block = E.block(target.block);
      Scalar* const mirror = E.block(target.mirror);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) mirror[3 * c + r] = block[3 * r + c] = d[3 * r + c] + m[3 * c + r];
    }
  });
}

template <typename Scalar>
std::int64_t GalerkinGather<Scalar>::bytes() const {
  return static_cast<std::int64_t>(targets_.size() * sizeof(Target) + terms_.size() * sizeof(Term));
}

template class GalerkinGather<float>;
template class GalerkinGather<double>;

}  // namespace softreel
