#include "core/tetmesh/stuffing/boundary_mending.h"

#include <algorithm>
#include <numeric>

#include "core/base/check.h"

namespace softreel {
namespace {

bool has(const Triangle& face, Index node) {
  return std::find(face.begin(), face.end(), node) != face.end();
}

bool has(const Tet& tet, Index node) {
  return std::find(tet.begin(), tet.end(), node) != tet.end();
}

/// Items of each node, as a compressed list.
struct NodeItems {
  std::vector<Index> offsets, items;

  std::pair<const Index*, const Index*> of(std::size_t node) const {
    return {items.data() + offsets[node], items.data() + offsets[node + 1]};
  }
};

template <typename NodesOf>
NodeItems items_of_nodes(std::size_t node_count, std::size_t item_count, const NodesOf& nodes_of) {
  NodeItems list;
  list.offsets.assign(node_count + 1, 0);
  for (std::size_t i = 0; i < item_count; ++i) nodes_of(i, [&](Index node) { ++list.offsets[at(node) + 1]; });
  std::partial_sum(list.offsets.begin(), list.offsets.end(), list.offsets.begin());
  list.items.resize(at(list.offsets.back()));
  std::vector<Index> next(list.offsets.begin(), list.offsets.end() - 1);
  for (std::size_t i = 0; i < item_count; ++i)
    nodes_of(i, [&](Index node) { list.items[at(next[at(node)]++)] = static_cast<Index>(i); });
  return list;
}

/// Groups a few items by a symmetric relation; groups are numbered by their first item.
template <typename Joined>
std::vector<Index> group_items(std::size_t count, const Joined& joined) {
  std::vector<Index> group(count, -1);
  Index groups = 0;
  std::vector<std::size_t> open;
  for (std::size_t first = 0; first < count; ++first) {
    if (group[first] >= 0) continue;
    group[first] = groups;
    open.assign(1, first);
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      for (std::size_t j = 0; j < count; ++j) {
        if (group[j] >= 0 || !joined(i, j)) continue;
        group[j] = groups;
        open.push_back(j);
      }
    }
    ++groups;
  }
  return group;
}

Index count_groups(const std::vector<Index>& group) {
  return group.empty() ? 0 : *std::max_element(group.begin(), group.end()) + 1;
}

/// Number of nodes that two elements share.
int shared_nodes(const Tet& a, const Tet& b) {
  int count = 0;
  for (const Index node : a) count += has(b, node) ? 1 : 0;
  return count;
}

/// The boundary as it stands, and where it is no manifold.
class BoundaryFans {
 public:
  explicit BoundaryFans(const StuffedMesh& stuffed)
      : faces(find_surface_faces(stuffed)),
        faces_of(items_of_nodes(stuffed.mesh.nodes.size(), faces.size(), [this](std::size_t i, const auto& visit) {
          for (const Index node : faces[i].nodes) visit(node);
        })) {
    for (std::size_t node = 0; node < stuffed.mesh.nodes.size(); ++node)
      if (!is_manifold(static_cast<Index>(node))) nodes.push_back(static_cast<Index>(node));
  }

  /// Boundary faces of a node, grouped across edges that two of them share.
  std::vector<Index> fans(Index node) const {
    const auto [begin, end] = faces_of.of(at(node));
    const Index* list = begin;
    return group_items(static_cast<std::size_t>(end - begin), [&](std::size_t i, std::size_t j) {
      const Index other = common_neighbor(node, list[i], list[j]);
      return other >= 0 && edge_faces(node, other) == 2;
    });
  }

  /// Number of boundary faces at an edge; a manifold has 2.
  int edge_faces(Index a, Index b) const {
    int count = 0;
    const auto [begin, end] = faces_of.of(at(a));
    for (const Index* f = begin; f != end; ++f) count += has(faces[at(*f)].nodes, b) ? 1 : 0;
    return count;
  }

  std::vector<BoundaryFace> faces;
  NodeItems faces_of;
  std::vector<Index> nodes;  ///< where the boundary is no manifold, ascending

 private:
  /// The node beside `node` that two faces share, -1 if they share none; -1 for a face and itself.
  Index common_neighbor(Index node, Index f, Index g) const {
    if (f == g) return -1;
    for (const Index other : faces[at(f)].nodes)
      if (other != node && has(faces[at(g)].nodes, other)) return other;
    return -1;
  }

