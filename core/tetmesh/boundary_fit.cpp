#include "core/tetmesh/boundary_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <Eigen/Dense>

#include "core/tetmesh/boundary_probes.h"
#include "core/tetmesh/boundary_stars.h"
#include "core/tetmesh/sample_pairing.h"
#include "core/tetmesh/surface_samples.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

/// A node goes no further than this towards the nearest point of the surface, in lengths of its longest edge: what is
/// further away is not its own surface.
constexpr double kReach = 1.0;

/// Samples nearer than this share of the tolerance are let be.
constexpr double kNear = 0.8;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

double cubed(double x) {
  return x * x * x;
}

}  // namespace

/// The boundary nodes and their stars, and the elements while they are fitted.
class BoundaryFit::Fit {
 public:
  Fit(StuffedMesh& stuffed, const TriangleTree& tree, std::span<const Vec3> samples, const BoundaryFitParams& params,
      const Threads& threads, FitMemory* memory)
      : mesh_(stuffed.mesh),
        params_(params),
        threads_(threads),
        memory_(memory),
        stars_(stuffed),
        near_(std::pow(kNear * params.tolerance * stuffed.mesh.lattice.spacing, 2)),
        wanted_(std::pow(params.tolerance * stuffed.mesh.lattice.spacing, 2)),
        samples_(samples, stars_, mesh_, near_),
        probes_(tree, stars_, mesh_, near_),
        moved_(stars_.nodes.size(), 1),
        settled_(stars_.nodes.size(), 0) {}

  void run() {
    std::vector<Vec3> before;
    for (const Index node : stars_.nodes) before.push_back(position(node));
    begin();
    for (int sweep = 0; sweep < params_.sweeps; ++sweep) {
      if (!relax_all()) break;
      measure();
    }
    if (memory_ == nullptr) return;
    *memory_ = FitMemory(stars_, std::move(before), mesh_.nodes);
    memory_->settled = settled_;
    memory_->probes = probes_.near_triangles();
    memory_->samples = samples_.near_faces();
  }

  std::vector<BoundaryGap> gaps(double limit) const {
    std::vector<BoundaryGap> gaps;
    const double squared = limit * limit;
    for (std::size_t s = 0; s < samples_.near_faces().size(); ++s) {
      if (samples_.near_faces()[s].squared <= squared) continue;
      const Vec3& x = samples_.point(static_cast<Index>(s));
      const Triangle& face = stars_.faces[at(samples_.near_faces()[s].number)].nodes;
      gaps.push_back({x, nearest_on_triangle(x, position(face[0]), position(face[1]), position(face[2])), face});
    }
    const auto add_probe = [&](std::size_t p, const Triangle& face) {
      if (probes_[p].number < 0 || probes_[p].squared <= squared) return;
      gaps.push_back({probes_.foot(p), probes_.point(p), face, true});
    };
    for (std::size_t f = 0; f < stars_.faces.size(); ++f) add_probe(probes_.of_face(f), stars_.faces[f].nodes);
    for (std::size_t e = 0; e < stars_.edges.size(); ++e)
      add_probe(probes_.of_edge(e), {stars_.edges[e][0], stars_.edges[e][1], stars_.edges[e][1]});
    for (std::size_t b = 0; b < stars_.nodes.size(); ++b)
      add_probe(b, {stars_.nodes[b], stars_.nodes[b], stars_.nodes[b]});
    return gaps;
  }

 private:
  const Vec3& position(Index node) const { return mesh_.nodes[at(node)]; }
  Vec3& position_of(std::size_t b) { return mesh_.nodes[at(stars_.nodes[b])]; }

  double longest_edge(std::size_t b) const {
    double squared = 0;
    for (const Index e : stars_.edges_of.of(b))
      squared = std::max(squared, (position(stars_.edges[at(e)][0]) - position(stars_.edges[at(e)][1])).squaredNorm());
    return std::sqrt(squared);
  }

