#include "core/tetmesh/fit_memory.h"

#include <algorithm>
#include <bit>

namespace softreel {
namespace {

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

std::uint64_t position_key(const Vec3& p) {
  std::uint64_t key = 0;
  for (int k = 0; k < 3; ++k) key = (key ^ std::bit_cast<std::uint64_t>(p[k])) * 0x9e3779b97f4a7c15ULL;
  return key;
}

/// Items of mesh nodes as items of boundary nodes.
template <typename Item>
Item by_boundary_nodes(const BoundaryStars& stars, Item item) {
  for (Index& node : item) node = stars.numbers[at(node)];
  return item;
}

/// The one of `candidates`, which have a first node in common, that has the others of `wanted` too; -1: none.
template <typename Item, typename NodesOf>
Index find_item(std::span<const Index> candidates, const Item& wanted, const NodesOf& nodes_of) {
  for (const Index candidate : candidates) {
    const Item& nodes = nodes_of(candidate);
    if (std::all_of(wanted.begin(), wanted.end(),
                    [&](Index node) { return std::find(nodes.begin(), nodes.end(), node) != nodes.end(); }))
      return candidate;
  }
  return -1;
}

}  // namespace

FitMemory::FitMemory(const BoundaryStars& stars, std::vector<Vec3> began, const std::vector<Vec3>& mesh_nodes)
    : before(std::move(began)) {
  for (std::size_t b = 0; b < before.size(); ++b) {
    after.push_back(mesh_nodes[at(stars.nodes[b])]);
    const auto [key, is_new] = keys_.insert(position_key(before[b]));
    if (is_new)
      numbers_.push_back(static_cast<Index>(b));
    else
      numbers_[at(key)] = -1;
  }
  for (const auto& edge : stars.edges) edges.push_back(by_boundary_nodes(stars, edge));
  for (const BoundaryFace& face : stars.faces) faces.push_back(by_boundary_nodes(stars, face.nodes));
}

Index FitMemory::find(const Vec3& place) const {
  const Index key = keys_.find(position_key(place));
  const Index number = key < 0 ? -1 : numbers_[at(key)];
  return number >= 0 && before[at(number)] == place ? number : -1;
}

Recollection::Recollection(const FitMemory& memory, const BoundaryStars& stars, const std::vector<Vec3>& mesh_nodes)
    : edges(stars.edges.size(), -1), faces(stars.faces.size(), -1), new_faces(memory.faces.size(), -1) {
  std::vector<Index> new_nodes(memory.before.size(), -1);  // per old node: number in the mesh
  for (const Index node : stars.nodes) {
    nodes.push_back(memory.find(mesh_nodes[at(node)]));
    if (nodes.back() >= 0) new_nodes[at(nodes.back())] = node;
  }
  const auto match = [&](const auto& old_items, const CompressedList& items_of, const auto& nodes_of, auto&& with) {
    for (std::size_t i = 0; i < old_items.size(); ++i) {
      auto wanted = old_items[i];
      for (Index& node : wanted) node = new_nodes[at(node)];
      if (std::find(wanted.begin(), wanted.end(), -1) != wanted.end()) continue;
      const Index found = find_item(items_of.of(at(stars.numbers[at(wanted[0])])), wanted, nodes_of);
      if (found >= 0) with(found, static_cast<Index>(i));
    }
  };
  match(
      memory.edges, stars.edges_of, [&](Index e) -> const auto& { return stars.edges[at(e)]; },
      [&](Index now, Index old) { edges[at(now)] = old; });
  match(
      memory.faces, stars.faces_of, [&](Index f) -> const auto& { return stars.faces[at(f)].nodes; },
      [&](Index now, Index old) {
        faces[at(now)] = old;
        new_faces[at(old)] = now;
      });
}

}  // namespace softreel
