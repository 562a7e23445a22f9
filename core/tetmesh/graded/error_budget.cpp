#include "core/tetmesh/graded/error_budget.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/tetmesh/boundary/boundary_fit.h"
#include "core/tetmesh/graded/filled_surface.h"
#include "core/tetmesh/graded/gap_refinement.h"
#include "core/tetmesh/graded/graded_octree.h"
#include "core/tetmesh/graded/graded_stuffing.h"
#include "core/tetmesh/lattice/lattice_nodes.h"
#include "core/tetmesh/stuffing/boundary_mending.h"

namespace softreel {
namespace {

/// Base edge in units of the error: few places of most surfaces are so flat that longer ones would do.
constexpr double kBaseEdge = 12.0;

/// A mesh of base edges alone has so many tetrahedra per square of them, and takes this share of the wanted number.
constexpr double kTetsPerSquare = 12.0, kBaseShare = 0.11;

/// Samples nearer than this share of the budget are let be; what lies between them may be further away.
constexpr double kEnough = 0.85;

/// No point may be further away than this share of the budget: what measures it is so much too small at most.
constexpr double kCertain = 0.98;

/// In the first rounds, which are far from the goal, what a longer fit would mend is let be: fewer sweeps, and gaps of
/// more than so many budgets.
constexpr int kFirstRounds = 2, kFirstSweeps = 2, kSweeps = 4;
constexpr double kFirstLimit = 1.5;

/// Sweeps of each fit on the way to a count.
constexpr int kCountSweeps = 3;

/// So many fillings an error may take. The last ones go after single places: what a refinement mends may spoil what is
/// beside it.
constexpr int kErrorRounds = 40, kSingleRounds = 8;

/// The widest gap is narrower than before if it is less than this share of it; after so many rounds without that there
/// is an end.
constexpr double kNarrower = 0.97;
constexpr int kPatience = 12;

/// Where the finest leaves are at the widest gap already, there is little to hope for: three rounds that narrow neither
/// it nor the widest one with larger leaves by a tenth are the last.
constexpr double kMuchNarrower = 0.9;
constexpr int kFinestPatience = 3;

/// So many base edges are tried for a count, and so many fillings on each. A filling is not to grow by more than this
/// factor at once, nor by more than this share of what is missing: what a coarse one asks for is uncertain, and places
/// that want several halvings come up again.
constexpr int kBaseTries = 8, kCountRounds = 24;
constexpr double kGrowth = 2.5, kNearer = 0.7;

/// Once the count is met, single places are mended this often, where gaps are so much wider than those that were
/// refined, up to this share of the count.
constexpr int kMendings = 1;
constexpr double kMuchWider = 1.15, kMendingShare = 1.035;

/// Gaps that are still so much wider than those that were refined want more than one halving.
constexpr double kStubborn = 3.0;

/// Far from the count so many samples per tetrahedron will do.
constexpr double kSamplesPerTet = 3.0;

/// What takes too many is done over with less so many times.
constexpr int kRetries = 3;

/// The next round's gaps will be about this share of those that were refined: what is nearer need not be fitted.
constexpr double kAhead = 0.5;

/// From this share of the count on more than the error asks for is refined where nothing else is left; below it, the
/// base edge is too long. The count goes about with this power of it.
constexpr double kNearShare = 0.5, kCountOverBase = 2.0;

/// A base edge that takes too few is shortened by no more than this at once.
constexpr double kMostShorter = 4.0;

/// A surface that so many leaves per wanted tetrahedron find no inside of has none for that count.
constexpr double kLeavesPerTet = 4.0, kFewLeaves = 10000.0;

/// How near to the wanted number is near enough.
constexpr double kCountTolerance = 0.05;

/// Samples are this many budgets apart.
constexpr double kSampleStep = 2.0;

/// The error at which a smooth surface takes about so many tetrahedra.
double guess_error(double area, double tets) {
  return std::sqrt(kTetsPerSquare * area / (kBaseShare * tets)) / kBaseEdge;
}

const BoundaryGap& widest_of(const std::vector<BoundaryGap>& gaps) {
  return *std::max_element(gaps.begin(), gaps.end(),
                           [](const BoundaryGap& a, const BoundaryGap& b) { return width_of(a) < width_of(b); });
}

/// What filling up to a count came to on one base edge.
struct CountedFilling {
  GradedFilling filling;
  double count = 0;        ///< of tetrahedra
  double widest = 0;       ///< gap above the limit that was asked, m; 0: there is none
  std::size_t loose = 0;   ///< places of loose pieces
  bool is_fitted = false;  ///< not where base edges alone took too many
};

/// Halvings of the base edge that are wanted and that the lattice's coordinates have room for.
int halvings(const ErrorBudgetParams& params, const Bounds& box, double base_edge) {
  if (params.error == 0 && params.tets == 0) return 0;                              // nothing is refined
  const double edges = box.size().maxCoeff() / base_edge + (16 << params.coarser);  // and a layer of cells round it
  int finer = params.finer;
  while (finer > 0 && std::ldexp(edges, finer) > 0.5 * kMaxLatticeCoordinate) --finer;  // top_level needs room too
  return finer;
}

/// Level of the cells that cover the box: higher than asked where a thin body stands askew in a box of so many that
/// they, not the body, would take the memory. Only far inside of a body could cells be that large.
int top_level(const Bounds& box, const LatticeFrame& frame, int wanted) {
  constexpr double kMostCells = 1 << 20;
  constexpr int kHighest = 15;  // four such cells are a quarter of the coordinates to one side
  int top = wanted;
  const auto cells = [&]() -> Vec3 { return (box.size() / std::ldexp(frame.spacing, top)).cwiseMax(0); };
  while (top < kHighest && (cells() + Vec3::Constant(3)).prod() > kMostCells) ++top;
  return top;
}

class Filling {
 public:
  Filling(const FilledSurface& filled, const ErrorBudgetParams& params, const Threads& threads)
      : params_(params),
        threads_(threads),
        filled_(filled),
        base_edge_(params.base_edge > 0 ? params.base_edge : kBaseEdge * params.error),
        error_(params.error > 0 ? params.error : base_edge_ / kBaseEdge),
        finer_(halvings(params, filled.box(), base_edge_)),
        frame_{filled.box().center(), std::ldexp(base_edge_, -finer_)},
        octree_(frame_, filled.box(), top_level(filled.box(), frame_, finer_ + params.coarser)),
        visible_(filled.visible(error_, threads)),
        samples_(filled.sample(visible_, kSampleStep * error_)) {
    const std::vector<Vec3>& x = filled.surface().positions;
    for (const auto& [a, b, c] : filled.surface().triangles) octree_.refine({x[at(a)], x[at(b)], x[at(c)]}, finer_);
  }

