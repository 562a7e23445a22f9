#include "core/mesh/shell_nesting.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/mesh/box_tree.h"
#include "core/mesh/mesh_topology.h"
#include "core/mesh/winding_number.h"

namespace softreel {
namespace {

struct Shell {
  Index piece;
  std::vector<Triangle> triangles;
  Bounds bounds;
  double volume6 = 0;
  bool wanted_outward = true;
};

/// The pieces that are closed, or those that are not.
std::vector<Shell> collect_shells(const SurfaceMesh& mesh, const std::vector<Index>& piece,
                                  const std::vector<char>& closed, bool wants_closed) {
  std::vector<Shell> shells;
  std::vector<Index> shell_of(closed.size(), -1);
  for (std::size_t p = 0; p < closed.size(); ++p) {
    if ((closed[p] != 0) != wants_closed) continue;
    shell_of[p] = static_cast<Index>(shells.size());
    shells.push_back({static_cast<Index>(p), {}, {}});
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Index s = shell_of[static_cast<std::size_t>(piece[t])];
    if (s < 0) continue;
    Shell& shell = shells[static_cast<std::size_t>(s)];
    shell.triangles.push_back(mesh.triangles[t]);
    for (const Index v : mesh.triangles[t]) shell.bounds.add(mesh.positions[static_cast<std::size_t>(v)]);
  }
  for (Shell& shell : shells) {
    const Vec3 center = shell.bounds.center();
    const auto at = [&](Index v) -> Vec3 { return mesh.positions[static_cast<std::size_t>(v)] - center; };
    for (const Triangle& t : shell.triangles) shell.volume6 += signed_volume6(at(t[0]), at(t[1]), at(t[2]));
  }
  return shells;
}

/// Direction of all rays, one that no modelled face or edge has, and two across it.
const Vec3 kAlong = Vec3(0.5377, 0.2361, 0.8093).normalized(), kAcross = kAlong.unitOrthogonal(),
           kAside = kAlong.cross(kAcross);

using Corners = std::array<Vec3, 3>;

/// Whether a ray along z from the origin crosses a triangle, given in the coordinates kAcross, kAside, kAlong.
bool is_crossed(const Corners& p) {
  std::array<double, 3> w;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
    w[k] = a.x() * b.y() - a.y() * b.x();
  }
  const bool left = w[0] >= 0 && w[1] >= 0 && w[2] >= 0, right = w[0] < 0 && w[1] < 0 && w[2] < 0;
  const double sum = w[0] + w[1] + w[2];
  return (left || right) && sum != 0 && (w[0] * p[0].z() + w[1] * p[1].z() + w[2] * p[2].z()) / sum > 0;
}

/// A shell's triangles in slices across the rays, so that a ray meets only those of its own slice.
class SlicedShell {
 public:
  SlicedShell(const SurfaceMesh& mesh, const Shell& shell) : mesh_(mesh), shell_(shell) {
    center_ = shell.bounds.center();
    reach_ = (0.5 + 1e-9) * shell.bounds.diagonal();
    // As many slices as leave a triangle in four of them on average.
    double sum = 0;
    for (const Triangle& t : shell.triangles) {
      const auto [low, high] = span_of(t);
      sum += high - low;
    }
    const auto count = static_cast<double>(shell.triangles.size());
    const double most = sum > 0 ? 3 * count * 2 * reach_ / sum : 1;
    slices_.resize(std::isfinite(most) ? static_cast<std::size_t>(std::clamp(most, 1.0, count)) : 1);
    for (std::size_t i = 0; i < shell.triangles.size(); ++i) {
      const auto [low, high] = span_of(shell.triangles[i]);
      for (std::size_t s = slice_at(low), last = slice_at(high); s <= last; ++s)
        slices_[s].push_back(static_cast<Index>(i));
    }
  }

