#include "core/tetmesh/cells/embedded_lattice.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "core/base/check.h"
#include "core/base/number_table.h"
#include "core/mesh/disjoint_sets.h"
#include "core/tetmesh/cells/cell_parts.h"

namespace softreel {
namespace {

constexpr std::int64_t kCellGrain = 64;

/// How many cells in a row parts may be made one in; three cells make about an edge.
constexpr int kMergeRounds = 4;

/// A lattice tetrahedron of the cover: its triangles and its copies, one for each of its parts.
struct CoverCell {
  BccCell cell;
  std::uint64_t order = 0;    ///< along the lattice
  Index cuts = 0, count = 0;  ///< its cuts [cuts, cuts + count)
  Index first_copy = 0, copies = 0;
  std::array<Index, 4> corner_parts{};  ///< CellParts::corners

  /// The copy that is inside at corner k, -1 if none is.
  Index corner_copy(std::size_t k) const { return corner_parts[k] < 0 ? -1 : first_copy + corner_parts[k]; }

  /// Its own of things that there are one of for each cut.
  template <typename OfCuts>
  auto own(OfCuts& of_cuts) const {
    return std::span(of_cuts).subspan(at(cuts), at(count));
  }
};

/// Cells, copies and nodes on their way to a mesh.
class Cover {
 public:
  Cover(const LatticeSurface& surface, const SurfaceMesh& mesh, const Threads& threads)
      : surface_(surface), cuts_(cut_cells(surface, threads)), inside_(std::in_place, surface, mesh, threads) {
    find_cells();
    find_parts(threads);
    inside_.reset();  // its tree is as large as all that follows
  }

  EmbeddedLattice make(std::span<const CarriedPoint> points) {
    DisjointSets nodes = join_copies();
    merge_short_branches(nodes);
    EmbeddedLattice result;
    result.branches = static_cast<Index>(copies_with_a_common_face(nodes).size());
    result.mesh.lattice = surface_.frame;
    const std::vector<Index> elements = make_elements(nodes, result.mesh);
    result.mesh.carriers = find_carriers(elements, points);
    for (const CoverCell& cell : cells_) result.cut_cells += cell.count > 0 ? 1 : 0;
    result.copies = static_cast<Index>(result.mesh.tets.size() - cells_.size());
    return result;
  }

 private:
  Index copies() const { return cells_.empty() ? 0 : cells_.back().first_copy + cells_.back().copies; }

  Index find_cell(const BccCell& cell) const {
    return table_.find(cell_key(cell), [&](Index number) { return cells_[at(number)].cell == cell; });
  }
  void list_cell(std::size_t number) {
    table_.insert(static_cast<Index>(number), [&](Index n) { return cell_key(cells_[at(n)].cell); });
  }

  /// Cells with triangles, and those between them that have a corner inside.
  void find_cells() {
    reserve_cells();
    for (std::size_t begin = 0, end = 0; begin < cuts_.size(); begin = end) {
      while (end < cuts_.size() && cuts_[end].cell == cuts_[begin].cell) ++end;
      add_cell(cell_of_key(cuts_[begin].cell), static_cast<Index>(begin), static_cast<Index>(end - begin));
    }
    for (const LatticeNode& node : inside_->nodes()) {
      // Without a triangle all corners of a cell are inside, cube centres too; but round an open surface any may be.
      if (surface_.closed && (node[0] & 1) == 0) continue;
      for (const BccCell& cell : cells_around(node)) add_cell(cell, 0, 0);
    }
    lattice_nodes_.number_nodes();
    for (CoverCell& cell : cells_)
      cell.order = kCellTypes * static_cast<std::uint64_t>(lattice_nodes_.find(cell.cell.center)) + cell.cell.type;
    std::sort(cells_.begin(), cells_.end(), [](const CoverCell& a, const CoverCell& b) { return a.order < b.order; });
    table_.clear();
    for (std::size_t c = 0; c < cells_.size(); ++c) list_cell(c);
  }

  /// A closed surface has at most this many cells: both centres of those without a triangle are inside, and there are
  /// 24 cells round a centre.
  void reserve_cells() {
    if (!surface_.closed) return;
    std::size_t count = 0;
    for (std::size_t i = 0; i < cuts_.size(); ++i) count += i == 0 || cuts_[i].cell != cuts_[i - 1].cell ? 1 : 0;
    for (const LatticeNode& node : inside_->nodes()) count += (node[0] & 1) != 0 ? 12 : 0;
    cells_.reserve(count);
  }

