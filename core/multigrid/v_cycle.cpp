#include "core/multigrid/v_cycle.h"

#include <limits>
#include <type_traits>

#include "core/base/check.h"
#include "core/sparse/galerkin_product.h"

namespace softreel {
namespace {

/// Relative size of a pivot of the bottom that is nothing but rounding. In double it is far above that of one pivot:
/// copies of coarse nodes at scattered contrasts depend on each other, and a pivot that is noise, but taken for true,
/// makes greater noise of all that follow. A true pivot so small belongs to a body that double cannot solve anyway.
template <typename Scalar>
constexpr double kPivotNoise = std::is_same_v<Scalar, float> ? 8.0 * std::numeric_limits<float>::epsilon() : 1e-11;

/// Two cycles that take one after the other what the coarse lattice takes badly and what it takes well: the inverse
/// roots of the Chebyshev polynomial of degree two on [0.3, 1.01] of the spectrum of cycle times A. The result's
/// spectrum stays in (0, 1.2] whatever the depth. The long step comes first, so that the other damps its rounding,
/// which a contrast of 1e6 makes felt in float.
constexpr CycleWeights kFullWWeights{2.5, 1.1};
constexpr CycleWeights kPlainWeights{1.0, 1.0};

}  // namespace

template <typename Scalar>
Cycle<Scalar>::Level::Level(const LatticeLevel& level_structure, const MultigridParams& params, bool last)
    : structure(level_structure) {
  matrix.pattern = structure.pattern;
  reserve_values(matrix);
  const std::size_t lanes_total = 4 * static_cast<std::size_t>(structure.pattern.rows());
  for (NodeVector<Scalar>* vector : {&b, &x, &r, &correction}) vector->assign(lanes_total, Scalar{0});
  if (!last) smoother = make_smoother<Scalar>(params, structure, matrix);
}

template <typename Scalar>
Cycle<Scalar>::Cycle(const LatticeHierarchy& hierarchy, const MultigridParams& params, const Threads& threads)
    : hierarchy_(hierarchy),
      params_(choose_for_body(params, {})),
      threads_(threads),
      bottom_(hierarchy.levels.back().pattern) {
  const std::size_t count = hierarchy.levels.size();
  for (std::size_t h = 0; h < count; ++h) {
    levels_.push_back(std::make_unique<Level>(hierarchy.levels[h], params, h + 1 == count));
    if (h + 1 == count) break;
    const LatticeLevel& fine = hierarchy.levels[h];
    const BlockPattern& coarse = hierarchy.levels[h + 1].pattern;
    if (params.galerkin == GalerkinMethod::Gather)
      levels_[h]->gather = std::make_unique<GalerkinGather<Scalar>>(fine.pattern, fine.prolongation, coarse, fine.rank);
    if (params.galerkin == GalerkinMethod::Stream)
      levels_[h]->stream = std::make_unique<GalerkinStream<Scalar>>(fine.pattern, fine.prolongation, coarse);
  }
}

template <typename Scalar>
bool Cycle<Scalar>::update(const BlockMatrixd& matrix, std::span<const std::uint8_t> pinned) {
  copy_values(matrix);
  return update_in_place(pinned);
}

template <typename Scalar>
bool Cycle<Scalar>::update_in_place(std::span<const std::uint8_t> pinned) {
  pinned_.clear();
  if (!pinned.empty()) {
    CHECK(pinned.size() == hierarchy_.mesh_nodes.size());
    for (const Index node : hierarchy_.mesh_nodes) pinned_.push_back(pinned[static_cast<std::size_t>(node)]);
  }
  bool sound = true;
  for (std::size_t h = 0; h + 1 < levels_.size(); ++h) {
    sound = levels_[h]->smoother->update(threads_) && sound;
    form_next(h);
  }
  return bottom_.factor(levels_.back()->matrix, kPivotNoise<Scalar>) && sound;
}

template <typename Scalar>
void Cycle<Scalar>::copy_values(const BlockMatrixd& matrix) {
  CHECK(matrix.pattern.blocks() == static_cast<std::int64_t>(hierarchy_.source_blocks.size()));
  BlockMatrix<Scalar>& finest = levels_.front()->matrix;
  constexpr std::int64_t kBlockGrain = 8192;
  threads_.for_chunks(finest.pattern.blocks(), kBlockGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t b = begin; b < end; ++b) {
      const double* const from = matrix.block(hierarchy_.source_blocks[static_cast<std::size_t>(b)]);
      Scalar* const to = finest.block(b);
      for (int k = 0; k < 9; ++k) to[k] = static_cast<Scalar>(from[k]);
    }
  });
}