  /// Parity of the crossings of a ray from a point within the shell's box.
  bool is_inside(const Vec3& from) const {
    bool inside = false;
    for (const Index i : slices_[slice_at(kAside.dot(from - center_))]) {
      Corners p;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 d =
            mesh_.positions[static_cast<std::size_t>(shell_.triangles[static_cast<std::size_t>(i)][k])] - from;
        p[k] = Vec3(kAcross.dot(d), kAside.dot(d), kAlong.dot(d));
      }
      if (is_crossed(p)) inside = !inside;
    }
    return inside;
  }

 private:
  /// A triangle's extent along kAside, with a margin for rounding.
  std::pair<double, double> span_of(const Triangle& t) const {
    double low = 1e300, high = -1e300;
    for (const Index v : t) {
      const double at = kAside.dot(mesh_.positions[static_cast<std::size_t>(v)] - center_);
      low = std::min(low, at);
      high = std::max(high, at);
    }
    return {low - 1e-9 * reach_, high + 1e-9 * reach_};
  }

  std::size_t slice_at(double aside) const {
    const double share = reach_ > 0 ? 0.5 * (aside / reach_ + 1) : 0;
    if (!(share > 0)) return 0;
    const auto last = static_cast<double>(slices_.size() - 1);
    return static_cast<std::size_t>(std::min(share * static_cast<double>(slices_.size()), last));
  }

  const SurfaceMesh& mesh_;
  const Shell& shell_;
  Vec3 center_;
  double reach_ = 0;
  std::vector<std::vector<Index>> slices_;
};

/// A shell is inside of something if most of three points spread over it are.
template <typename IsInside>
bool is_shell_inside(const SurfaceMesh& mesh, const Shell& inner, const IsInside& is_inside) {
  const auto is_triangle_inside = [&](std::size_t t) {
    Vec3 centroid = Vec3::Zero();
    for (const Index v : inner.triangles[t]) centroid += mesh.positions[static_cast<std::size_t>(v)] / 3;
    return is_inside(centroid);
  };
  const std::size_t count = inner.triangles.size();
  const bool first = is_triangle_inside(0), middle = is_triangle_inside(count / 2);
  return first == middle ? first : is_triangle_inside(count - 1);
}

std::vector<Bounds> boxes_of(const std::vector<Shell>& shells) {
  std::vector<Bounds> boxes;
  for (const Shell& shell : shells) boxes.push_back(shell.bounds);
  return boxes;
}

/// The closed pieces, and which of them is the innermost round another.
class ClosedShells {
 public:
  /// shells: larger ones first, so that a container comes before what it contains.
  ClosedShells(const SurfaceMesh& mesh, const std::vector<Shell>& shells)
      : mesh_(mesh), shells_(shells), tree_(boxes_of(shells)), sliced_(shells.size()) {}

  /// The last container before shell s; -1: none.
  Index find_around(std::size_t s) {
    return tree_.find_last_around(shells_[s].bounds, static_cast<Index>(s), [&](Index outer) {
      std::unique_ptr<SlicedShell>& slices = sliced_[static_cast<std::size_t>(outer)];
      if (slices == nullptr) slices = std::make_unique<SlicedShell>(mesh_, shells_[static_cast<std::size_t>(outer)]);
      return is_shell_inside(mesh_, shells_[s], [&](const Vec3& p) { return slices->is_inside(p); });
    });
  }

 private:
  const SurfaceMesh& mesh_;
  const std::vector<Shell>& shells_;
  BoxTree tree_;
  std::vector<std::unique_ptr<SlicedShell>> sliced_;  ///< once something lies in their box
};

/// The pieces with holes, for what lies inside of one of them: a ray may leave through a hole, so that winding numbers
/// tell, not parities.
class OpenShells {
 public:
  OpenShells(const SurfaceMesh& mesh, std::vector<Shell> shells)
      : mesh_(mesh), shells_(by_size(std::move(shells))), tree_(boxes_of(shells_)), windings_(shells_.size()) {}

