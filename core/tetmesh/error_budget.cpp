#include "core/tetmesh/error_budget.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/tetmesh/boundary_fit.h"
#include "core/tetmesh/boundary_mending.h"
#include "core/tetmesh/farthest_point.h"
#include "core/tetmesh/graded_octree.h"
#include "core/tetmesh/graded_stuffing.h"
#include "core/tetmesh/hidden_surface.h"
#include "core/tetmesh/hole_caps.h"
#include "core/tetmesh/surface_samples.h"

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

/// So many fillings an error may take. The last ones go after single places: what a refinement mends may spoil what is
/// beside it.
constexpr int kErrorRounds = 40, kSingleRounds = 8;

/// The widest gap is narrower than before if it is less than this share of it; after so many rounds without that there
/// is an end.
constexpr double kNarrower = 0.97;
constexpr int kPatience = 12;

/// Pieces of at most this share of the elements are loose.
constexpr double kLooseShare = 0.02;

/// The error falls with the number of tetrahedra to about this power; met on smooth and sharp bodies alike.
constexpr double kErrorOverCount = 0.75;

/// So many errors are tried for a count. A filling that has it ends where no gap is wider than so many errors: what
/// comes after mends single places, and may add and spoil others.
constexpr int kCountSteps = 14;
constexpr double kNearlyKept = 1.3;

/// How near to the wanted number is near enough.
constexpr double kCountTolerance = 0.05;

/// Samples are this many budgets apart.
constexpr double kSampleStep = 2.0;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

double area_of(const SurfaceMesh& surface) {
  double area = 0;
  for (const auto& [a, b, c] : surface.triangles)
    area += 0.5 * (surface.positions[at(b)] - surface.positions[at(a)])
                      .cross(surface.positions[at(c)] - surface.positions[at(a)])
                      .norm();
  return area;
}

/// The error at which a smooth surface takes about so many tetrahedra.
double guess_error(const SurfaceMesh& surface, double tets) {
  return std::sqrt(kTetsPerSquare * area_of(surface) / (kBaseShare * tets)) / kBaseEdge;
}

/// The surface as all fillings of a search see it.
struct FilledSurface {
  explicit FilledSurface(const SurfaceMesh& mesh)
      : surface(mesh),
        sampler(mesh.positions, mesh.triangles),
        caps(mesh.positions, mesh.triangles, sampler.tree()),
        box(used_bounds(mesh)) {}

  const SurfaceMesh& surface;
  DistanceSampler sampler;
  HoleCaps caps;
  Bounds box;
};

class Filling {
 public:
  Filling(const FilledSurface& filled, const ErrorBudgetParams& params, const Threads& threads)
      : params_(params),
        threads_(threads),
        base_edge_(params.base_edge > 0 ? params.base_edge : kBaseEdge * params.error),
        error_(params.error > 0 ? params.error : base_edge_ / kBaseEdge),
        frame_{filled.box.center(), std::ldexp(base_edge_, -params.finer)},
        octree_(frame_, filled.box, params.finer + params.coarser),
        sampler_(filled.sampler),
        caps_(filled.caps),
        visible_(find_visible(filled.surface, sampler_, error_, threads)),
        samples_(visible_, order_of(visible_, sampler_.tree()), kSampleStep * error_) {
    for (const Triangle& triangle : filled.surface.triangles)
      octree_.refine(corners(filled.surface.positions, triangle), params.finer);
  }

  GradedFilling run() {
    GradedFilling filling;
    const int rounds = params_.error > 0 ? kErrorRounds : 1;
    for (int round = 0; round < rounds; ++round) {
      filling = {};  // before there is the next
      filling = fill();
      std::vector<BoundaryGap> gaps = fit(filling.stuffed, round);
      add_loose_pieces(filling.stuffed, gaps);
      const bool is_certain = gaps.empty();
      if (is_certain) gaps = find_gaps(filling.stuffed);
      filling.is_kept = gaps.empty();
      const double margin = round < kSingleRounds ? 0.0 : 0.5;
      if (has_count(filling) && widest(gaps) < kNearlyKept * error_) break;
      if (!gaps.empty() && is_stuck(gaps, round)) break;
      if (round + 1 == rounds || refine(filling.stuffed, gaps, margin)) continue;
      // Samples that no size reaches hide what lies between others.
      if (!is_certain) gaps = find_gaps(filling.stuffed);
      if (is_certain || !refine(filling.stuffed, gaps, 0.0)) break;
    }
    return filling;
  }

 private:
  static std::array<Vec3, 3> corners(const std::vector<Vec3>& points, const Triangle& triangle) {
    return {points[at(triangle[0])], points[at(triangle[1])], points[at(triangle[2])]};
  }

  /// The triangles in the order of the tree; those that are not in it as they come.
  static std::vector<Index> order_of(const SurfaceMesh& visible, const TriangleTree& tree) {
    if (visible.triangles.size() == tree.order().size()) return tree.order();
    std::vector<Index> order(visible.triangles.size());
    std::iota(order.begin(), order.end(), 0);
    return order;
  }

