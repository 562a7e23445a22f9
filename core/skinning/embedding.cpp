#include "core/skinning/embedding.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/tetmesh/key_index.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

using Weights = std::array<double, 4>;

constexpr std::int64_t kEmbeddingGrain = 512;
/// Round-off by which a weight may be negative in an element that holds the point.
constexpr double kInside = -1e-12;
/// Weights beyond this would magnify the deformation: such points go to the boundary (embedding.h).
constexpr double kMaxWeight = 2.0;
/// How many element sizes farther than the nearest face one that looks the point's way may be: across a gap of less
/// than an element, not across the body.
constexpr double kFacingReach = 2.0;

std::array<Vec3, 4> corners_of(const TetMesh& mesh, Index element) {
  std::array<Vec3, 4> x;
  for (std::size_t k = 0; k < 4; ++k) x[k] = mesh.nodes[at(mesh.tets[at(element)][k])];
  return x;
}

/// Barycentric weights by volumes relative to the point, so that they are exact near the nodes.
Weights barycentric(const std::array<Vec3, 4>& x, const Vec3& p) {
  const std::array<Vec3, 4> d{x[0] - p, x[1] - p, x[2] - p, x[3] - p};
  const double volume = (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]);
  Weights w;
  w[1] = d[0].dot(d[3].cross(d[2])) / volume;
  w[2] = d[0].dot(d[1].cross(d[3])) / volume;
  w[3] = d[0].dot(d[2].cross(d[1])) / volume;
  w[0] = 1.0 - w[1] - w[2] - w[3];
  return w;
}

/// Cubic cells that hold points to embed, and the points of each.
class PointGrid {
 public:
  PointGrid(const std::vector<Vec3>& points, const Vec3& origin, double cell) : origin_(origin), cell_(cell) {
    cells_of_points_.reserve(points.size());
    for (const Vec3& p : points) cells_of_points_.push_back(p.allFinite() ? cells_.insert(key(cell_of(p))).first : -1);
  }

  Index cell_of_point(std::size_t point) const { return cells_of_points_[point]; }
  Index size() const { return cells_.size(); }

  /// Calls visit(cell) for each cell with points that a box overlaps.
  template <typename Visit>
  void visit_box(const Vec3& min, const Vec3& max, const Visit& visit) const {
    const Cell low = cell_of(min), high = cell_of(max);
    for (std::int64_t z = low[2]; z <= high[2]; ++z)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t x = low[0]; x <= high[0]; ++x)
          if (const Index cell = cells_.find(key({x, y, z})); cell >= 0) visit(cell);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  Cell cell_of(const Vec3& p) const {
    Cell cell;
    for (int k = 0; k < 3; ++k)
      cell[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(std::floor((p[k] - origin_[k]) / cell_));
    return cell;
  }

  /// Injective for cells within +-2^20; cells that are farther apart may share a key, which costs time only.
  static std::uint64_t key(const Cell& cell) {
    constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
    const auto bits = [](std::int64_t x) { return static_cast<std::uint64_t>(x) & kMask; };
    return bits(cell[0]) << 42 | bits(cell[1]) << 21 | bits(cell[2]);
  }

  Vec3 origin_;
  double cell_;
  KeyIndex cells_;
  std::vector<Index> cells_of_points_;
};

/// Elements that may hold points, per cell of a grid, ascending.
struct CellElements {
  std::vector<Index> offsets, elements;
};

CellElements elements_of_cells(const TetMesh& mesh, const PointGrid& grid) {
  CellElements list;
  list.offsets.assign(at(grid.size()) + 1, 0);
  std::vector<std::pair<Index, Index>> pairs;
  for (Index e = 0; e < static_cast<Index>(mesh.tets.size()); ++e) {
    const auto [a, b, c, d] = corners_of(mesh, e);
    grid.visit_box(a.cwiseMin(b).cwiseMin(c.cwiseMin(d)), a.cwiseMax(b).cwiseMax(c.cwiseMax(d)), [&](Index cell) {
      pairs.emplace_back(cell, e);
      ++list.offsets[at(cell) + 1];
    });
  }
  for (std::size_t c = 1; c < list.offsets.size(); ++c) list.offsets[c] += list.offsets[c - 1];
  list.elements.resize(pairs.size());
  std::vector<Index> next(list.offsets.begin(), list.offsets.end() - 1);
  for (const auto& [cell, element] : pairs) list.elements[at(next[at(cell)]++)] = element;
  return list;
}

/// Boundary faces with their elements, outward normals and a tree over them.
struct Boundary {
  std::vector<BoundaryFace> faces;
  std::vector<Vec3> normals;
  TriangleTree tree;
};

std::vector<Triangle> triangles_of(const std::vector<BoundaryFace>& faces) {
  std::vector<Triangle> triangles;
  triangles.reserve(faces.size());
  for (const BoundaryFace& face : faces) triangles.push_back(face.nodes);
  return triangles;
}

Boundary make_boundary(const TetMesh& mesh) {
  std::vector<BoundaryFace> faces = find_boundary(mesh);
  const std::vector<Triangle> triangles = triangles_of(faces);
  std::vector<Vec3> normals;
  normals.reserve(faces.size());
  for (const auto& [a, b, c] : triangles) {
    const Vec3& x = mesh.nodes[at(a)];
    normals.push_back((mesh.nodes[at(b)] - x).cross(mesh.nodes[at(c)] - x).normalized());
  }
  return {std::move(faces), std::move(normals), TriangleTree(mesh.nodes, triangles)};
}

/// The nearest point of the boundary where it looks the point's way, but not more than `reach` farther than the nearest
/// of all, which serves where none looks that way (a spike, a wrong normal).
TriangleTree::Nearest nearest_facing(const Boundary& boundary, const Vec3& p, const Vec3& normal, double reach) {
  const TriangleTree::Nearest any = boundary.tree.nearest(p);
  const double limit = std::sqrt(any.squared_distance) + reach;
  const TriangleTree::Nearest facing = boundary.tree.nearest(
      p, limit * limit, [&](Index face, const Vec3& /*point*/) { return boundary.normals[at(face)].dot(normal) > 0; });
  return facing.triangle >= 0 ? facing : any;
}

bool is_bounded(const Weights& w) {
  return std::all_of(w.begin(), w.end(), [](double x) { return std::abs(x) <= kMaxWeight; });
}

/// Finds elements for points, one at a time.
class Embedder {
 public:
  Embedder(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const TetMesh& mesh)
      : points_(points),
        normals_(normals),
        mesh_(mesh),
        cell_(cell_size(mesh)),
        grid_(points, mesh.nodes.front(), cell_),
        candidates_(elements_of_cells(mesh, grid_)),
        boundary_(make_boundary(mesh)) {}

