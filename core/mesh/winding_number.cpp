#include "core/mesh/winding_number.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/mesh/mesh_topology.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {
namespace {

/// A cluster is far beyond this multiple of its radius (beta of the paper, which recommends 2).
constexpr double kAccuracy = 2.0;

/// Half the solid angle of a triangle seen from the origin; positive if its front faces away from it.
double half_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

/// Sums half solid angles without an arc tangent for each: as arguments of products of complex numbers, whose turns are
/// counted. Triangles are gathered, and taken four at a time.
class AngleSum {
 public:
  /// Corners as seen from the point.
  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    for (Index axis = 0; axis < 3; ++axis) {
      gathered_[at(axis)][count_] = a[axis];
      gathered_[at(3 + axis)][count_] = b[axis];
      gathered_[at(6 + axis)][count_] = c[axis];
    }
    if (++count_ == kGathered) flush();
  }

  void finish() {
    while (count_ % kLanes != 0) add(Vec3::UnitX(), Vec3::UnitX(), Vec3::UnitX());  // no angle
    flush();
  }

  /// False where rounding decides; sum() is meaningless then.
  bool is_certain() const { return is_certain_ && re_.isFinite().all() && im_.isFinite().all(); }

  double sum() const {
    double sum = 0;
    for (Index lane = 0; lane < static_cast<Index>(kLanes); ++lane)
      sum += std::atan2(im_[lane], re_[lane]) + 2 * std::numbers::pi * turns_[lane];
    return sum;
  }

 private:
  static constexpr double kOnTriangle = 1e-12;
  static constexpr std::size_t kLanes = 4, kGathered = 32;
  using Lanes = Eigen::Array<double, kLanes, 1>;
  using Lanes3 = std::array<Lanes, 3>;

  static Lanes dot(const Lanes3& x, const Lanes3& y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; }

  void flush() {
    const auto lanes_of = [&](std::size_t first, std::size_t i) {
      Lanes3 x;
      for (std::size_t axis = 0; axis < 3; ++axis)
        x[axis] = Eigen::Map<const Lanes, Eigen::AlignedMax>(&gathered_[first + axis][i]);
      return x;
    };
    for (std::size_t i = 0; i < count_; i += kLanes) multiply(lanes_of(0, i), lanes_of(3, i), lanes_of(6, i));
    count_ = 0;
  }

  void multiply(const Lanes3& a, const Lanes3& b, const Lanes3& c) {
    const Lanes la = dot(a, a).sqrt(), lb = dot(b, b).sqrt(), lc = dot(c, c).sqrt();
    const Lanes im =
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    const Lanes re = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    // On a triangle, or at a corner, its angle may be half a turn either way.
    is_certain_ = is_certain_ && (im.abs() > -kOnTriangle * re).all();
    const Lanes product_re = re_ * re - im_ * im, product_im = re_ * im + im_ * re + 0.0;  // -0 would be the other side
    turns_ += (im_ >= 0 && im >= 0 && product_im < 0).cast<double>();
    turns_ -= (im_ < 0 && im < 0 && product_im >= 0).cast<double>();
    const Lanes size = product_re.abs() + product_im.abs();
    re_ = product_re / size;
    im_ = product_im / size;
  }

  Lanes re_ = Lanes::Ones(), im_ = Lanes::Zero(), turns_ = Lanes::Zero();
  bool is_certain_ = true;
  alignas(64) std::array<std::array<double, kGathered>, 9> gathered_;  ///< by corner and axis
  std::size_t count_ = 0;
};

}  // namespace

WindingNumber::WindingNumber(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles)
    : clusters_(points, triangles), dipoles_(clusters_.nodes().size()) {
  std::vector<double> weights(dipoles_.size());
  for (std::size_t n = dipoles_.size(); n-- > 0;) {  // children come after their parents
    const TriangleClusters::Node& node = clusters_.nodes()[n];
    Vec3 area = Vec3::Zero(), moment = Vec3::Zero();
    double weight = 0;
    const auto add = [&](const Vec3& part_area, const Vec3& center, double part_weight) {
      area += part_area;
      moment += part_weight * center;
      weight += part_weight;
    };
    if (node.is_leaf()) {
      for (Index i = node.begin; i < node.end; ++i) {
        const auto& [a, b, c] = clusters_.corners(i);
        const Vec3 normal = 0.5 * (b - a).cross(c - a);
        add(normal, (a + b + c) / 3.0, normal.norm());
      }
    } else {
      for (const std::size_t child : {n + 1, static_cast<std::size_t>(node.right)})
        add(dipoles_[child].area, dipoles_[child].center, weights[child]);
    }
    const Vec3 center = weight > 0 ? Vec3(moment / weight) : Vec3(0.5 * (node.min + node.max));
    const double radius = (center - node.min).cwiseMax(node.max - center).norm();
    dipoles_[n] = {center, area, kAccuracy * kAccuracy * radius * radius, node.begin, node.end, node.right};
    weights[n] = weight;
  }
  clusters_.drop_nodes();
}

template <typename AddNear>
double WindingNumber::visit(const Vec3& p, const AddNear& add_near) const {
  if (dipoles_.empty()) return 0;
  std::array<Index, 64> stack;  // halving: depth at most 32
  std::size_t depth = 0;
  stack[depth++] = 0;
  double far = 0;
  while (depth > 0) {
    const auto n = static_cast<std::size_t>(stack[--depth]);
    const Dipole& dipole = dipoles_[n];
    const Vec3 r = dipole.center - p;
    const double squared = r.squaredNorm();
    if (squared > dipole.squared_reach) {
      far += dipole.area.dot(r) / (squared * std::sqrt(squared));
      continue;
    }
    if (dipole.right != 0) {
      stack[depth++] = dipole.right;
      stack[depth++] = static_cast<Index>(n) + 1;
      continue;
    }
    add_near(dipole);
  }
  return far;
}

double WindingNumber::operator()(const Vec3& p) const {
  double half_angles = 0;
  const double far = visit(p, [&](const Dipole& leaf) {
    for (Index i = leaf.begin; i < leaf.end; ++i) {
      const auto& [a, b, c] = clusters_.corners(i);
      half_angles += half_solid_angle(a - p, b - p, c - p);
    }
  });
  return (2.0 * half_angles + far) / (4.0 * std::numbers::pi);
}

double WindingNumber::quick(const Vec3& p) const {
  AngleSum half_angles;
  const double far = visit(p, [&](const Dipole& leaf) {
    for (Index i = leaf.begin; i < leaf.end; ++i) {
      const auto& [a, b, c] = clusters_.corners(i);
      half_angles.add(a - p, b - p, c - p);
    }
  });
  half_angles.finish();
  constexpr double kDoubt = 1e-9;
  const double winding = (2.0 * half_angles.sum() + far) / (4.0 * std::numbers::pi);
  return half_angles.is_certain() && std::abs(std::abs(winding) - 0.5) > kDoubt ? winding : (*this)(p);
}

bool has_integer_windings(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
  const std::vector<Triangle> welded = welded_triangles(triangles, weld_positions(positions));
  bool all_balanced = true;
  for_each_edge(sorted_half_edges(welded),
                [&](std::span<const HalfEdge> edge) { all_balanced = all_balanced && is_balanced(edge); });
  return all_balanced;
}

}  // namespace softreel