  void add_cell(const BccCell& cell, Index cuts, Index count) {
    if (find_cell(cell) >= 0) return;
    cells_.push_back({cell, 0, cuts, count, 0, 0, {}});
    list_cell(cells_.size() - 1);
    for (const LatticeNode& corner : cell_corners(cell)) lattice_nodes_.insert(corner);
  }

  void find_parts(const Threads& threads) {
    cut_copies_.resize(cuts_.size());
    const auto n = static_cast<std::int64_t>(cells_.size());
    std::vector<std::vector<double>> chunks(static_cast<std::size_t>((n + kCellGrain - 1) / kCellGrain));
    threads.for_chunks(n, kCellGrain, [&](std::int64_t begin, std::int64_t end) {
      std::vector<double>& fills = chunks[static_cast<std::size_t>(begin / kCellGrain)];
      for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c) {
        CoverCell& cell = cells_[c];
        const CellParts parts =
            find_cell_parts(surface_, *inside_, cell.cell, cell.own(std::as_const(cuts_)), cell.own(cut_copies_));
        cell.corner_parts = parts.corners;
        cell.copies = parts.count;
        fills.insert(fills.end(), parts.fills.begin(), parts.fills.end());
      }
    });
    Index first = 0;
    for (CoverCell& cell : cells_) {
      cell.first_copy = first;
      first += cell.copies;
      for (Index& copy : cell.own(cut_copies_)) copy += cell.first_copy;
    }
    fills_.reserve(at(first));
    for (const std::vector<double>& fills : chunks) fills_.insert(fills_.end(), fills.begin(), fills.end());
    CHECK(fills_.size() == at(first));
  }

  /// Sets of (copy, corner) that are one node.
  DisjointSets join_copies() const {
    DisjointSets nodes(4 * at(copies()));
    for (std::size_t c = 0; c < cells_.size(); ++c)
      for (std::size_t face = 0; face < 4; ++face) {
        const CellNeighbor neighbor = cell_neighbor(cells_[c].cell, face);
        const Index other = find_cell(neighbor.cell);
        if (other > static_cast<Index>(c)) join_across(cells_[c], cells_[at(other)], face, neighbor, nodes);
      }
    return nodes;
  }

  void join_across(const CoverCell& a, const CoverCell& b, std::size_t face, const CellNeighbor& neighbor,
                   DisjointSets& nodes) const {
    const auto join = [&](Index copy_a, Index copy_b) {
      for (std::size_t k = 0; k < 4; ++k)
        if (k != face) nodes.join(4 * copy_a + static_cast<Index>(k), 4 * copy_b + neighbor.corner[k]);
    };
    for (std::size_t k = 0; k < 4; ++k)
      if (k != face && a.corner_copy(k) >= 0 && b.corner_copy(neighbor.corner[k]) >= 0)
        join(a.corner_copy(k), b.corner_copy(neighbor.corner[k]));
    // Triangles that pass through the face, as either of the two sees it; both lists ascend.
    for (std::size_t i = at(a.cuts), j = at(b.cuts); i < at(a.cuts + a.count) && j < at(b.cuts + b.count);) {
      const Index t = cuts_[i].triangle, u = cuts_[j].triangle;
      if (t == u && (((cuts_[i].faces >> face) & 1) != 0 || ((cuts_[j].faces >> neighbor.face) & 1) != 0))
        join(cut_copies_[i], cut_copies_[j]);
      i += t <= u ? 1 : 0;
      j += u <= t ? 1 : 0;
    }
  }

  /// Two copies of one cell that have come to share a face, and their corner opposite it.
  struct FacePair {
    Index a, b;
    std::size_t corner;
  };

  /// Of more than two copies at one face each is paired with the next one: that links them as well as all pairs would.
  std::vector<FacePair> copies_with_a_common_face(DisjointSets& nodes) const {
    std::vector<FacePair> pairs;
    std::vector<std::pair<Tet, Index>> faces;  // roots, the one opposite the face last; the copy
    for (const CoverCell& cell : cells_) {
      if (cell.copies < 2) continue;
      for (std::size_t apart = 0; apart < 4; ++apart) {
        faces.clear();
        for (Index copy = cell.first_copy; copy < cell.first_copy + cell.copies; ++copy) {
          Tet roots = roots_of(copy, nodes);
          std::swap(roots[apart], roots[3]);
          faces.emplace_back(roots, copy);
        }
        std::sort(faces.begin(), faces.end());
        for (std::size_t i = 1; i < faces.size(); ++i) {
          const auto& [p, a] = faces[i - 1];
          const auto& [q, b] = faces[i];
          if (std::equal(p.begin(), p.begin() + 3, q.begin()) && p[3] != q[3])
            pairs.push_back({std::min(a, b), std::max(a, b), apart});
        }
      }
    }
    return pairs;
  }

