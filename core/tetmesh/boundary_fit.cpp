#include "core/tetmesh/boundary_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "core/tetmesh/boundary_mending.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

constexpr std::int64_t kGrain = 512;

/// A node goes no further than this towards its target, in spacings: what is further away is not its own surface.
constexpr double kReach = 1.5;

/// Nearer to its target than this, in spacings, a node stays.
constexpr double kArrived = 1e-4;

/// A pull must bring the faces round its node nearer to the surface, to this share of their distance.
constexpr double kWorthwhile = 0.95;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

/// Cosines of the dihedral angles of some elements; `positive` if all have volume.
struct CosineRange {
  double low = 1, high = -1;
  bool positive = true;

  void add(const std::array<Vec3, 4>& x) {
    const Vec3 ab = x[1] - x[0], ac = x[2] - x[0], ad = x[3] - x[0], bc = x[2] - x[1], bd = x[3] - x[1];
    const Vec3 abc = ac.cross(ab);
    const std::array<Vec3, 4> normals{bc.cross(bd), ad.cross(ac), ab.cross(ad), abc};
    if (!(abc.dot(ad) < 0)) positive = false;
    std::array<double, 4> scales;
    for (std::size_t i = 0; i < 4; ++i) scales[i] = 1.0 / normals[i].norm();
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const double cosine = -normals[i].dot(normals[j]) * scales[i] * scales[j];
        low = std::min(low, cosine);
        high = std::max(high, cosine);
      }
  }
};

/// The boundary nodes and their stars, and the elements while they are fitted.
class Fit {
 public:
  Fit(StuffedMesh& stuffed, const SurfaceMesh& surface, const BoundaryFitParams& params, const Threads& threads)
      : stuffed_(stuffed),
        surface_(surface),
        params_(params),
        threads_(threads),
        tree_(surface.positions, surface.triangles),
        faces_(find_surface_faces(stuffed)),
        least_cosine_(std::cos(params.max_dihedral * std::numbers::pi / 180)),
        most_cosine_(std::cos(params.min_dihedral * std::numbers::pi / 180)) {
    find_stars();
  }

  void run() {
    waiting_.resize(nodes_.size());
    std::iota(waiting_.begin(), waiting_.end(), 0);
    missed_.resize(surface_.positions.size());
    std::iota(missed_.begin(), missed_.end(), 0);
    for (int sweep = 0; sweep < params_.sweeps; ++sweep) {
      find_targets();
      pull_by_surface();
      std::vector<Index> moved;
      for (std::size_t b = 0; b < nodes_.size(); ++b)
        if (move(b)) moved.push_back(static_cast<Index>(b));
      waiting_.swap(moved);
    }
  }

 private:
  const Vec3& position(Index node) const { return stuffed_.mesh.nodes[at(node)]; }
  double spacing() const { return stuffed_.mesh.lattice.spacing; }