  /// What the boundary has to follow; the surface as it is, unless it overlaps itself.
  static SurfaceMesh find_visible(const SurfaceMesh& surface, const DistanceSampler& sampler, double error,
                                  const Threads& threads) {
    if (!sampler.near_overlaps().empty()) return without_hidden(surface, sampler.near_overlaps(), error, threads);
    SurfaceMesh visible;
    visible.positions = surface.positions;
    visible.triangles = surface.triangles;
    return visible;
  }

  bool has_count(const GradedFilling& filling) const {
    const auto count = static_cast<double>(filling.stuffed.mesh.tets.size());
    return params_.tets > 0 && std::abs(count / params_.tets - 1) <= kCountTolerance;
  }

  /// Whether the widest gap has long been no narrower than before: no size mends it. The rim of a hole can be such a
  /// gap.
  bool is_stuck(const std::vector<BoundaryGap>& gaps, int round) {
    const double width = widest(gaps);
    if (width < kNarrower * narrowest_) {
      narrowest_ = width;
      narrowest_round_ = round;
    }
    return round - narrowest_round_ > kPatience;
  }

  /// Small pieces beside the main ones hang by necks that are thinner than the tetrahedra: gaps as wide as they are.
  void add_loose_pieces(const StuffedMesh& stuffed, std::vector<BoundaryGap>& gaps) const {
    const TetMesh& mesh = stuffed.mesh;
    const std::vector<Index> pieces = face_connected_pieces(mesh);
    if (pieces.empty()) return;
    std::vector<Index> counts(at(*std::max_element(pieces.begin(), pieces.end()) + 1), 0);
    for (const Index piece : pieces) ++counts[at(piece)];
    if (counts.size() == 1) return;
    for (const BoundaryFace& face : find_surface_faces(stuffed)) {
      if (counts[at(pieces[at(face.element)])] > kLooseShare * static_cast<double>(pieces.size())) continue;
      const Vec3& p = mesh.nodes[at(face.nodes[0])];
      gaps.push_back({sampler_.tree().nearest(p).point, p, face.nodes});
    }
  }

  static double widest(const std::vector<BoundaryGap>& gaps) {
    double width = 0;
    for (const BoundaryGap& gap : gaps) width = std::max(width, (gap.on_surface - gap.on_boundary).norm());
    return width;
  }

  SurfaceDistance sample_nodes() const {
    LatticeNodeSet nodes = octree_.nodes();
    const std::vector<double> widths = octree_.widths(nodes);
    return sampler_.sample(frame_, std::move(nodes), widths, known_, threads_);
  }

  GradedFilling fill() {
    GradedFilling filling;
    known_ = sample_nodes();
    filling.nearest_triangles = known_.nearest_triangles;
    filling.stuffed = stuff_octree(octree_, known_.lattice.nodes, known_.lattice.values);
    mend_boundary(filling.stuffed);
    filling.stuffed.mesh.lattice = {frame_.origin, base_edge_};
    filling.finest_edge = frame_.spacing;
    return filling;
  }

  /// Fits, and returns what is still too far apart.
  std::vector<BoundaryGap> fit(StuffedMesh& stuffed, int round) {
    BoundaryFitParams fit_params;
    fit_params.tolerance = params_.fit_tolerance * error_ / base_edge_;
    fit_params.sweeps = round < kFirstRounds ? kFirstSweeps : kSweeps;
    if (stuffed.mesh.tets.empty()) return everywhere();
    const BoundaryFit fitted(stuffed, sampler_.tree(), samples_, fit_params, threads_, &memory_);
    std::vector<BoundaryGap> gaps = fitted.gaps((round < kFirstRounds ? kFirstLimit : kEnough) * error_);
    leave_out_holes(gaps);
    return gaps;
  }

  /// The whole surface, for a lattice that has no node inside.
  std::vector<BoundaryGap> everywhere() const {
    std::vector<BoundaryGap> gaps;
    for (std::size_t s = 0; s < samples_.size(); ++s) gaps.push_back({samples_[s], samples_[s], {-1, -1, -1}});
    return gaps;
  }

  /// No size brings the cap of a hole nearer to the surface.
  void leave_out_holes(std::vector<BoundaryGap>& gaps) const {
    if (!caps_.any()) return;
    std::erase_if(gaps, [&](const BoundaryGap& gap) { return gap.from_boundary && caps_.contain(gap.on_boundary); });
  }

  /// The faces of the boundary that have a surface to follow.
  SurfaceMesh without_caps(const std::vector<Vec3>& nodes, const std::vector<Triangle>& faces) const {
    if (caps_.any()) return caps_.without_caps(nodes, faces, kCertain * error_, threads_);
    SurfaceMesh all;
    all.positions = nodes;
    all.triangles = faces;
    return all;
  }