  static Tet roots_of(Index copy, DisjointSets& nodes) {
    Tet roots;
    for (std::size_t k = 0; k < 4; ++k) roots[k] = nodes.root(4 * copy + static_cast<Index>(k));
    return roots;
  }

  static void merge(const FacePair& pair, DisjointSets& nodes) {
    const auto k = static_cast<Index>(pair.corner);
    nodes.join(4 * pair.a + k, 4 * pair.b + k);
  }

  /// Three elements at one face are no manifold. Where parts are two in one cell only, or in a few, as beside a crease
  /// that dips through a cell, they become one element there. Where that would run on along them, as with fingers,
  /// they are left as they are.
  void merge_short_branches(DisjointSets& nodes) const {
    std::vector<FacePair> pairs = copies_with_a_common_face(nodes), all;
    if (pairs.empty()) return;
    DisjointSets merged = nodes;
    for (int round = 0; round < kMergeRounds && !pairs.empty(); ++round) {
      for (const FacePair& pair : pairs) merge(pair, merged);
      all.insert(all.end(), pairs.begin(), pairs.end());
      pairs = copies_with_a_common_face(merged);
    }
    const std::size_t done = all.size();
    all.insert(all.end(), pairs.begin(), pairs.end());  // what would have to go on
    DisjointSets chains = chain_pairs(all, merged);
    std::vector<bool> endless(all.size(), false);
    for (std::size_t i = done; i < all.size(); ++i) endless[at(chains.root(static_cast<Index>(i)))] = true;
    for (std::size_t i = 0; i < done; ++i)
      if (!endless[at(chains.root(static_cast<Index>(i)))]) merge(all[i], nodes);
  }

  /// Sets of pairs one of which led to the next: by the node that it made one.
  static DisjointSets chain_pairs(const std::vector<FacePair>& pairs, DisjointSets& merged) {
    std::vector<std::pair<Index, Index>> made;  // node, pair
    for (std::size_t i = 0; i < pairs.size(); ++i)
      made.emplace_back(merged.root(4 * pairs[i].a + static_cast<Index>(pairs[i].corner)), static_cast<Index>(i));
    std::sort(made.begin(), made.end());
    DisjointSets chains(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i)
      for (const Index copy : {pairs[i].a, pairs[i].b})
        for (Index k = 0; k < 4; ++k) {
          const Index node = merged.root(4 * copy + k);
          for (auto m = std::lower_bound(made.begin(), made.end(), std::pair(node, Index{0}));
               m != made.end() && m->first == node; ++m)
            chains.join(static_cast<Index>(i), m->second);
        }
    return chains;
  }

  /// Numbers the nodes along the lattice and makes the elements; copies of one cell with the same nodes are one.
  /// Returns the element of each copy.
  std::vector<Index> make_elements(DisjointSets& nodes, TetMesh& mesh) const {
    const std::vector<Index> number = number_nodes(nodes, mesh);
    std::vector<Index> elements(at(copies()));
    mesh.tets.reserve(elements.size());
    mesh.fill.reserve(elements.size());
    std::map<Tet, Index> own;  // elements of a cell
    for (const CoverCell& cell : cells_) {
      own.clear();
      for (Index copy = cell.first_copy; copy < cell.first_copy + cell.copies; ++copy) {
        Tet tet = roots_of(copy, nodes);
        for (Index& node : tet) node = number[at(node)];
        const auto next = static_cast<Index>(mesh.tets.size());
        const Index element = cell.copies == 1 ? next : own.emplace(tet, next).first->second;
        elements[at(copy)] = element;
        if (element == next) {
          mesh.tets.push_back(tet);
          mesh.fill.push_back(0);
        }
        mesh.fill[at(element)] += fills_[at(copy)];
      }
    }
    for (double& fill : mesh.fill) fill = std::clamp(fill, kLeastFill, 1.0);
    return elements;
  }

  /// Numbers of the roots, in the order of the lattice's nodes, then of the copies.
  std::vector<Index> number_nodes(DisjointSets& nodes, TetMesh& mesh) const {
    std::vector<std::pair<Index, Index>> roots;  // lattice node, root
    for (const CoverCell& cell : cells_) {
      const std::array<LatticeNode, 4> corners = cell_corners(cell.cell);
      for (Index part = 0; part < cell.copies; ++part)
        for (std::size_t k = 0; k < 4; ++k) {
          const Index item = 4 * (cell.first_copy + part) + static_cast<Index>(k);
          if (nodes.root(item) == item) roots.emplace_back(lattice_nodes_.find(corners[k]), item);
        }
    }
    std::sort(roots.begin(), roots.end());
    std::vector<Index> number(4 * at(copies()), -1);
    mesh.nodes.reserve(roots.size());
    for (const auto& [lattice_node, root] : roots) {
      number[at(root)] = static_cast<Index>(mesh.nodes.size());
      mesh.nodes.push_back(lattice_position(surface_.frame, lattice_nodes_.nodes()[at(lattice_node)]));
    }
    return number;
  }