  /// Walks round the node from face to face; a manifold is one closed fan.
  bool is_manifold(Index node) const {
    const auto [begin, end] = faces_of.of(at(node));
    const auto count = end - begin;
    if (count == 0) return true;
    const auto other_of = [&](Index f, Index not_this) {
      for (const Index other : faces[at(f)].nodes)
        if (other != node && other != not_this) return other;
      return Index{-1};
    };
    const Index start = other_of(*begin, -1);
    Index face = *begin, edge = other_of(face, start), walked = 1;
    while (edge != start) {
      Index next = -1;
      for (const Index* f = begin; f != end; ++f) {
        if (*f == face || !has(faces[at(*f)].nodes, edge)) continue;
        if (next >= 0) return false;
        next = *f;
      }
      CHECK(next >= 0);  // the boundary of elements has no open edge
      edge = other_of(next, edge);
      face = next;
      if (++walked > count) return false;
    }
    return walked == count && edge_faces(node, start) == 2;
  }
};

/// Mends the defects of one round.
class MendingRound {
 public:
  MendingRound(StuffedMesh& stuffed, const BoundaryFans& defects)
      : stuffed_(stuffed), defects_(defects), removed_(stuffed.mesh.tets.size(), false) {
    std::vector<bool> wanted(stuffed.mesh.nodes.size(), false);
    for (const Index node : defects.nodes) wanted[at(node)] = true;
    star_ = items_of_nodes(stuffed.mesh.nodes.size(), stuffed.mesh.tets.size(), [&](std::size_t e, const auto& visit) {
      for (const Index node : stuffed.mesh.tets[e])
        if (wanted[at(node)]) visit(node);
    });
  }

  BoundaryMending mend() {
    for (const Index node : defects_.nodes) copy_node(node);
    if (done_.copied_nodes > 0) return done_;
    for (const Index node : defects_.nodes) part_edges(node);
    for (const Index node : defects_.nodes) open_vertex(node);
    CHECK(done_.removed_tets > 0);
    drop_removed();
    return done_;
  }

 private:
  const Tet& tet(Index e) const { return stuffed_.mesh.tets[at(e)]; }

  /// One node per group of elements that are joined through faces at the node.
  void copy_node(Index node) {
    const auto [begin, end] = star_.of(at(node));
    const std::vector<Index> star(begin, end);
    const std::vector<Index> group = group_items(star.size(), [&](std::size_t i, std::size_t j) {
      return has(tet(star[i]), node) && shared_nodes(tet(star[i]), tet(star[j])) == 3;
    });
    const Index groups = count_groups(group);
    for (Index g = 1; g < groups; ++g) {
      const auto copy = static_cast<Index>(stuffed_.mesh.nodes.size());
      stuffed_.mesh.nodes.push_back(Vec3(stuffed_.mesh.nodes[at(node)]));
      stuffed_.lattice_nodes.push_back(Index(stuffed_.lattice_nodes[at(node)]));
      stuffed_.on_surface.push_back(1);
      for (std::size_t i = 0; i < star.size(); ++i)
        if (group[i] == g)
          std::replace(stuffed_.mesh.tets[at(star[i])].begin(), stuffed_.mesh.tets[at(star[i])].end(), node, copy);
      ++done_.copied_nodes;
    }
  }

  double volume(Index e) const {
    const auto& [a, b, c, d] = tet(e);
    const std::vector<Vec3>& x = stuffed_.mesh.nodes;
    return tet_volume(x[at(a)], x[at(b)], x[at(c)], x[at(d)]);
  }

  void remove(Index e) {
    if (removed_[at(e)]) return;
    removed_[at(e)] = true;
    ++done_.removed_tets;
    for (const Index node : tet(e)) stuffed_.on_surface[at(node)] = 1;
  }

  void part_edges(Index node) {
    const auto [begin, end] = defects_.faces_of.of(at(node));
    for (const Index* f = begin; f != end; ++f)
      for (const Index other : defects_.faces[at(*f)].nodes)
        if (other > node && defects_.edge_faces(node, other) > 2) part_edge(node, other);
  }

  /// Where more than one fan of elements meets at an edge, keeps the largest.
  void part_edge(Index a, Index b) {
    std::vector<Index> ring;
    const auto [begin, end] = star_.of(at(a));
    for (const Index* e = begin; e != end; ++e)
      if (has(tet(*e), b) && !removed_[at(*e)]) ring.push_back(*e);
    const std::vector<Index> group = group_items(
        ring.size(), [&](std::size_t i, std::size_t j) { return shared_nodes(tet(ring[i]), tet(ring[j])) == 3; });
    if (count_groups(group) < 2) return;
    std::vector<double> volumes(at(count_groups(group)), 0.0);
    for (std::size_t i = 0; i < ring.size(); ++i) volumes[at(group[i])] += volume(ring[i]);
    const auto largest = std::max_element(volumes.begin(), volumes.end()) - volumes.begin();
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (group[i] != largest) remove(ring[i]);
  }