  /// Puts the nodes where an earlier fit left them, and new ones on the surface; measures what is not known yet.
  void begin() {
    if (memory_ == nullptr || memory_->before.empty()) {
      draw_to_surface(std::vector<Index>(stars_.nodes.size(), -1));
      measure();
      return;
    }
    const Recollection known(*memory_, stars_, mesh_.nodes);
    samples_.recall(*memory_, known);
    probes_.recall(*memory_, known);
    draw_to_surface(known.nodes);
    for (std::size_t b = 0; b < moved_.size(); ++b)
      if (const Index old = known.nodes[b]; old >= 0 && position_of(b) == memory_->after[at(old)]) {
        moved_[b] = 0;
        settled_[b] = memory_->settled[at(old)];
      }
    const auto unsettle_new = [&](const std::vector<Index>& old_numbers, const auto& nodes_of) {
      for (std::size_t i = 0; i < old_numbers.size(); ++i)
        if (old_numbers[i] < 0)
          for (const Index node : nodes_of(i)) settled_[at(stars_.numbers[at(node)])] = 0;
    };
    unsettle_new(
        known.edges, [&](std::size_t e) -> const auto& { return stars_.edges[e]; });
    unsettle_new(
        known.faces, [&](std::size_t f) -> const auto& { return stars_.faces[f].nodes; });
    measure();
  }