  /// Per vertex of the surface the first element that holds it in a copy of its own part, -1 for one without triangles.
  std::vector<Index> vertex_elements(const std::vector<Index>& elements) const {
    std::vector<Index> result(surface_.points.size(), -1);
    for (std::size_t i = 0; i < cuts_.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        if (((cuts_[i].points >> k) & 1) == 0) continue;
        Index& found = result[at(surface_.triangles[at(cuts_[i].triangle)][k])];
        const Index element = elements[at(cut_copies_[i])];
        if (found < 0 || element < found) found = element;
      }
    return result;
  }

  /// Per point its element, -1 outside all of them.
  std::vector<Index> find_carriers(const std::vector<Index>& elements, std::span<const CarriedPoint> points) const {
    const std::vector<Index> vertices = vertex_elements(elements);
    std::vector<Index> carriers(points.size(), -1);
    std::vector<std::pair<Index, std::size_t>> shared;  // cells of several copies, and the points found by place there
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].vertex >= 0) {
        carriers[i] = vertices[at(points[i].vertex)];
        continue;
      }
      const Index number = find_cell_round(place_of(points[i]));
      if (number < 0) continue;
      if (cells_[at(number)].copies == 1)
        carriers[i] = elements[at(cells_[at(number)].first_copy)];
      else
        shared.emplace_back(number, i);
    }
    std::sort(shared.begin(), shared.end());
    for (std::size_t begin = 0, end = 0; begin < shared.size(); begin = end) {
      std::vector<Vec3> places;
      for (; end < shared.size() && shared[end].first == shared[begin].first; ++end)
        places.push_back(place_of(points[shared[end].second]));
      const CoverCell& cell = cells_[at(shared[begin].first)];
      const std::vector<std::size_t> nearest = nearest_cuts_in_cell(surface_, cell.cell, cell.own(cuts_), places);
      for (std::size_t k = 0; k < nearest.size(); ++k)
        carriers[shared[begin + k].second] = elements[at(cut_copies_[at(cell.cuts) + nearest[k]])];
    }
    return carriers;
  }

  /// Lattice units.
  Vec3 place_of(const CarriedPoint& point) const {
    return (point.position - surface_.frame.origin) * (2.0 / surface_.frame.spacing);
  }

  /// The cell of the cover that holds a place, -1 if there is none.
  Index find_cell_round(const Vec3& place) const {
    if (!place.allFinite() || place.cwiseAbs().maxCoeff() >= kMaxLatticeCoordinate) return -1;
    return find_cell(cell_at(place));
  }

  const LatticeSurface& surface_;
  std::vector<CellCut> cuts_;
  std::optional<SolidInside> inside_;  ///< until the parts are found
  std::vector<Index> cut_copies_;      ///< per cut: the copy it is in (first its part within the cell)
  std::vector<CoverCell> cells_;       ///< along the lattice
  std::vector<double> fills_;          ///< per copy: its share of the cell's volume
  NumberTable table_;                  ///< of cells, by cell_key
  LatticeNodeSet lattice_nodes_;
};

}  // namespace

EmbeddedLattice cover_with_lattice(const SurfaceMesh& surface, const SurfaceParts& parts, const LatticeFrame& frame,
                                   std::span<const CarriedPoint> points, const Threads& threads) {
  const LatticeSurface lattice_surface = make_lattice_surface(surface, parts, frame);
  Cover cover(lattice_surface, surface, threads);
  return cover.make(points);
}

EmbeddedFacts describe_embedded(const TetMesh& mesh) {
  EmbeddedFacts facts;
  std::vector<std::array<double, 3>> places;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    std::array<Vec3, 4> x;
    for (std::size_t k = 0; k < 4; ++k) x[k] = mesh.nodes[at(mesh.tets[e][k])];
    const Vec3 sum = x[0] + x[1] + x[2] + x[3];
    places.push_back({sum[0], sum[1], sum[2]});
    facts.cell_volume += tet_volume(x[0], x[1], x[2], x[3]);
    facts.cut_cells += mesh.fill_of(e) < 1 ? 1 : 0;
  }
  std::sort(places.begin(), places.end());
  facts.copies = static_cast<Index>(places.end() - std::unique(places.begin(), places.end()));
  return facts;
}

}  // namespace softreel