  /// Numbers the boundary nodes and lists the elements of each.
  void find_stars() {
    numbers_.assign(stuffed_.mesh.nodes.size(), -1);
    for (const BoundaryFace& face : faces_)
      for (const Index node : face.nodes) numbers_[at(node)] = 0;
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      if (numbers_[i] < 0) continue;
      numbers_[i] = static_cast<Index>(nodes_.size());
      nodes_.push_back(static_cast<Index>(i));
    }
    star_ = list_owners(stuffed_.mesh.tets, [](const Tet& tet) { return tet; });
    fan_ = list_owners(faces_, [](const BoundaryFace& face) { return face.nodes; });
  }

  /// Elements or faces of each boundary node, as a compressed list.
  struct Owners {
    std::vector<Index> offsets, items;
    std::span<const Index> of(std::size_t b) const {
      return {items.data() + offsets[b], static_cast<std::size_t>(offsets[b + 1] - offsets[b])};
    }
  };

  template <typename Item, typename NodesOf>
  Owners list_owners(const std::vector<Item>& items, const NodesOf& nodes_of) const {
    Owners owners;
    owners.offsets.assign(nodes_.size() + 1, 0);
    const auto visit = [&](const auto& owned) {
      for (std::size_t i = 0; i < items.size(); ++i)
        for (const Index node : nodes_of(items[i]))
          if (const Index b = numbers_[at(node)]; b >= 0) owned(at(b), static_cast<Index>(i));
    };
    visit([&](std::size_t b, Index) { ++owners.offsets[b + 1]; });
    std::partial_sum(owners.offsets.begin(), owners.offsets.end(), owners.offsets.begin());
    owners.items.resize(at(owners.offsets.back()));
    std::vector<Index> next(owners.offsets.begin(), owners.offsets.end() - 1);
    visit([&](std::size_t b, Index i) { owners.items[at(next[b]++)] = i; });
    return owners;
  }

  /// First choice of a boundary node: the nearest point of the surface. Who is there already stays.
  void find_targets() {
    targets_.resize(nodes_.size());
    for (std::size_t b = 0; b < nodes_.size(); ++b) targets_[b] = position(nodes_[b]);
    threads_.for_chunks(static_cast<std::int64_t>(waiting_.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t w = begin; w < end; ++w) {
        Vec3& target = targets_[at(waiting_[static_cast<std::size_t>(w)])];
        const TriangleTree::Nearest found = nearest_in_reach(tree_, target);
        if (found.triangle >= 0) target = found.point;
      }
    });
  }

  TriangleTree::Nearest nearest_in_reach(const TriangleTree& tree, const Vec3& p) const {
    return tree.nearest(p, std::pow(kReach * spacing(), 2), [](Index, const Vec3&) { return true; });
  }

  /// A surface vertex that the boundary misses, and the boundary node nearest to it; -1 if it is not missed.
  struct Pull {
    Index vertex, node;
    double squared;
  };

  /// Pulls of the vertices missed so far; who is met once is not asked again.
  std::vector<Pull> find_pulls() const {
    std::vector<Triangle> triangles(faces_.size());
    std::transform(faces_.begin(), faces_.end(), triangles.begin(), [](const BoundaryFace& f) { return f.nodes; });
    const TriangleTree boundary(stuffed_.mesh.nodes, triangles);
    std::vector<Pull> pulls(missed_.size());
    const double least = std::pow(params_.tolerance * spacing(), 2);
    threads_.for_chunks(static_cast<std::int64_t>(pulls.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (auto m = static_cast<std::size_t>(begin); m < static_cast<std::size_t>(end); ++m) {
        const Vec3& p = surface_.positions[at(missed_[m])];
        const TriangleTree::Nearest found = nearest_in_reach(boundary, p);
        pulls[m] = {missed_[m], -1, found.squared_distance};
        if (found.triangle < 0 || found.squared_distance < least) continue;
        const auto nearer = [&](Index a, Index b) {
          return (stuffed_.mesh.nodes[at(a)] - p).squaredNorm() < (stuffed_.mesh.nodes[at(b)] - p).squaredNorm();
        };
        const Triangle& face = triangles[at(found.triangle)];
        pulls[m].node = *std::min_element(face.begin(), face.end(), nearer);
      }
    });
    std::erase_if(pulls, [](const Pull& pull) { return pull.node < 0; });
    return pulls;
  }

  /// Second choice: of the surface vertices that the boundary misses, the farthest pulls the node nearest to it.
  void pull_by_surface() {
    const std::vector<Pull> pulls = find_pulls();
    missed_.clear();
    pulled_.assign(nodes_.size(), false);
    std::vector<double> farthest(nodes_.size(), 0.0);
    for (const Pull& pull : pulls) {
      missed_.push_back(pull.vertex);
      const std::size_t b = at(numbers_[at(pull.node)]);
      if (pull.squared <= farthest[b]) continue;
      farthest[b] = pull.squared;
      targets_[b] = surface_.positions[at(pull.vertex)];
      pulled_[b] = true;
    }
  }

  /// How far the faces at a node and the surface vertex that pulls it are apart, at most, with samples in the faces.
  double pulled_error(std::size_t b) const {
    double error = 0, missed = 1e300;
    for (const Index f : fan_.of(b)) {
      std::array<Vec3, 3> x;
      for (std::size_t k = 0; k < 3; ++k) x[k] = position(faces_[at(f)].nodes[k]);
      missed = std::min(missed, (nearest_on_triangle(targets_[b], x[0], x[1], x[2]) - targets_[b]).squaredNorm());
      for (const Vec3& sample :
           {Vec3((x[0] + x[1] + x[2]) / 3), Vec3((x[0] + x[1]) / 2), Vec3((x[1] + x[2]) / 2), Vec3((x[2] + x[0]) / 2)})
        error = std::max(error, nearest_in_reach(tree_, sample).squared_distance);
    }
    return std::sqrt(std::max(error, missed));
  }

  CosineRange star_range(std::size_t b) const {
    CosineRange range;
    for (const Index e : star_.of(b)) {
      std::array<Vec3, 4> x;
      const Tet& tet = stuffed_.mesh.tets[at(e)];
      for (std::size_t k = 0; k < 4; ++k) x[k] = stuffed_.mesh.nodes[at(tet[k])];
      range.add(x);
    }
    return range;
  }

  /// As far towards the target as the star allows: all the way, half, a quarter ... True if there was a way to go.
  bool move(std::size_t b) {
    Vec3& x = stuffed_.mesh.nodes[at(nodes_[b])];
    const Vec3 from = x, step = targets_[b] - from;
    if (step.squaredNorm() < std::pow(kArrived * spacing(), 2)) return false;
    const CosineRange before = star_range(b);
    const double error = pulled_[b] ? pulled_error(b) : 0;
    for (double share = 1; share > 0.1; share *= 0.5) {
      x = from + share * step;
      const CosineRange after = star_range(b);
      if (after.positive && after.low >= std::min(least_cosine_, before.low) &&
          after.high <= std::max(most_cosine_, before.high) && (!pulled_[b] || pulled_error(b) < kWorthwhile * error))
        return true;
    }
    x = from;
    return true;
  }

  StuffedMesh& stuffed_;
  const SurfaceMesh& surface_;
  const BoundaryFitParams& params_;
  const Threads& threads_;
  TriangleTree tree_;
  std::vector<BoundaryFace> faces_;
  double least_cosine_, most_cosine_;
  std::vector<Index> nodes_, numbers_;  ///< boundary nodes; per node its place there, -1 inside
  Owners star_, fan_;                   ///< elements and boundary faces of each boundary node
  std::vector<Vec3> targets_;
  std::vector<bool> pulled_;    ///< targets that are of the second choice
  std::vector<Index> waiting_;  ///< boundary nodes that may not be on the surface yet
  std::vector<Index> missed_;   ///< surface vertices that may not be on the boundary yet
};

}  // namespace

void fit_boundary(StuffedMesh& stuffed, const SurfaceMesh& surface, const BoundaryFitParams& params,
                  const Threads& threads) {
  if (!stuffed.mesh.tets.empty()) Fit(stuffed, surface, params, threads).run();
}

}  // namespace softreel