  GradedFilling run() {
    GradedFilling filling;
    const int rounds = params_.error > 0 ? kErrorRounds : 1;
    for (int round = 0; round < rounds; ++round) {
      filling = {};  // before there is the next
      filling = fill();
      const bool is_first = round < kFirstRounds;
      std::vector<BoundaryGap> gaps = fit(filling.stuffed, is_first ? kFirstSweeps : kSweeps,
                                          (is_first ? kFirstLimit : kEnough) * error_, samples_);
      const std::vector<BoundaryGap> loose = find_loose_pieces(filling);
      gaps.insert(gaps.end(), loose.begin(), loose.end());
      const bool is_certain = gaps.empty();
      if (is_certain) gaps = filled_.find_gaps(filling.stuffed, visible_, kCertain * error_, threads_);
      filling.is_kept = gaps.empty();
      if (!gaps.empty()) filling.widest_gap = widest_of(gaps);
      const double margin = round < kSingleRounds ? 0.0 : 0.5;
      const bool is_measured = !gaps.empty() && !filling.stuffed.mesh.tets.empty();  // else gaps have no width
      if (is_measured && is_stuck(gaps, filling.stuffed.mesh.nodes, round)) break;
      if (round + 1 == rounds || refine(filling.stuffed, gaps, margin)) continue;
      // Samples that no size reaches hide what lies between others.
      if (!is_certain) gaps = filled_.find_gaps(filling.stuffed, visible_, kCertain * error_, threads_);
      if (is_certain || !refine(filling.stuffed, gaps, 0.0)) break;
    }
    return filling;
  }

