#include "core/tetmesh/boundary_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "core/tetmesh/boundary_stars.h"

namespace softreel {
namespace {

constexpr std::int64_t kGrain = 256;

/// A node goes no further than this towards the nearest point of the surface, and a face is drawn to no sample further
/// away, in lengths of their longest edge: what is further away is not their own surface.
constexpr double kReach = 1.0;

/// Samples nearer than this share of the tolerance are let be.
constexpr double kNear = 0.8;

/// Newton's steps are damped by this share of the matrix's trace.
constexpr double kDamping = 0.05;

/// A face is drawn by the farthest of its samples, and by about so many others.
constexpr Index kFaceSamples = 12;

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
        wanted_(std::pow(params.tolerance * stuffed.mesh.lattice.spacing, 2)) {}

  void run() {
    const std::vector<std::array<Vec3, 3>> corners = stars_.face_corners(mesh_);
    sample_faces_.assign(samples_.size(), -1);
    if (memory_ != nullptr) memory_->find_sample_faces(corners, sample_faces_);
    probes_.resize(stars_.nodes.size() + stars_.edges.size() + stars_.faces.size());
    std::vector<Vec3> before;
    before.reserve(stars_.nodes.size());
    for (const Index node : stars_.nodes) before.push_back(position(node));
    draw_to_surface();
    moved_.assign(stars_.nodes.size(), true);
    for (int sweep = 0; sweep < params_.sweeps; ++sweep) {
      pair_samples();
      find_probes();
      moved_.assign(stars_.nodes.size(), false);
      bool any = false;
      for (std::size_t b = 0; b < stars_.nodes.size(); ++b) {
        if (!is_wanted(b) || !relax(b)) continue;
        moved_[b] = any = true;
      }
      if (!any) break;
    }
    pair_samples();
    find_probes();
    if (memory_ == nullptr) return;
    *memory_ = {};
    memory_->reserve(before.size());
    for (std::size_t b = 0; b < before.size(); ++b) memory_->add(before[b], position_of(b));
    memory_->set_sample_faces(corners, sample_faces_);
  }

