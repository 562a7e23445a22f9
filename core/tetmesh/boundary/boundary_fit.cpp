#include "core/tetmesh/boundary/boundary_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "core/tetmesh/boundary/boundary_stars.h"
#include "core/tetmesh/boundary/face_samples.h"

namespace softreel {
namespace {

constexpr std::int64_t kFitGrain = 256;

/// A node goes no further than this towards the nearest point of the surface, in lengths of its longest edge: what is
/// further away is not its own surface.
constexpr double kReach = 1.0;

/// Samples nearer than this share of the tolerance are let be.
constexpr double kNear = 0.8;

/// Newton's steps are damped by this share of the matrix's trace.
constexpr double kDamping = 0.05;

/// Barycentric weight of `a` at a point of a triangle's plane.
double first_weight(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 area = (b - a).cross(c - a);
  return area.dot((b - p).cross(c - p)) / area.squaredNorm();
}

}  // namespace

/// The boundary nodes and their stars, and the elements while they are fitted.
class BoundaryFit::Fit {
 public:
  Fit(StuffedMesh& stuffed, const TriangleTree& tree, const SurfaceSamples& samples, const BoundaryFitParams& params,
      const Threads& threads, FitMemory* memory)
      : mesh_(stuffed.mesh),
        tree_(tree),
        samples_(samples),
        params_(params),
        threads_(threads),
        memory_(memory),
        stars_(stuffed),
        near_(std::pow(kNear * params.tolerance * stuffed.mesh.lattice.spacing, 2)),
        wanted_(std::pow(params.tolerance * stuffed.mesh.lattice.spacing, 2)),
        face_samples_(mesh_, stars_, samples, near_, threads) {}

  void run() {
    const std::vector<std::array<Vec3, 3>> corners = stars_.face_corners(mesh_);
    if (memory_ != nullptr) memory_->find_sample_faces(corners, face_samples_.faces());
    probes_.resize(stars_.nodes.size() + stars_.edges.size() + stars_.faces.size());
    std::vector<Vec3> before;
    before.reserve(stars_.nodes.size());
    for (const Index node : stars_.nodes) before.push_back(position(node));
    draw_to_surface();
    moved_.assign(stars_.nodes.size(), true);
    for (int sweep = 0; sweep < params_.sweeps; ++sweep) {
      face_samples_.pair(moved_);
      find_probes();
      moved_.assign(stars_.nodes.size(), false);
      bool any = false;
      for (std::size_t b = 0; b < stars_.nodes.size(); ++b) {
        if (!is_wanted(b) || !relax(b)) continue;
        moved_[b] = any = true;
      }
      if (!any) break;
    }
    face_samples_.pair(moved_);
    find_probes();
    if (memory_ == nullptr) return;
    *memory_ = {};
    memory_->reserve(before.size());
    for (std::size_t b = 0; b < before.size(); ++b) memory_->add(before[b], position_of(b));
    memory_->set_sample_faces(corners, face_samples_.faces());
  }

  std::vector<BoundaryGap> gaps(double limit) const {
    std::vector<BoundaryGap> gaps;
    const double squared = limit * limit;
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      if (face_samples_.squared_distance(s) <= squared) continue;
      const Triangle& face = stars_.faces[at(face_samples_.faces()[s])].nodes;
      const Vec3 x = samples_[s];
      gaps.push_back({x, nearest_on_triangle(x, position(face[0]), position(face[1]), position(face[2])), face});
    }
    const auto add_probe = [&](std::size_t p, const Triangle& face) {
      if (probes_[p].place < 0 || probes_[p].squared <= squared) return;
      const auto& [a, b, c] = tree_.corners(probes_[p].place);
      const Vec3 x = probe_point(p);
      gaps.push_back({nearest_on_triangle(x, a, b, c), x, face, true});
    };
    for (std::size_t f = 0; f < stars_.faces.size(); ++f)
      add_probe(stars_.nodes.size() + stars_.edges.size() + f, stars_.faces[f].nodes);
    for (std::size_t e = 0; e < stars_.edges.size(); ++e)
      add_probe(stars_.nodes.size() + e, {stars_.edges[e][0], stars_.edges[e][1], stars_.edges[e][1]});
    for (std::size_t b = 0; b < stars_.nodes.size(); ++b)
      add_probe(b, {stars_.nodes[b], stars_.nodes[b], stars_.nodes[b]});
    return gaps;
  }