  /// Refines the widest gaps first, until there are as many tetrahedra as wanted, or more with base edges alone, or too
  /// few and nothing left to refine.
  CountedFilling run_to_count() {
    CountedFilling best;
    std::optional<Refinement> last;
    int mendings = 0, retries = 0;
    for (int round = 0; round < kCountRounds; ++round) {
      GradedFilling filling = fill();
      const auto count = static_cast<double>(filling.stuffed.mesh.tets.size());
      const bool is_too_many = count > (1 + kCountTolerance) * params_.tets;
      if (is_too_many && !last) return {std::move(filling), count, 0, 0, false};
      if (is_too_many && mendings > 0) break;
      if (is_too_many && last->count > 0 && retries++ < kRetries) {
        last->added *= (params_.tets - last->count) / (count - last->count);
        if (!refine(*last, best.filling.stuffed.mesh.nodes)) break;
        continue;
      }
      if (last) learn_yield(*last, count);
      last.reset();                  // before there are the next
      if (mendings == 0) best = {};  // what met the count is kept until something better has
      last = find_refinement(filling, count);
      const double width = widest(last->gaps);
      if (mendings > 0 && width > best.widest && last->loose.size() >= best.loose) break;  // it spoilt something else
      best = {std::move(filling), count, width, last->loose.size(), true};
      if (is_too_many || is_hopeless(count)) break;
      if (count >= (1 - kCountTolerance) * params_.tets && mendings++ == kMendings) break;
      if (!refine(*last, best.filling.stuffed.mesh.nodes)) break;
    }
    return best;
  }

 private:
  std::vector<BoundaryGap> find_loose_pieces(const GradedFilling& filling) const {
    return filled_.find_loose_pieces(filling.stuffed, filling.nearest_triangles,
                                     {params_.loose_share, params_.triangle_solids});
  }

  /// Whether the widest gap has long been no narrower than before: no size mends it. The rim of a hole can be such a
  /// gap; others, where leaves can still be halved, may go on getting narrower beside it.
  bool is_stuck(const std::vector<BoundaryGap>& gaps, const std::vector<Vec3>& nodes, int round) {
    const double width = widest(gaps), reachable = widest_reachable(octree_, gaps, nodes);
    const bool is_narrower = width < kMuchNarrower * before_ || reachable < kMuchNarrower * reachable_before_;
    vain_rounds_ = width > reachable && !is_narrower ? vain_rounds_ + 1 : 0;
    before_ = width;
    reachable_before_ = reachable;
    if (width < kNarrower * narrowest_) {
      narrowest_ = width;
      narrowest_round_ = round;
    }
    return round - narrowest_round_ > kPatience || vain_rounds_ >= kFinestPatience;
  }

  /// What is to be refined of a filling on the way to a count; kept to do it over where it takes too many tetrahedra.
  struct Refinement {
    GradedOctree octree;             ///< before
    std::vector<BoundaryGap> gaps;   ///< the widest first
    std::vector<BoundaryGap> loose;  ///< of loose pieces: refined whatever it takes
    double count = 0;                ///< of the filling
    double added = 0, expected = 0;  ///< tetrahedra: wanted, and expected of what was refined
  };