  std::vector<BoundaryGap> gaps(double limit) const {
    std::vector<BoundaryGap> gaps;
    const double squared = limit * limit;
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      if (sample_distances_[s] <= squared) continue;
      const Triangle& face = stars_.faces[at(sample_faces_[s])].nodes;
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
    add_corner_gaps(limit, gaps);
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

  /// Gaps at three more points of each face, between its middle and its corners: no fit draws there.
  void add_corner_gaps(double limit, std::vector<BoundaryGap>& gaps) const {
    for (std::size_t f = 0; f < stars_.faces.size(); ++f) {
      const std::size_t p = stars_.nodes.size() + stars_.edges.size() + f;
      for (const Index corner : stars_.faces[f].nodes) {
        const Vec3 x = 0.5 * (probe_point(p) + position(corner));
        const TriangleTree::Nearest found = tree_.nearest_from(x, probes_[p].place, limit * limit);
        if (found.triangle >= 0 && found.squared_distance > limit * limit)
          gaps.push_back({found.point, x, stars_.faces[f].nodes, true});
      }
    }
  }

  /// Moves every node to the nearest point of the surface, as far as its star allows.
  void draw_to_surface() {
    std::vector<Vec3> targets(stars_.nodes.size());
    threads_.for_chunks(static_cast<std::int64_t>(targets.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
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

  /// Finds the face nearest to each sample, again where something moved.
  void pair_samples() {
    std::vector<Triangle> triangles(stars_.faces.size());
    std::transform(stars_.faces.begin(), stars_.faces.end(), triangles.begin(),
                   [](const BoundaryFace& face) { return face.nodes; });
    const TriangleTree boundary(mesh_.nodes, triangles);
    std::vector<Index> places(triangles.size());
    for (std::size_t p = 0; p < places.size(); ++p) places[at(boundary.order()[p])] = static_cast<Index>(p);
    sample_distances_.resize(samples_.size());
    threads_.for_chunks(static_cast<std::int64_t>(samples_.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
      Index guess = -1;
      for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
        if (const Index face = sample_faces_[s]; face >= 0) {
          if (!has_moved(face) && sample_distances_[s] < near_) continue;
          sample_distances_[s] = squared_distance(samples_[s], face);
          if (sample_distances_[s] < near_) continue;
          guess = places[at(face)];
        }
        const TriangleTree::Nearest found = boundary.nearest_from(samples_[s], guess, near_);
        guess = found.place;
        sample_faces_[s] = found.triangle;
        sample_distances_[s] = found.squared_distance;
      }
    });
    list_samples();
  }

  bool has_moved(Index face) const {
    return std::any_of(stars_.faces[at(face)].nodes.begin(), stars_.faces[at(face)].nodes.end(),
                       [&](Index node) { return moved_[at(stars_.numbers[at(node)])]; });
  }

  /// Samples of each face; without those that are out of reach, and some of many.
  void list_samples() {
    std::vector<double> reach(stars_.faces.size());
    for (std::size_t f = 0; f < reach.size(); ++f) {
      const auto& [a, b, c] = stars_.faces[f].nodes;
      reach[f] = kReach * kReach *
                 std::max({(position(a) - position(b)).squaredNorm(), (position(b) - position(c)).squaredNorm(),
                           (position(c) - position(a)).squaredNorm()});
    }
    std::vector<Index> counts(stars_.faces.size(), 0), farthest(stars_.faces.size(), -1);
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      const std::size_t f = at(sample_faces_[s]);
      if (sample_distances_[s] > reach[f]) continue;
      ++counts[f];
      if (farthest[f] < 0 || sample_distances_[s] > sample_distances_[at(farthest[f])])
        farthest[f] = static_cast<Index>(s);
    }
    face_samples_ = {};  // before there is a new one
    face_samples_ = CompressedList(stars_.faces.size(), [&](const auto& with) {
      std::vector<Index> seen(stars_.faces.size(), 0);
      for (std::size_t s = 0; s < samples_.size(); ++s) {
        const std::size_t f = at(sample_faces_[s]);
        if (sample_distances_[s] > reach[f]) continue;
        const bool is_turn = seen[f]++ % (counts[f] / kFaceSamples + 1) == 0;
        if (is_turn || farthest[f] == static_cast<Index>(s)) with(f, static_cast<Index>(s));
      }
    });
  }

  double squared_distance(const Vec3& p, Index face) const {
    const auto& [a, b, c] = stars_.faces[at(face)].nodes;
    return (nearest_on_triangle(p, position(a), position(b), position(c)) - p).squaredNorm();
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
    threads_.for_chunks(static_cast<std::int64_t>(probes_.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
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
      for (const Index s : face_samples_.of(at(f))) most = std::max(most, sample_distances_[at(s)]);
    return most > wanted_;
  }

  /// Lists the samples that the faces of a node are drawn by, face by face.
  void take_star_samples(std::size_t b) {
    star_samples_.clear();
    for (const Index f : stars_.faces_of.of(b))
      for (const Index s : face_samples_.of(at(f))) star_samples_.push_back(samples_[at(s)]);
  }

  /// Sum of the sixth powers of the distances of all samples and probes of a node: mostly that of the largest. Stops
  /// where it is more than `limit`.
  double energy(std::size_t b, double limit) const {
    double sum = 0;
    const Vec3* x = star_samples_.data();
    for (const Index f : stars_.faces_of.of(b))
      for (std::size_t s = 0; s < face_samples_.of(at(f)).size(); ++s, ++x) {
        double least = squared_distance(*x, f);
        if (least > near_)
          for (const Index g : stars_.faces_of.of(b)) least = std::min(least, squared_distance(*x, g));
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
      for (std::size_t s = 0; s < face_samples_.of(at(f)).size(); ++s, ++x) {
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
  double near_, wanted_;                  ///< squared, m^2
  std::vector<Index> sample_faces_;       ///< per sample: the nearest face
  std::vector<double> sample_distances_;  ///< to it, squared
  CompressedList face_samples_;
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

void fit_boundary(StuffedMesh& stuffed, const SurfaceMesh& surface, const BoundaryFitParams& params,
                  const Threads& threads) {
  if (stuffed.mesh.tets.empty()) return;
  const TriangleTree tree(surface.positions, surface.triangles);
  const SurfaceSamples samples(surface, tree.order(), 0.5 * stuffed.mesh.lattice.spacing);
  const BoundaryFit fit(stuffed, tree, samples, params, threads);
}

}  // namespace softreel