  std::vector<BoundaryGap> corner_gaps(double limit) const {
    const auto n = static_cast<std::int64_t>(stars_.faces.size());
    std::vector<std::vector<BoundaryGap>> chunks(static_cast<std::size_t>((n + kFitGrain - 1) / kFitGrain));
    threads_.for_chunks(n, kFitGrain, [&](std::int64_t begin, std::int64_t end) {
      for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f)
        add_corner_gaps(f, limit * limit, chunks[static_cast<std::size_t>(begin / kFitGrain)]);
    });
    std::vector<BoundaryGap> gaps;
    for (const std::vector<BoundaryGap>& chunk : chunks) gaps.insert(gaps.end(), chunk.begin(), chunk.end());
    return gaps;
  }

 private:
  /// The nearest triangle of the surface to a point of the boundary.
  struct Probe {
    Index place = -1;  ///< in the tree; -1: none within reach
    double squared = 0;
  };

  const Vec3& position(Index node) const { return mesh_.nodes[at(node)]; }
  Vec3& position_of(std::size_t b) { return mesh_.nodes[at(stars_.nodes[b])]; }

  double longest_edge(std::size_t b) const {
    double squared = 0;
    for (const Index e : stars_.edges_of.of(b))
      squared = std::max(squared, (position(stars_.edges[at(e)][0]) - position(stars_.edges[at(e)][1])).squaredNorm());
    return std::sqrt(squared);
  }

  void add_corner_gaps(std::size_t f, double squared, std::vector<BoundaryGap>& gaps) const {
    const std::size_t middle = stars_.nodes.size() + stars_.edges.size() + f;
    for (const Index corner : stars_.faces[f].nodes) {
      const Vec3 x = 0.5 * (probe_point(middle) + position(corner));
      const TriangleTree::Nearest found = tree_.nearest_from(x, probes_[middle].place, squared);
      if (found.triangle >= 0 && found.squared_distance > squared)
        gaps.push_back({found.point, x, stars_.faces[f].nodes, true});
    }
  }

  /// Moves every node to the nearest point of the surface, as far as its star allows.
  void draw_to_surface() {
    std::vector<Vec3> targets(stars_.nodes.size());
    threads_.for_chunks(static_cast<std::int64_t>(targets.size()), kFitGrain,
                        [&](std::int64_t begin, std::int64_t end) {
                          Index guess = -1;
                          for (auto b = static_cast<std::size_t>(begin); b < static_cast<std::size_t>(end); ++b) {
                            targets[b] = position(stars_.nodes[b]);
                            const TriangleTree::Nearest found = tree_.nearest_from(targets[b], guess);
                            probes_[b] = {found.place, found.squared_distance};
                            guess = found.place;
                            const Vec3* known = memory_ == nullptr ? nullptr : memory_->find(targets[b]);
                            if (known != nullptr)
                              targets[b] = *known;
                            else if (found.squared_distance < std::pow(kReach * longest_edge(b), 2))
                              targets[b] = found.point;
                          }
                        });
    // Twice: at first neighbours may not be where they leave room.
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t b = 0; b < targets.size(); ++b) {
        const Vec3 step = targets[b] - position_of(b);
        if (step.squaredNorm() > 1e-8 * wanted_) try_step(b, step, [] { return true; });
      }
    // What is near a node is a good guess for the edges and faces at it.
    for (std::size_t p = stars_.nodes.size(); p < probes_.size(); ++p) {
      const std::size_t e = p - stars_.nodes.size();
      const Index node = e < stars_.edges.size() ? stars_.edges[e][0] : stars_.faces[e - stars_.edges.size()].nodes[0];
      probes_[p].place = probes_[at(stars_.numbers[at(node)])].place;
    }
  }

  bool has_moved(Index face) const {
    return std::any_of(stars_.faces[at(face)].nodes.begin(), stars_.faces[at(face)].nodes.end(),
                       [&](Index node) { return moved_[at(stars_.numbers[at(node)])]; });
  }

  /// Probes are the boundary nodes, the middles of edges, and the middles of faces.
  Vec3 probe_point(std::size_t p) const {
    if (p < stars_.nodes.size()) return position(stars_.nodes[p]);
    p -= stars_.nodes.size();
    if (p < stars_.edges.size()) return 0.5 * (position(stars_.edges[p][0]) + position(stars_.edges[p][1]));
    const auto& [a, b, c] = stars_.faces[p - stars_.edges.size()].nodes;
    return (position(a) + position(b) + position(c)) / 3;
  }
  bool probe_moved(std::size_t p) const {
    if (p < stars_.nodes.size()) return moved_[p];
    p -= stars_.nodes.size();
    if (p >= stars_.edges.size()) return has_moved(static_cast<Index>(p - stars_.edges.size()));
    return moved_[at(stars_.numbers[at(stars_.edges[p][0])])] || moved_[at(stars_.numbers[at(stars_.edges[p][1])])];
  }

  void find_probes() {
    threads_.for_chunks(static_cast<std::int64_t>(probes_.size()), kFitGrain,
                        [&](std::int64_t begin, std::int64_t end) {
                          for (auto p = static_cast<std::size_t>(begin); p < static_cast<std::size_t>(end); ++p)
                            if (probe_moved(p)) probes_[p] = probe(p);
                        });
  }

  /// Beginning with the triangle that was the nearest before; that is good enough if it is near.
  Probe probe(std::size_t p) const {
    const Vec3 x = probe_point(p);
    if (probes_[p].place >= 0) {
      const auto& [a, b, c] = tree_.corners(probes_[p].place);
      const double squared = (nearest_on_triangle(x, a, b, c) - x).squaredNorm();
      if (squared < near_) return {probes_[p].place, squared};
    }
    const TriangleTree::Nearest found = tree_.nearest_from(x, probes_[p].place, params_.quick ? near_ : -1);
    return {found.place, found.squared_distance};
  }

  /// Calls visit(probe, share of the node in it) for the probes that move with a node.
  template <typename Visit>
  void visit_probes(std::size_t b, const Visit& visit) const {
    visit(b, 1.0);
    for (const Index e : stars_.edges_of.of(b)) visit(stars_.nodes.size() + at(e), 0.5);
    for (const Index f : stars_.faces_of.of(b)) visit(stars_.nodes.size() + stars_.edges.size() + at(f), 1.0 / 3);
  }

  /// Whether something at the node is further away than the tolerance.
  bool is_wanted(std::size_t b) const {
    double most = 0;
    visit_probes(b, [&](std::size_t p, double) { most = std::max(most, probes_[p].squared); });
    for (const Index f : stars_.faces_of.of(b))
      for (const Index s : face_samples_.of(f)) most = std::max(most, face_samples_.squared_distance(at(s)));
    return most > wanted_;
  }

  /// Lists the samples that the faces of a node are drawn by, face by face.
  void take_star_samples(std::size_t b) {
    star_samples_.clear();
    for (const Index f : stars_.faces_of.of(b))
      for (const Index s : face_samples_.of(f)) star_samples_.push_back(samples_[at(s)]);
  }

  /// Sum of the sixth powers of the distances of all samples and probes of a node: mostly that of the largest. Stops
  /// where it is more than `limit`.
  double energy(std::size_t b, double limit) const {
    double sum = 0;
    const Vec3* x = star_samples_.data();
    for (const Index f : stars_.faces_of.of(b))
      for (std::size_t s = 0; s < face_samples_.of(f).size(); ++s, ++x) {
        double least = face_samples_.squared_distance(*x, f);
        if (least > near_)
          for (const Index g : stars_.faces_of.of(b)) least = std::min(least, face_samples_.squared_distance(*x, g));
        sum += least * least * least;
        if (sum > limit) return sum;
      }
    visit_probes(b, [&](std::size_t p, double) {
      if (sum > limit) return;
      const double squared = probe(p).squared;
      sum += squared * squared * squared;
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
    visit_probes(b, [&](std::size_t p, double share) {
      if (probes_[p].place < 0) return;
      const Vec3 x = probe_point(p);
      const auto& [u, v, w] = tree_.corners(probes_[p].place);
      add(nearest_on_triangle(x, u, v, w) - x, share);
    });
    const Index own = stars_.nodes[b];
    const Vec3* x = star_samples_.data();
    for (const Index f : stars_.faces_of.of(b)) {
      const auto& [i, j, k] = stars_.faces[at(f)].nodes;
      for (std::size_t s = 0; s < face_samples_.of(f).size(); ++s, ++x) {
        const Vec3 foot = nearest_on_triangle(*x, position(i), position(j), position(k));
        const std::array<Index, 2> rest = own == i ? std::array{j, k} : own == j ? std::array{k, i} : std::array{i, j};
        const double share = first_weight(foot, position(own), position(rest[0]), position(rest[1]));
        if (share > 0) add(*x - foot, share);
      }
    }
    matrix.diagonal().array() += kDamping * matrix.trace() + 1e-300;
    return matrix.ldlt().solve(force);
  }

  bool relax(std::size_t b) {
    take_star_samples(b);
    Vec3 step = newton_step(b);
    const double longest = 0.5 * longest_edge(b);
    if (step.norm() > longest) step *= longest / step.norm();
    if (!(step.squaredNorm() > 1e-8 * wanted_)) return false;
    const double limit = 0.98 * energy(b, 1e300);
    return try_step(b, step, [&] { return energy(b, limit) < limit; });
  }

  /// All of the step, half, a quarter ... as the star and `accept` allow; whether there was a way.
  template <typename Accept>
  bool try_step(std::size_t b, const Vec3& step, const Accept& accept) {
    Vec3& x = position_of(b);
    const Vec3 from = x;
    CosineRange bounds = stars_.cosines(mesh_, b);
    bounds.low = std::min(bounds.low, std::cos(params_.max_dihedral * std::numbers::pi / 180));
    bounds.high = std::max(bounds.high, std::cos(params_.min_dihedral * std::numbers::pi / 180));
    for (double share = 1; share > 0.1; share *= 0.5) {
      x = from + share * step;
      if (stars_.cosines(mesh_, b).is_within(bounds) && accept()) return true;
    }
    x = from;
    return false;
  }

  TetMesh& mesh_;
  const TriangleTree& tree_;
  const SurfaceSamples& samples_;
  const BoundaryFitParams& params_;
  const Threads& threads_;
  FitMemory* memory_;  ///< may be null
  BoundaryStars stars_;
  double near_, wanted_;  ///< squared, m^2
  FaceSamples face_samples_;
  std::vector<Vec3> star_samples_;  ///< of the node that is being moved, see take_star_samples
  std::vector<Probe> probes_;
  std::vector<bool> moved_;  ///< per boundary node: since the last search
};

BoundaryFit::BoundaryFit(StuffedMesh& stuffed, const TriangleTree& tree, const SurfaceSamples& samples,
                         const BoundaryFitParams& params, const Threads& threads, FitMemory* memory)
    : fit_(std::make_unique<Fit>(stuffed, tree, samples, params, threads, memory)) {
  fit_->run();
}

BoundaryFit::~BoundaryFit() = default;

std::vector<BoundaryGap> BoundaryFit::gaps(double limit) const {
  return fit_->gaps(limit);
}

std::vector<BoundaryGap> BoundaryFit::corner_gaps(double limit) const {
  return fit_->corner_gaps(limit);
}

void fit_boundary(StuffedMesh& stuffed, const SurfaceMesh& surface, const BoundaryFitParams& params,
                  const Threads& threads) {
  if (stuffed.mesh.tets.empty()) return;
  const TriangleTree tree(surface.positions, surface.triangles);
  const SurfaceSamples samples(surface, tree.order(), 0.5 * stuffed.mesh.lattice.spacing);
  const BoundaryFit fit(stuffed, tree, samples, params, threads);
}

}  // namespace softreel