template <typename Scalar>
void Cycle<Scalar>::form_next(std::size_t h) {
  Level& fine = *levels_[h];
  Level& coarse = *levels_[h + 1];
  switch (params_.galerkin) {
    case GalerkinMethod::Naive:
      return galerkin_product(fine.matrix, fine.structure.restriction, coarse.matrix);
    case GalerkinMethod::Stream:
      return fine.stream->run(fine.matrix, coarse.matrix);
    case GalerkinMethod::Gather:
      return fine.gather->run(fine.matrix, coarse.matrix, threads_);
  }
}

template <typename Scalar>
void Cycle<Scalar>::apply(const NodeVector<double>& r, double r_norm, NodeVector<double>& z) {
  Level& finest = *levels_.front();
  const auto nodes = static_cast<std::int64_t>(hierarchy_.mesh_nodes.size());
  const Index* const mesh_nodes = hierarchy_.mesh_nodes.data();
  threads_.for_chunks(nodes, kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      lanes(finest.b, i) = (lanes(r, mesh_nodes[i]) * (1 / r_norm)).template cast<Scalar>();
  });
  cycle(0);
  threads_.for_chunks(nodes, kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      lanes(z, mesh_nodes[i]) = lanes(finest.x, i).template cast<double>() * r_norm;
  });
}

template <typename Scalar>
const NodeVector<Scalar>& Cycle<Scalar>::find_residual_of_result() {
  Level& finest = *levels_.front();
  finest.smoother->find_smoothed_residual(finest.b, finest.x, finest.r, threads_);
  return finest.r;
}

template <typename Scalar>
const NodeVector<Scalar>& Cycle<Scalar>::find_residual_of(const NodeVector<Scalar>& x) {
  Level& finest = *levels_.front();
  finest.smoother->find_residual(finest.b, x, finest.r, threads_);
  return finest.r;
}

/// x = cycle applied to b on level h.
template <typename Scalar>
void Cycle<Scalar>::cycle(std::size_t h) {
  Level& level = *levels_[h];
  if (h + 1 == levels_.size()) return bottom_.solve(level.b, level.x);
  level.smoother->smooth_from_zero(params_.sweeps, level.b, level.x, level.r, threads_);
  correct_from_next(h);
  level.smoother->smooth(params_.sweeps, level.b, level.x, threads_);
}

/// x += R^T times one cycle (V) or two (W) for the restricted residual. On the last level one is exact.
template <typename Scalar>
void Cycle<Scalar>::correct_from_next(std::size_t h) {
  Level& fine = *levels_[h];
  Level& coarse = *levels_[h + 1];
  restrict_to(fine.structure.restriction, fine.r, coarse.b, threads_);
  cycle(h + 1);
  const bool full = params_.coarse_cycle == CycleKind::FullW;
  if ((full || (params_.coarse_cycle == CycleKind::W && h > 0)) && h + 2 < levels_.size())
    cycle_again(h + 1, full ? kFullWWeights : kPlainWeights);
  const bool finest = h == 0;
  prolong_add(fine.structure.prolongation,
              finest ? std::span<const std::uint8_t>(pinned_) : std::span<const std::uint8_t>(), coarse.x, fine.x,
              threads_);
}

/// x = first * x + second * (cycle applied to what that leaves of b). It starts from zero: its sweeps are the cheap
/// ones.
template <typename Scalar>
void Cycle<Scalar>::cycle_again(std::size_t h, const CycleWeights& weights) {
  Level& level = *levels_[h];
  const std::int64_t rows = level.structure.pattern.rows();
  const auto first = static_cast<Scalar>(weights.first), second = static_cast<Scalar>(weights.second);
  threads_.for_chunks(rows, kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) lanes(level.correction, i) = first * lanes(level.x, i);
  });
  level.smoother->find_residual(level.b, level.correction, level.r, threads_);
  std::swap(level.b, level.r);
  cycle(h);
  threads_.for_chunks(rows, kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      lanes(level.x, i) = second * lanes(level.x, i) + lanes(level.correction, i);
  });
}

template <typename Scalar>
std::int64_t Cycle<Scalar>::bytes(std::size_t level) const {
  const Level& l = *levels_[level];
  std::int64_t bytes = static_cast<std::int64_t>((l.matrix.values.size() + 4 * l.x.size()) * sizeof(Scalar)) +
                       l.matrix.pattern.blocks() * static_cast<std::int64_t>(sizeof(Index));
  if (l.smoother) bytes += l.smoother->bytes();
  if (l.gather) bytes += l.gather->bytes();
  if (l.stream) bytes += l.stream->bytes();
  return level + 1 == levels_.size() ? bytes + bottom_.bytes() : bytes;
}

template class Cycle<float>;
template class Cycle<double>;

}  // namespace softreel