  void embed(std::size_t point, Index& element, Weights& weights) const {
    if (!points_[point].allFinite()) {
      element = 0;
      weights = {1, 0, 0, 0};
      return;
    }
    if (!mesh_.carriers.empty() && mesh_.carriers[point] >= 0) {
      element = mesh_.carriers[point];
      weights = barycentric(corners_of(mesh_, element), points_[point]);
      if (is_bounded(weights)) return;
    }
    if (find_inside(point, element, weights)) return;
    const TriangleTree::Nearest nearest =
        nearest_facing(boundary_, points_[point], normals_[point], kFacingReach * cell_);
    element = boundary_.faces[at(nearest.triangle)].element;
    weights = barycentric(corners_of(mesh_, element), points_[point]);
    if (!is_bounded(weights)) weights = barycentric(corners_of(mesh_, element), nearest.point);
  }

 private:
  /// Cells about as large as elements: of a lattice its spacing, else the edge of a cube of mean volume times two.
  static double cell_size(const TetMesh& mesh) {
    if (mesh.lattice.spacing > 0) return mesh.lattice.spacing;
    double volume = 0;
    for (const auto& [a, b, c, d] : mesh.tets)
      volume += tet_volume(mesh.nodes[at(a)], mesh.nodes[at(b)], mesh.nodes[at(c)], mesh.nodes[at(d)]);
    return 2.0 * std::cbrt(volume / static_cast<double>(mesh.tets.size()));
  }

  /// The lowest element that holds the point.
  bool find_inside(std::size_t point, Index& element, Weights& weights) const {
    const Index cell = grid_.cell_of_point(point);
    for (Index i = candidates_.offsets[at(cell)]; i < candidates_.offsets[at(cell) + 1]; ++i) {
      element = candidates_.elements[at(i)];
      weights = barycentric(corners_of(mesh_, element), points_[point]);
      if (std::all_of(weights.begin(), weights.end(), [](double w) { return w >= kInside; })) return true;
    }
    return false;
  }

  const std::vector<Vec3>& points_;
  const std::vector<Vec3>& normals_;
  const TetMesh& mesh_;
  double cell_;
  PointGrid grid_;
  CellElements candidates_;
  Boundary boundary_;
};

}  // namespace

Embedding embed_points(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const TetMesh& mesh,
                       const Threads& threads) {
  CHECK(points.size() == normals.size());
  CHECK(!mesh.tets.empty());
  if (!mesh.carriers.empty()) CHECK(mesh.carriers.size() == points.size());
  Embedding embedding;
  embedding.elements.resize(points.size());
  embedding.weights.resize(points.size());
  const Embedder embedder(points, normals, mesh);
  threads.for_chunks(static_cast<std::int64_t>(points.size()), kEmbeddingGrain,
                     [&](std::int64_t begin, std::int64_t end) {
                       for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
                         embedder.embed(i, embedding.elements[i], embedding.weights[i]);
                     });
  return embedding;
}

}  // namespace softreel
