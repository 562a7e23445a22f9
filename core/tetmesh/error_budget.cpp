#include "core/tetmesh/error_budget.h"

#include <algorithm>
#include <cmath>

#include "core/tetmesh/boundary_fit.h"
#include "core/tetmesh/boundary_mending.h"
#include "core/tetmesh/graded_octree.h"
#include "core/tetmesh/graded_stuffing.h"

namespace softreel {
namespace {

constexpr std::int64_t kGrain = 256;

/// Samples nearer than this share of the budget are let be; what lies between them may be further away.
constexpr double kEnough = 0.85;

/// Samples are this many budgets apart.
constexpr double kSampleStep = 2.0;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

/// Calls visit(point) on a grid over a triangle, with steps of at most `step`; not at all if its edges are shorter.
template <typename Visit>
void visit_samples(const std::array<Vec3, 3>& x, double step, const Visit& visit) {
  const Vec3 u = x[1] - x[0], v = x[2] - x[0];
  const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
  const int n = static_cast<int>(std::ceil(longest / step));
  for (int i = 0; i <= n && n > 1; ++i)
    for (int j = 0; i + j <= n; ++j)
      visit(Vec3(x[0] + (static_cast<double>(i) / n) * u + (static_cast<double>(j) / n) * v));
}

class Filling {
 public:
  Filling(const SurfaceMesh& surface, const ErrorBudgetParams& params, const Threads& threads)
      : surface_(surface),
        params_(params),
        threads_(threads),
        base_edge_(params.base_edge * params.error),
        frame_{used_bounds(surface).center(), std::ldexp(base_edge_, -params.finer)},
        octree_(frame_, used_bounds(surface), params.finer + params.coarser),
        sampler_(surface.positions, surface.triangles, frame_) {
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      octree_.refine(corners(surface.positions, surface.triangles[t]), params.finer);
  }

  GradedFilling run() {
    GradedFilling filling;
    for (int round = 0; round < params_.finer + 3; ++round) {
      filling = fill();
      const std::vector<Vec3> missed = find_missed(filling.stuffed);
      if (missed.empty() || round + 1 == params_.finer + 3 || !refine(missed)) break;
    }
    return filling;
  }

 private:
  static std::array<Vec3, 3> corners(const std::vector<Vec3>& points, const Triangle& triangle) {
    return {points[at(triangle[0])], points[at(triangle[1])], points[at(triangle[2])]};
  }

  GradedFilling fill() const {
    GradedFilling filling;
    const LatticeNodeSet nodes = octree_.nodes();
    filling.distance = sampler_.sample(nodes, std::ldexp(base_edge_, params_.coarser), threads_);
    filling.stuffed = stuff_octree(octree_, nodes, filling.distance.lattice.values);
    mend_boundary(filling.stuffed);
    filling.stuffed.mesh.lattice = {frame_.origin, base_edge_};
    filling.finest_edge = frame_.spacing;
    BoundaryFitParams fit;
    fit.tolerance = params_.fit_tolerance * params_.error / base_edge_;
    fit_boundary(filling.stuffed, surface_, fit, threads_);
    return filling;
  }

  /// Vertices of triangles, and samples of large ones, that are further than the budget from those of a tree; in order.
  std::vector<Vec3> far_samples(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                                const TriangleTree& tree) const {
    std::vector<Vec3> samples;
    std::vector<bool> taken(points.size(), false);
    for (const Triangle& triangle : triangles) {
      for (const Index v : triangle)
        if (!taken[at(v)]) samples.push_back(points[at(v)]);
      for (const Index v : triangle) taken[at(v)] = true;
      visit_samples(corners(points, triangle), kSampleStep * params_.error,
                    [&](const Vec3& p) { samples.push_back(p); });
    }
    const double limit = std::pow(kEnough * params_.error, 2);
    std::vector<std::uint8_t> is_far(samples.size());
    threads_.for_chunks(static_cast<std::int64_t>(samples.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
        is_far[i] = tree.nearest(samples[i], limit, [](Index, const Vec3&) { return true; }).triangle < 0 ? 1 : 0;
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (is_far[i] != 0) samples[kept++] = samples[i];
    samples.resize(kept);
    return samples;
  }

  /// Where the boundary and the surface are too far apart: points of both, and of the surface near those of the
  /// boundary.
  std::vector<Vec3> find_missed(const StuffedMesh& stuffed) const {
    std::vector<Triangle> boundary;
    for (const BoundaryFace& face : find_surface_faces(stuffed)) boundary.push_back(face.nodes);
    std::vector<Vec3> missed = far_samples(stuffed.mesh.nodes, boundary, sampler_.tree());
    const std::size_t of_boundary = missed.size();
    for (std::size_t i = 0; i < of_boundary; ++i) missed.push_back(sampler_.tree().nearest(missed[i]).point);
    if (boundary.empty()) return surface_.positions;
    const TriangleTree tree(stuffed.mesh.nodes, boundary);
    for (const Vec3& p : far_samples(surface_.positions, surface_.triangles, tree)) missed.push_back(p);
    return missed;
  }

  /// Halves the leaves at the points; false if all are as small as they may be.
  bool refine(const std::vector<Vec3>& missed) {
    std::vector<std::int32_t> levels;
    for (const Vec3& p : missed) levels.push_back(octree_.level_at(p));
    bool any = false;
    for (std::size_t i = 0; i < missed.size(); ++i) {
      if (levels[i] == 0) continue;
      any = true;
      octree_.refine(missed[i], levels[i] - 1);
    }
    return any;
  }

  const SurfaceMesh& surface_;
  const ErrorBudgetParams& params_;
  const Threads& threads_;
  double base_edge_;
  LatticeFrame frame_;
  GradedOctree octree_;
  DistanceSampler sampler_;
};

}  // namespace

GradedFilling fill_to_error(const SurfaceMesh& surface, const ErrorBudgetParams& params, const Threads& threads) {
  return Filling(surface, params, threads).run();
}

}  // namespace softreel
