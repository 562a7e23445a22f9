// Points that stand for parts of a surface: triangles larger than the spacing are cut, smaller ones gathered.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/constraints/carrier.h"
#include "core/constraints/glue.h"

namespace softreel {
namespace {

/// Cells that gather small pieces, in spacings: about four points for each face of a tetrahedron, as fewer leave the
/// two surfaces free to swing between them.
constexpr double kCell = 0.5;

/// Where the piece next to one corner of a triangle has its centre: the corner's weight.
constexpr double kCornerWeight = 11.0 / 18;

/// Triangles that rows of equal pieces would cut so many times finer than their area asks for are halved across their
/// longest edge instead: the strips of a tube.
constexpr double kThin = 16;

/// Surfaces that would need more are far larger than what they are glued to.
constexpr double kMostPieces = 2e7;

/// A piece of a triangle.
struct Piece {
  Vec3 center;
  double area = 0;
  Index corner = 0;  ///< vertex next to it
};

/// Pieces that one cell gathers; those of one cell that look different ways lie on different sides of a thin part, or
/// of an edge.
struct Cell {
  std::array<std::int64_t, 3> place;
  int side;  ///< of a cube that the pieces look out of
  auto operator<=>(const Cell&) const = default;
};

struct Gathered {
  Vec3 moment = Vec3::Zero();
  double area = 0, largest = 0;
  Index corner = 0;
};

class PieceGatherer {
 public:
  PieceGatherer(const std::vector<Vec3>& positions, const std::vector<Index>& selected, double spacing)
      : positions_(positions), selected_(positions.size(), 0), spacing_(spacing) {
    for (const Index vertex : selected) selected_[static_cast<std::size_t>(vertex)] = 1;
  }

  void add_triangle(const Triangle& triangle) {
    const auto is_selected = [&](std::size_t k) { return selected_[static_cast<std::size_t>(triangle[k])] != 0; };
    const int taken = is_selected(0) + is_selected(1) + is_selected(2);
    if (taken == 0) return;
    const auto corner = [&](std::size_t k) { return positions_[static_cast<std::size_t>(triangle[k])]; };
    const Vec3 a = corner(0), b = corner(1), c = corner(2), normal = (b - a).cross(c - a);
    const double area = 0.5 * normal.norm();
    if (!(area > 0)) return;
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    side_ = static_cast<int>(2 * axis) + (normal[axis] < 0 ? 1 : 0);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const double size = kCell * spacing_, wanted = std::ceil(longest / size);
    const double enough = 4 * (area / (size * size) + longest / size);
    const bool thin = wanted * wanted > kThin * enough;
    pieces_ += thin ? enough : wanted * wanted;
    if (!(pieces_ <= kMostPieces)) throw too_many();
    const auto cuts = static_cast<int>(std::min(wanted, kMostPieces));
    const auto add_at = [&](const Vec3& weights, double share) {
      Eigen::Index nearest = 0;
      weights.maxCoeff(&nearest);
      const auto k = static_cast<std::size_t>(nearest);
      if (is_selected(k)) add({weights[0] * a + weights[1] * b + weights[2] * c, share * area, triangle[k]});
    };
    if (cuts <= 1 && taken < 3) {
      const double other = (1 - kCornerWeight) / 2;
      for (int k = 0; k < 3; ++k) add_at(Vec3::Constant(other) + (kCornerWeight - other) * Vec3::Unit(k), 1.0 / 3);
      return;
    }
    if (thin) {
      const auto place = [&](const Vec3& weights) -> Vec3 { return weights[0] * a + weights[1] * b + weights[2] * c; };
      return halve({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}, 1.0, size, place, add_at);
    }
    // Rows of triangles parallel to an edge: (i, j) and its mirror image in the rhombus.
    const double share = 1.0 / (static_cast<double>(cuts) * cuts);
    for (int i = 0; i < cuts; ++i)
      for (int j = 0; i + j < cuts; ++j) {
        add_at(center_weights(i, j, 1.0 / 3, cuts), share);
        if (i + j + 1 < cuts) add_at(center_weights(i, j, 2.0 / 3, cuts), share);
      }
  }

  const std::map<Cell, Gathered>& cells() const { return cells_; }

 private:
  Error too_many() const {
    return input_error(fmt::format(
        "the selected surface would be cut into more than {:.0e} pieces of {:.3g} m, half an edge of the "
        "finer body's tetrahedra.\n  Accepted: a surface not so much larger. Select the part that sticks, or "
        "name the smaller body first.",
        kMostPieces, kCell * spacing_));
  }

  static Vec3 center_weights(int i, int j, double inside, int cuts) {
    const double second = (i + inside) / cuts, third = (j + inside) / cuts;
    return {1 - second - third, second, third};
  }

  /// Halves a part of a triangle, given by the weights of its corners, down to pieces of `size`.
  template <typename Place, typename Add>
  static void halve(const std::array<Vec3, 3>& part, double share, double size, const Place& place, const Add& add_at) {
    std::size_t longest = 0;
    std::array<double, 3> length{};
    for (std::size_t k = 0; k < 3; ++k) {
      length[k] = (place(part[(k + 1) % 3]) - place(part[k])).norm();
      if (length[k] > length[longest]) longest = k;
    }
    if (length[longest] <= size) return add_at((part[0] + part[1] + part[2]) / 3, share);
    const Vec3 &from = part[longest], &to = part[(longest + 1) % 3], &apex = part[(longest + 2) % 3];
    const Vec3 middle = 0.5 * (from + to);
    halve({from, middle, apex}, share / 2, size, place, add_at);
    halve({middle, to, apex}, share / 2, size, place, add_at);
  }

  void add(const Piece& piece) {
    Cell cell{{}, side_};
    for (int k = 0; k < 3; ++k)
      cell.place[static_cast<std::size_t>(k)] =
          static_cast<std::int64_t>(std::floor(piece.center[k] / (kCell * spacing_)));
    Gathered& gathered = cells_[cell];
    gathered.moment += piece.area * piece.center;
    gathered.area += piece.area;
    if (piece.area > gathered.largest) {
      gathered.largest = piece.area;
      gathered.corner = piece.corner;
    }
  }

  const std::vector<Vec3>& positions_;
  std::vector<std::uint8_t> selected_;
  double spacing_;
  double pieces_ = 0;
  int side_ = 0;
  std::map<Cell, Gathered> cells_;
};

}  // namespace

std::vector<GluePoint> make_glue_points(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                                        const std::vector<Index>& selected, const TetMesh& mesh,
                                        const Embedding& embedding, double spacing) {
  CHECK(spacing > 0);
  PieceGatherer gatherer(positions, selected, spacing);
  for (const Triangle& triangle : triangles) gatherer.add_triangle(triangle);
  const NodeElements node_elements = gather_node_elements(mesh.tets, static_cast<Index>(mesh.nodes.size()));
  const CarrierMesh rest{mesh.tets, node_elements, mesh.nodes, mesh.nodes};
  std::vector<GluePoint> points;
  for (const auto& [cell, gathered] : gatherer.cells()) {
    const Carrier carrier = walk_to_carrier(rest, embedding.elements[static_cast<std::size_t>(gathered.corner)], 0,
                                            static_cast<Index>(mesh.tets.size()), gathered.moment / gathered.area);
    points.push_back({carrier.element, carrier.weights, gathered.area});
  }
  return points;
}

}  // namespace softreel