  /// Whether one goes round a closed shell that does not go round `around` too, the closed one next to it (null: there
  /// is none).
  bool go_round(const Shell& inner, const Shell* around) {
    int asked = 0;
    const Index found = tree_.find_last_around(inner.bounds, static_cast<Index>(shells_.size()), [&](Index outer) {
      const Shell& shell = shells_[static_cast<std::size_t>(outer)];
      if (++asked > kMostAsked) return true;
      return (around == nullptr || BoxTree::contains(around->bounds, shell.bounds)) && goes_round(outer, inner);
    });
    return found >= 0 && asked <= kMostAsked;
  }

 private:
  /// So many of the open pieces whose boxes a shell lies in are asked, the largest first: enough of heads and clothes,
  /// and no more work if ten thousand blades of grass bend over each other.
  static constexpr int kMostAsked = 32;

  static std::vector<Shell> by_size(std::vector<Shell> shells) {
    std::stable_sort(shells.begin(), shells.end(),
                     [](const Shell& a, const Shell& b) { return a.bounds.diagonal() < b.bounds.diagonal(); });
    return shells;
  }

  bool goes_round(Index outer, const Shell& inner) {
    std::unique_ptr<WindingNumber>& winding = windings_[static_cast<std::size_t>(outer)];
    if (winding == nullptr) winding = make_winding(shells_[static_cast<std::size_t>(outer)]);
    return is_shell_inside(mesh_, inner, [&](const Vec3& p) { return std::abs((*winding)(p)) > 0.5; });
  }

  /// Of its own corners only: the tables of many pieces are not to have the size of the mesh.
  std::unique_ptr<WindingNumber> make_winding(const Shell& shell) const {
    std::vector<Vec3> corners;
    std::vector<Triangle> triangles;
    for (const Triangle& t : shell.triangles) {
      const auto first = static_cast<Index>(corners.size());
      for (const Index v : t) corners.push_back(mesh_.positions[static_cast<std::size_t>(v)]);
      triangles.push_back({first, first + 1, first + 2});
    }
    return std::make_unique<WindingNumber>(corners, triangles);
  }

  const SurfaceMesh& mesh_;
  std::vector<Shell> shells_;  ///< smaller ones first: the last one is asked first
  BoxTree tree_;
  std::vector<std::unique_ptr<WindingNumber>> windings_;  ///< once something lies in their box
};

}  // namespace

std::vector<char> find_inverted_shells(const SurfaceMesh& mesh, const std::vector<Index>& piece,
                                       const std::vector<char>& closed) {
  std::vector<Shell> shells = collect_shells(mesh, piece, closed, true);
  std::stable_sort(shells.begin(), shells.end(),
                   [](const Shell& a, const Shell& b) { return std::abs(a.volume6) > std::abs(b.volume6); });
  ClosedShells closed_shells(mesh, shells);
  std::unique_ptr<OpenShells> open_shells;  // once a shell is to be turned
  std::vector<char> inverted(closed.size(), 0);
  for (std::size_t s = 0; s < shells.size(); ++s) {
    Shell& shell = shells[s];
    const bool is_outward = shell.volume6 > 0;
    const Index around = closed_shells.find_around(s);
    const Shell* outer = around >= 0 ? &shells[static_cast<std::size_t>(around)] : nullptr;
    if (outer != nullptr) shell.wanted_outward = outer->wanted_outward == ((outer->volume6 > 0) == is_outward);
    if (shell.volume6 == 0 || is_outward == shell.wanted_outward) continue;
    if (open_shells == nullptr)
      open_shells = std::make_unique<OpenShells>(mesh, collect_shells(mesh, piece, closed, false));
    if (open_shells->go_round(shell, outer))
      shell.wanted_outward = is_outward;  // what is open is not turned: nor is what lies in it, so that both stay alike
    else
      inverted[static_cast<std::size_t>(shell.piece)] = 1;
  }
  return inverted;
}

}  // namespace softreel
