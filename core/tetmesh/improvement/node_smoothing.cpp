#include "core/tetmesh/improvement/node_smoothing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softreel {
namespace {

/// At most so many steps of ascent; each is a line search of at most kHalvings evaluations.
constexpr int kSteps = 12, kHalvings = 7;

/// The first step goes this share of the shortest edge at the node.
constexpr double kFirstStep = 0.4;

/// What is within this share of the worst quality counts as nearly the worst; where that leaves no way up, a quarter of
/// it. Qualities below kLow count as that.
constexpr double kBand = 0.2, kLow = 0.1;
constexpr int kBandQuarterings = 3;

/// A step must gain this share of what the gradients promise.
constexpr double kPromiseKept = 0.1;

/// Shorter than this share of the longest gradient, the shortest vector of the hull means that there is no way up.
constexpr double kNoAscent = 1e-3;

/// Shortest vector of the convex hull of some vectors, nearly: found by exchanging the vector so far for the best on
/// the line to the one that opposes it most.
Vec3 shortest_in_hull(const std::vector<Vec3>& vectors) {
  constexpr int kRounds = 40;
  constexpr double kDone = 1e-3;
  Vec3 shortest = *std::ranges::min_element(vectors, {}, [](const Vec3& v) { return v.squaredNorm(); });
  for (int round = 0; round < kRounds; ++round) {
    const Vec3& opposed = *std::ranges::min_element(vectors, {}, [&](const Vec3& v) { return v.dot(shortest); });
    const Vec3 line = opposed - shortest;
    const double gain = -line.dot(shortest);
    if (gain <= kDone * shortest.squaredNorm()) break;
    shortest += std::min(1.0, gain / line.squaredNorm()) * line;
  }
  return shortest;
}

/// One element while a corner moves: outward unit normals, doubled areas, and the edge of each face that the corner
/// sees.
struct MovingCorner {
  std::array<Vec3, 4> normals;  ///< face k lies opposite corner k; the moving corner is 0
  std::array<double, 4> areas;
  std::array<Vec3, 4> edges;  ///< of faces 1, 2, 3: along the face's edge that the moving corner is not on

  explicit MovingCorner(const TetCorners& x) {
    const Vec3 ab = x[1] - x[0], ac = x[2] - x[0], ad = x[3] - x[0];
    normals = {(x[2] - x[1]).cross(x[3] - x[1]), ad.cross(ac), ab.cross(ad), ac.cross(ab)};
    edges = {Vec3::Zero(), x[3] - x[2], x[1] - x[3], x[2] - x[1]};
    for (std::size_t k = 0; k < 4; ++k) {
      areas[k] = normals[k].norm();
      normals[k] /= areas[k];
    }
  }

  /// Gradient of the cosine of the dihedral angle between two faces by the moving corner. With n = (u - p) x (v - p),
  /// dn = dp x (u - v).
  Vec3 cosine_gradient(std::size_t i, std::size_t j, double cosine) const {
    Vec3 gradient = Vec3::Zero();
    if (i != 0) gradient -= edges[i].cross(normals[j] + cosine * normals[i]) / areas[i];
    if (j != 0) gradient -= edges[j].cross(normals[i] + cosine * normals[j]) / areas[j];
    return gradient;
  }
};

}  // namespace

/// The opposite faces, in the order that keeps the element positive when the node comes first.
void NodeSmoothing::gather(Index node) {
  constexpr std::size_t kOthers[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  node_ = node;
  opposite_.clear();
  for (const Index e : tets_.star(node)) {
    const Tet& tet = tets_.tet(e);
    const auto& others = kOthers[std::find(tet.begin(), tet.end(), node) - tet.begin()];
    opposite_.push_back(
        {tets_.position(tet[others[0]]), tets_.position(tet[others[1]]), tets_.position(tet[others[2]])});
  }
}

/// Worst quality with the node at x; something below or equal to `limit` as soon as an element is not above it. That
/// element goes to the front: it will probably be the first to object next time.
double NodeSmoothing::quality_at(const Vec3& x, double limit) {
  double worst = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < opposite_.size(); ++i) {
    const auto& [b, c, d] = opposite_[i];
    worst = std::min(worst, tets_.measure().new_quality({x, b, c, d}));
    if (worst > limit) continue;
    std::swap(opposite_[0], opposite_[i]);
    break;
  }
  return worst;
}