  /// All gaps, also between samples and inside faces.
  std::vector<BoundaryGap> find_gaps(const StuffedMesh& stuffed) const {
    const double limit = kCertain * error_;
    std::vector<Triangle> faces;
    for (const BoundaryFace& face : find_surface_faces(stuffed)) faces.push_back(face.nodes);
    const TriangleTree boundary(stuffed.mesh.nodes, faces);
    std::vector<BoundaryGap> gaps;
    for (const Vec3& p : find_far_points(visible_.positions, visible_.triangles, boundary, limit, threads_)) {
      const TriangleTree::Nearest found = boundary.nearest(p);
      gaps.push_back({p, found.point, faces[at(found.triangle)]});
    }
    const SurfaceMesh followed = without_caps(stuffed.mesh.nodes, faces);
    for (const Vec3& p : find_far_points(followed.positions, followed.triangles, sampler_.tree(), limit, threads_))
      gaps.push_back({sampler_.tree().nearest(p).point, p, faces[at(boundary.nearest(p).triangle)], true});
    return gaps;
  }

  /// Halves the largest leaves at each gap, and those within `margin` of their width. False if there is none that may
  /// be halved.
  bool refine(const StuffedMesh& stuffed, const std::vector<BoundaryGap>& gaps, double margin) {
    struct Wish {
      Vec3 point;
      std::int32_t level;
    };
    std::vector<Wish> wishes;
    for (const BoundaryGap& gap : gaps) {
      std::vector<Vec3> points{gap.on_surface, gap.on_boundary};
      if (gap.face[0] >= 0) {
        const std::array<Vec3, 3> face = corners(stuffed.mesh.nodes, gap.face);
        for (std::size_t k = 0; k < 3; ++k)
          points.emplace_back(0.8 * face[k] + 0.1 * (face[(k + 1) % 3] + face[(k + 2) % 3]));
      }
      std::int32_t most = 0;
      for (const Vec3& p : points) most = std::max(most, octree_.level_at(p));
      for (const Vec3& p : points)
        if (most > 0 && octree_.level_at(p) == most) wishes.push_back({p, most - 1});
    }
    const std::size_t before = octree_.cells().size();
    for (const Wish& wish : wishes) octree_.refine(wish.point, wish.level, margin);
    return octree_.cells().size() > before;
  }

  const ErrorBudgetParams& params_;
  const Threads& threads_;
  double base_edge_, error_;
  double narrowest_ = 1e300;  ///< the least of the widest gaps, and the round it was met in
  int narrowest_round_ = 0;
  LatticeFrame frame_;
  GradedOctree octree_;
  const DistanceSampler& sampler_;
  const HoleCaps& caps_;
  SurfaceMesh visible_;  ///< positions and triangles; without what lies inside where pieces overlap
  SurfaceSamples samples_;
  FitMemory memory_;
  SurfaceDistance known_;  ///< of the filling before
};

}  // namespace

namespace {

/// An error with the number of tetrahedra that it takes, as logarithms.
struct Tried {
  double error, count;
};

/// The next error to try for a count: between the nearest ones that gave too many and too few, or from one of them by
/// the usual slope.
double next_error(const std::optional<Tried>& few, const std::optional<Tried>& many, double wanted) {
  if (!few || !many) {
    const Tried& known = few ? *few : *many;
    return known.error + kErrorOverCount * (known.count - wanted);
  }
  // Not too near to either, lest counts that jump stop the search.
  const double share = std::clamp((wanted - few->count) / (many->count - few->count), 0.15, 0.85);
  return few->error + share * (many->error - few->error);
}

GradedFilling fill_to_count(const SurfaceMesh& surface, const ErrorBudgetParams& params, const Threads& threads) {
  const FilledSurface filled(surface);
  GradedFilling best;
  double best_miss = 1e300, error = std::log(guess_error(surface, params.tets));
  std::optional<Tried> few, many;
  for (int step = 0; step < kCountSteps && best_miss > kCountTolerance; ++step) {
    ErrorBudgetParams to_error = params;
    to_error.error = std::exp(error);
    GradedFilling filling = Filling(filled, to_error, threads).run();
    const double count = std::max(1.0, static_cast<double>(filling.stuffed.mesh.tets.size()));
    (count < params.tets ? few : many) = Tried{error, std::log(count)};
    const double miss = std::abs(count / params.tets - 1);
    if (miss < best_miss) {
      best_miss = miss;
      best = std::move(filling);
    }
    error = next_error(few, many, std::log(params.tets));
  }
  return best;
}

}  // namespace

GradedFilling fill_graded(const SurfaceMesh& surface, const ErrorBudgetParams& params, const Threads& threads) {
  if (params.tets > 0) return fill_to_count(surface, params, threads);
  const FilledSurface filled(surface);
  return Filling(filled, params, threads).run();
}

}  // namespace softreel