  /// The elements at a node are joined but enclose it with more than one fan of boundary: takes away the shortest row
  /// of elements from the first fan to another. A star that lost elements in this round waits for the next.
  void open_vertex(Index node) {
    const auto [begin, end] = star_.of(at(node));
    const std::vector<Index> star(begin, end);
    if (std::any_of(star.begin(), star.end(), [&](Index e) { return removed_[at(e)]; })) return;
    const std::vector<Index> fans = defects_.fans(node);
    if (count_groups(fans) < 2) return;
    const Index* face = defects_.faces_of.of(at(node)).first;
    const auto touches = [&](Index e, bool first_fan) {
      for (std::size_t f = 0; f < fans.size(); ++f)
        if ((fans[f] == 0) == first_fan && defects_.faces[at(face[f])].element == e) return true;
      return false;
    };
    std::vector<std::size_t> queue;
    std::vector<Index> from(star.size(), -2);
    for (std::size_t i = 0; i < star.size(); ++i)
      if (touches(star[i], true)) {
        queue.push_back(i);
        from[i] = -1;
      }
    for (std::size_t head = 0; head < queue.size(); ++head) {
      const std::size_t i = queue[head];
      if (touches(star[i], false)) {
        for (auto step = static_cast<Index>(i); step >= 0; step = from[at(step)]) remove(star[at(step)]);
        return;
      }
      for (std::size_t j = 0; j < star.size(); ++j) {
        if (from[j] != -2 || shared_nodes(tet(star[i]), tet(star[j])) != 3) continue;
        from[j] = static_cast<Index>(i);
        queue.push_back(j);
      }
    }
  }

  void drop_removed() {
    std::size_t kept = 0;
    for (std::size_t e = 0; e < removed_.size(); ++e)
      if (!removed_[e]) stuffed_.mesh.tets[kept++] = stuffed_.mesh.tets[e];
    stuffed_.mesh.tets.resize(kept);
  }

  StuffedMesh& stuffed_;
  const BoundaryFans& defects_;
  std::vector<bool> removed_;
  NodeItems star_;  // elements of the defective nodes
  BoundaryMending done_;
};

/// Calls visit(tetrahedron, local face, element) for the faces whose nodes may all lie on the boundary.
template <typename Visit>
void visit_surface_faces(const StuffedMesh& stuffed, const Visit& visit) {
  for (std::size_t e = 0; e < stuffed.mesh.tets.size(); ++e) {
    const Tet& tet = stuffed.mesh.tets[e];
    std::array<bool, 4> surface;
    int count = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      surface[k] = stuffed.on_surface[at(tet[k])] != 0;
      count += surface[k] ? 1 : 0;
    }
    for (std::size_t k = 0; k < 4 && count >= 3; ++k)
      if (count == 4 || !surface[k]) visit(tet, k, static_cast<Index>(e));
  }
}

}  // namespace

std::vector<BoundaryFace> find_surface_faces(const StuffedMesh& stuffed) {
  std::size_t count = 0;
  visit_surface_faces(stuffed, [&](const Tet&, std::size_t, Index) { ++count; });
  std::vector<BoundaryFace> faces;
  faces.reserve(count);
  visit_surface_faces(stuffed, [&](const Tet& tet, std::size_t k, Index element) {
    Triangle face{tet[(k + 1) % 4], tet[(k + 2) % 4], tet[(k + 3) % 4]};
    std::sort(face.begin(), face.end());
    faces.push_back({face, element});
  });
  std::sort(faces.begin(), faces.end(), [](const BoundaryFace& a, const BoundaryFace& b) {
    return a.nodes != b.nodes ? a.nodes < b.nodes : a.element < b.element;
  });
  std::size_t kept = 0;
  for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
    for (end = i + 1; end < faces.size() && faces[end].nodes == faces[i].nodes;) ++end;
    if (end == i + 1) faces[kept++] = faces[i];
  }
  faces.resize(kept);
  faces.shrink_to_fit();
  return faces;
}

BoundaryMending mend_boundary(StuffedMesh& stuffed) {
  BoundaryMending total;
  while (true) {  // ends: copying only parts stars, removing only takes from a finite number of elements
    const BoundaryFans defects(stuffed);
    if (defects.nodes.empty()) return total;
    const BoundaryMending done = MendingRound(stuffed, defects).mend();
    total.copied_nodes += done.copied_nodes;
    total.removed_tets += done.removed_tets;
  }
}

}  // namespace softreel