/// Of all terms of the quality that are not above `limit`.
void NodeSmoothing::find_gradients(const Vec3& x, double limit) {
  gradients_.clear();
  const double least = tets_.measure().least_weight(), largest = tets_.measure().largest_weight();
  for (const auto& [b, c, d] : opposite_) {
    const MovingCorner element({x, b, c, d});
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const double cosine = -element.normals[i].dot(element.normals[j]);
        if (least * (1 - cosine) <= limit) gradients_.push_back(-least * element.cosine_gradient(i, j, cosine));
        if (largest * (1 + cosine) <= limit) gradients_.push_back(largest * element.cosine_gradient(i, j, cosine));
      }
  }
  if (slides_)
    for (Vec3& gradient : gradients_) gradient -= normal_.dot(gradient) * normal_;
}

/// A vector whose length is the slope of the worst quality in its direction; zero if there is no way up.
Vec3 NodeSmoothing::direction(const Vec3& x, double quality) {
  if (quality < 0) return Vec3::Zero();
  double band = kBand * std::max(quality, kLow);
  for (int k = 0; k <= kBandQuarterings; ++k, band *= 0.25) {
    find_gradients(x, quality + band);
    if (gradients_.empty()) continue;
    double longest = 0;
    for (const Vec3& gradient : gradients_) longest = std::max(longest, gradient.norm());
    const Vec3 up = shortest_in_hull(gradients_);
    if (up.norm() > kNoAscent * longest) return up;
  }
  return Vec3::Zero();
}

double NodeSmoothing::shortest_edge(const Vec3& x) const {
  double squared = std::numeric_limits<double>::max();
  for (const auto& face : opposite_)
    for (const Vec3& corner : face) squared = std::min(squared, (corner - x).squaredNorm());
  return std::sqrt(squared);
}

Vec3 NodeSmoothing::placed(const Vec3& x) const {
  return slides_ ? slide_->place(node_, x) : x;
}

/// One line search; false if no point on the line is better.
bool NodeSmoothing::step(Vec3& x, double& quality) {
  const Vec3 up = direction(x, quality);
  const double slope = up.norm();
  if (slope == 0) return false;
  double length = kFirstStep * shortest_edge(x);
  for (int k = 0; k < kHalvings; ++k, length *= 0.5) {
    const Vec3 to = placed(x + (length / slope) * up);
    const double limit = std::min(quality + kPromiseKept * length * slope, worthwhile(quality));
    const double reached = quality_at(to, limit);
    if (reached <= limit || (slides_ && !slide_->keeps(node_, to, distances()))) continue;
    x = to;
    quality = reached;
    return true;
  }
  return false;
}

/// Those of the node before it moved, found when they are first asked for.
const BoundarySlide::Distances& NodeSmoothing::distances() {
  if (!distances_) distances_ = slide_->distances(node_);
  return *distances_;
}

bool NodeSmoothing::improve(Index node) {
  slides_ = on_boundary_[static_cast<std::size_t>(node)];
  if (slides_ && slide_ == nullptr) return false;
  gather(node);
  if (slides_) normal_ = slide_->normal(node);
  distances_.reset();
  Vec3 x = tets_.position(node);
  double before = std::numeric_limits<double>::max();
  for (const Index e : tets_.star(node)) before = std::min(before, tets_.quality(e));
  double quality = before;
  for (int k = 0; k < kSteps && step(x, quality); ++k) continue;
  if (quality <= worthwhile(before)) return false;
  tets_.move(node, x);
  if (slides_) slide_->moved(node);
  return true;
}

}  // namespace softreel