  /// Moves every node to the nearest point of the surface, or to where it was before, as far as its star allows.
  void draw_to_surface(const std::vector<Index>& known) {
    probes_.find_at_nodes(threads_);
    std::vector<Vec3> targets(stars_.nodes.size());
    for (std::size_t b = 0; b < targets.size(); ++b) {
      targets[b] = position_of(b);
      if (known[b] >= 0)
        targets[b] = memory_->after[at(known[b])];
      else if (probes_[b].squared < std::pow(kReach * longest_edge(b), 2))
        targets[b] = probes_.foot(b);
    }
    // Twice: at first neighbours may not be where they leave room.
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t b = 0; b < targets.size(); ++b) {
        const Vec3 step = targets[b] - position_of(b);
        if (!(step.squaredNorm() > 1e-8 * wanted_) || try_step(b, step, [] { return true; }) < 1) continue;
        if (known[b] >= 0) position_of(b) = targets[b];  // to the last bit: what was measured there stands
      }
  }

  /// Pairs samples and probes anew where nodes moved. What changed may let its nodes move again.
  void measure() {
    const std::vector<std::uint8_t> changed = samples_.update(moved_, threads_);
    probes_.update(moved_, threads_);
    for (std::size_t f = 0; f < changed.size(); ++f)
      if (changed[f] != 0)
        for (const Index node : stars_.faces[f].nodes) settled_[at(stars_.numbers[at(node)])] = 0;
    for (std::size_t b = 0; b < moved_.size(); ++b) {
      if (moved_[b] == 0) continue;
      for (const Index e : stars_.elements_of.of(b))
        for (const Index node : mesh_.tets[at(e)])
          if (const Index near = stars_.numbers[at(node)]; near >= 0) settled_[at(near)] = 0;
    }
  }

  /// One sweep. Where a node could not move and nothing near it changed since, it is not tried again.
  bool relax_all() {
    moved_.assign(stars_.nodes.size(), 0);
    bool any = false;
    for (std::size_t b = 0; b < stars_.nodes.size(); ++b) {
      if (settled_[b] != 0) continue;
      if (is_wanted(b) && relax(b))
        moved_[b] = any = true;
      else
        settled_[b] = 1;
    }
    return any;
  }

  /// Whether something at the node is further away than the tolerance.
  bool is_wanted(std::size_t b) const {
    double most = 0;
    probes_.visit_probes(b, [&](std::size_t p, double) { most = std::max(most, probes_[p].squared); });
    for (const Index f : stars_.faces_of.of(b))
      for (const Index s : samples_.of_face(f)) most = std::max(most, samples_.squared(s));
    return most > wanted_;
  }

  /// Sum of the sixth powers of the distances of all samples and probes of a node: mostly that of the largest. Stops
  /// where it is more than `limit`.
  double energy(std::size_t b, double limit) const {
    double sum = 0;
    for (const Index f : stars_.faces_of.of(b))
      for (const Index s : samples_.of_face(f)) {
        double least = samples_.squared_distance(samples_.point(s), f);
        if (least > near_)
          for (const Index g : stars_.faces_of.of(b))
            least = std::min(least, samples_.squared_distance(samples_.point(s), g));
        sum += cubed(least);
        if (sum > limit) return sum;
      }
    probes_.visit_probes(b, [&](std::size_t p, double) {
      if (sum <= limit) sum += cubed(probes_.measure(p).squared);
    });
    return sum;
  }

  /// A step of Newton's method for the energy, in which each distance changes along its direction only.
  Vec3 newton_step(std::size_t b) const {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    Vec3 force = Vec3::Zero();
    const auto add = [&](const Vec3& gap, double share) {
      const double squared = gap.squaredNorm();
      matrix += (share * share * squared) * gap * gap.transpose();
      force += (share * squared * squared) * gap;
    };
    probes_.visit_probes(b, [&](std::size_t p, double share) {
      if (probes_[p].number >= 0) add(probes_.foot(p) - probes_.point(p), share);
    });
    const Index own = stars_.nodes[b];
    for (const Index f : stars_.faces_of.of(b)) {
      const auto& [i, j, k] = stars_.faces[at(f)].nodes;
      for (const Index s : samples_.of_face(f)) {
        const Vec3& x = samples_.point(s);
        const Vec3 foot = nearest_on_triangle(x, position(i), position(j), position(k));
        const double share = barycentric_share(foot, own, stars_.faces[at(f)].nodes);
        if (share > 0) add(x - foot, share);
      }
    }
    matrix.diagonal().array() += kDamping * matrix.trace() + 1e-300;
    return matrix.ldlt().solve(force);
  }
  static constexpr double kDamping = 0.05;

  /// Barycentric weight of one corner at a point of a face.
  double barycentric_share(const Vec3& p, Index own, const Triangle& face) const {
    const std::size_t k = face[0] == own ? 0 : face[1] == own ? 1 : 2;
    const Vec3 &a = position(face[k]), &b = position(face[(k + 1) % 3]), &c = position(face[(k + 2) % 3]);
    const Vec3 area = (b - a).cross(c - a);
    return area.dot((b - p).cross(c - p)) / area.squaredNorm();
  }

  bool relax(std::size_t b) {
    Vec3 step = newton_step(b);
    const double longest = 0.5 * longest_edge(b);
    if (step.norm() > longest) step *= longest / step.norm();
    if (!(step.squaredNorm() > 1e-8 * wanted_)) return false;
    const double limit = 0.98 * energy(b, 1e300);
    return try_step(b, step, [&] { return energy(b, limit) < limit; }) > 0;
  }

  /// All of the step, half, a quarter ... as the star and `accept` allow; the share taken, 0 if there was no way.
  template <typename Accept>
  double try_step(std::size_t b, const Vec3& step, const Accept& accept) {
    Vec3& x = position_of(b);
    const Vec3 from = x;
    CosineRange bounds = stars_.cosines(mesh_, b);
    bounds.low = std::min(bounds.low, std::cos(params_.max_dihedral * std::numbers::pi / 180));
    bounds.high = std::max(bounds.high, std::cos(params_.min_dihedral * std::numbers::pi / 180));
    for (double share = 1; share > 0.1; share *= 0.5) {
      x = from + share * step;
      if (stars_.cosines(mesh_, b).is_within(bounds) && accept()) return share;
    }
    x = from;
    return 0;
  }

  TetMesh& mesh_;
  const BoundaryFitParams& params_;
  const Threads& threads_;
  FitMemory* memory_;  ///< may be null
  BoundaryStars stars_;
  double near_, wanted_;  ///< squared, m^2
  SamplePairing samples_;
  BoundaryProbes probes_;
  std::vector<std::uint8_t> moved_;    ///< per boundary node: since the last measurement
  std::vector<std::uint8_t> settled_;  ///< per boundary node: could not move, and nothing near it changed since
};

BoundaryFit::BoundaryFit(StuffedMesh& stuffed, const TriangleTree& tree, std::span<const Vec3> samples,
                         const BoundaryFitParams& params, const Threads& threads, FitMemory* memory)
    : fit_(std::make_unique<Fit>(stuffed, tree, samples, params, threads, memory)) {
  fit_->run();
}

BoundaryFit::~BoundaryFit() = default;

std::vector<BoundaryGap> BoundaryFit::gaps(double limit) const {
  return fit_->gaps(limit);
}

void fit_boundary(StuffedMesh& stuffed, const SurfaceMesh& surface, const BoundaryFitParams& params,
                  const Threads& threads) {
  if (stuffed.mesh.tets.empty()) return;
  const TriangleTree tree(surface.positions, surface.triangles);
  const std::vector<Vec3> samples = sample_surface(surface, tree.order(), 0.5 * stuffed.mesh.lattice.spacing);
  const BoundaryFit fit(stuffed, tree, samples, params, threads);
}

}  // namespace softreel