  /// Fits, and lists the gaps. Far from the count a short fit to some of the samples will do, and gaps below the error
  /// are let be: they want another base edge. Where the count is met, what is much wider than the others is left to
  /// mend.
  Refinement find_refinement(GradedFilling& filling, double count) {
    const double share = count / params_.tets, error = base_edge_ / kBaseEdge;
    const bool is_near = share >= kNearShare, is_met = share >= 1 - kCountTolerance;
    const double wide = narrowest_ < 1e300 ? narrowest_ : error;
    const double limit = is_met               ? kMuchWider * wide
                         : !is_near           ? kEnough * error
                         : narrowest_ < 1e300 ? kAhead * wide
                                              : 0;
    Refinement found{octree_, {}, {}, count};
    found.gaps = fit(filling.stuffed, kCountSweeps, limit, thin_samples(count));
    std::stable_sort(found.gaps.begin(), found.gaps.end(),
                     [](const BoundaryGap& a, const BoundaryGap& b) { return width_of(a) > width_of(b); });
    if (is_near) found.loose = find_loose_pieces(filling);
    const double next = std::min(kGrowth * share, share + kNearer * (1 - share));
    found.added = (is_met ? kMendingShare : next) * params_.tets - count;
    found.added = count > 0 ? found.added / yield_ : 1e300;
    return found;
  }

  /// Some samples per tetrahedron; else all.
  SurfaceSamples thin_samples(double count) const {
    const auto step = static_cast<std::size_t>(static_cast<double>(samples_.size()) / (kSamplesPerTet * count + 1000));
    return step > 1 ? samples_.thinned(step) : samples_;
  }

  /// False if nothing is left that may be refined.
  bool refine(Refinement& asked, const std::vector<Vec3>& nodes) {
    octree_ = asked.octree;
    const bool any = refine_gaps(octree_, asked.loose, nodes, 0.0);
    const WidestRefined done = refine_widest(octree_, asked.gaps, nodes, known_,
                                             {asked.added, narrowest_ < 1e300 ? kStubborn * narrowest_ : 1e300});
    asked.expected = done.added_tets;
    if (done.halved == 0) return any;
    if (done.narrowest > 0) narrowest_ = std::min(narrowest_, done.narrowest);
    // Loose pieces may have been all there was to halve: then no gap says how near this comes.
    if (narrowest_ < 1e300) error_ = std::max(base_edge_ / kBaseEdge, kAhead * narrowest_);
    return true;
  }

  /// Whether what has no inside at such leaves has none.
  bool is_hopeless(double count) const {
    return count == 0 && static_cast<double>(octree_.cells().size()) > kLeavesPerTet * params_.tets + kFewLeaves;
  }

  /// How many tetrahedra came of one that was expected.
  void learn_yield(const Refinement& done, double count) {
    if (done.expected > 0 && done.count > 0) yield_ = std::clamp((count - done.count) / done.expected, 0.5, 2.0);
  }

  SurfaceDistance sample_nodes() const {
    LatticeNodeSet nodes = octree_.nodes();
    const std::vector<double> widths = octree_.widths(nodes);
    return filled_.sampler().sample(frame_, std::move(nodes), widths, known_, threads_);
  }

  GradedFilling fill() {
    GradedFilling filling;
    known_ = sample_nodes();
    filling.nearest_triangles = known_.nearest_triangles;
    filling.stuffed = stuff_octree(octree_, known_.lattice.nodes, known_.lattice.values);
    mend_boundary(filling.stuffed);
    filling.stuffed.mesh.lattice = {frame_.origin, base_edge_};
    filling.finest_edge = octree_.finest_edge();
    return filling;
  }

  /// Fits, and returns what is still further apart than `limit`, m.
  std::vector<BoundaryGap> fit(StuffedMesh& stuffed, int sweeps, double limit, const SurfaceSamples& samples) {
    BoundaryFitParams fit_params;
    fit_params.tolerance = params_.fit_tolerance * error_ / base_edge_;
    fit_params.sweeps = sweeps;
    fit_params.quick = true;
    if (stuffed.mesh.tets.empty()) return everywhere();
    const BoundaryFit fitted(stuffed, filled_.tree(), samples, fit_params, threads_, &memory_);
    std::vector<BoundaryGap> gaps = fitted.gaps(limit);
    const std::vector<BoundaryGap> between = fitted.corner_gaps(limit);
    gaps.insert(gaps.end(), between.begin(), between.end());
    filled_.leave_out_caps(gaps);
    return gaps;
  }

  /// The whole surface, for a lattice that has no node inside.
  std::vector<BoundaryGap> everywhere() const {
    std::vector<BoundaryGap> gaps;
    for (std::size_t s = 0; s < samples_.size(); ++s) gaps.push_back({samples_[s], samples_[s], {-1, -1, -1}});
    return gaps;
  }

  bool refine(const StuffedMesh& stuffed, const std::vector<BoundaryGap>& gaps, double margin) {
    return refine_gaps(octree_, gaps, stuffed.mesh.nodes, margin);
  }

  const ErrorBudgetParams& params_;
  const Threads& threads_;
  const FilledSurface& filled_;
  double base_edge_, error_;
  int finer_;                 ///< halvings of the base edge, at most
  double narrowest_ = 1e300;  ///< for an error: the least of the widest gaps, and the round it was met in; for a
                              ///< count: of those that were refined
  int narrowest_round_ = 0;
  double before_ = 1e300;            ///< the widest gap of the round before
  double reachable_before_ = 1e300;  ///< of those where leaves could be halved
  int vain_rounds_ = 0;              ///< on end, that narrowed neither though the widest gap has the finest leaves
  LatticeFrame frame_;
  GradedOctree octree_;
  SurfaceMesh visible_;  ///< positions and triangles; without what lies inside where pieces overlap
  SurfaceSamples samples_;
  double yield_ = 1;  ///< tetrahedra that came of one that was expected
  FitMemory memory_;
  SurfaceDistance known_;  ///< of the filling before
};

/// A base edge with the number of tetrahedra that it came to, as logarithms.
struct Tried {
  double edge, count;
};

/// The next base edge to try for a count: between the nearest ones that gave too many and too few, or from one of them
/// by the usual slope. Where base edges alone were too many, longer ones are to leave some for refinement.
double next_edge(const std::optional<Tried>& few, const std::optional<Tried>& many, double wanted) {
  if (!many) return few->edge + std::max((few->count - wanted) / kCountOverBase, -std::log(kMostShorter));
  if (!few) return many->edge + (many->count - wanted - std::log(kNearShare)) / kCountOverBase;
  // Not too near to either, lest counts that jump stop the search.
  const double share = std::clamp((wanted - few->count) / (many->count - few->count), 0.15, 0.85);
  return few->edge + share * (many->edge - few->edge);
}

GradedFilling fill_to_count(const SurfaceMesh& surface, const ErrorBudgetParams& params, const Threads& threads) {
  const FilledSurface filled(surface);
  CountedFilling best;
  ErrorBudgetParams on_base = params;
  double best_miss = 1e300, best_edge = 0, edge = std::log(kBaseEdge * guess_error(filled.area(), params.tets));
  std::optional<Tried> few, many;
  for (int step = 0; step < kBaseTries && best_miss > kCountTolerance; ++step) {
    on_base.base_edge = std::exp(edge);
    CountedFilling counted = Filling(filled, on_base, threads).run_to_count();
    const double count = std::max(1.0, counted.count);
    const double miss = counted.count > 0 ? std::abs(count / params.tets - 1) : 1e200;
    (count < params.tets ? few : many) = Tried{edge, std::log(count)};
    if (miss < best_miss) {
      best_miss = miss;
      best_edge = on_base.base_edge;
      best = std::move(counted);
    }
    if (counted.count == 0 && !many) break;
    edge = next_edge(few, many, std::log(params.tets));
  }
  if (best.is_fitted) return std::move(best.filling);
  return Filling(filled, {.base_edge = best_edge}, threads).run();
}

}  // namespace

GradedFilling fill_graded(const SurfaceMesh& surface, const ErrorBudgetParams& params, const Threads& threads) {
  if (params.tets > 0) return fill_to_count(surface, params, threads);
  const FilledSurface filled(surface);
  return Filling(filled, params, threads).run();
}

}  // namespace softreel
