#include "core/tetmesh/boundary_probes.h"

#include <algorithm>

namespace softreel {
namespace {

constexpr std::int64_t kGrain = 256;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

BoundaryProbes::BoundaryProbes(const TriangleTree& tree, const BoundaryStars& stars, const TetMesh& mesh, double near)
    : tree_(tree),
      stars_(stars),
      mesh_(mesh),
      near_(near),
      near_triangles_(stars.nodes.size() + stars.edges.size() + stars.faces.size()) {}

void BoundaryProbes::recall(const FitMemory& memory, const Recollection& known) {
  const auto take = [&](const std::vector<Index>& numbers, std::size_t first, std::size_t old_first) {
    for (std::size_t i = 0; i < numbers.size(); ++i)
      if (numbers[i] >= 0) near_triangles_[first + i] = memory.probes[old_first + at(numbers[i])];
  };
  const std::size_t old_edges = memory.before.size(), old_faces = old_edges + memory.edges.size();
  take(known.nodes, 0, 0);
  take(known.edges, of_edge(0), old_edges);
  take(known.faces, of_face(0), old_faces);
}

void BoundaryProbes::find_at_nodes(const Threads& threads) {
  const auto nodes = static_cast<std::int64_t>(stars_.nodes.size());
  threads.for_chunks(nodes, kGrain, [&](std::int64_t begin, std::int64_t end) {
    Index guess = -1;
    for (auto b = static_cast<std::size_t>(begin); b < static_cast<std::size_t>(end); ++b) {
      if (near_triangles_[b].number < 0) {
        const TriangleTree::Nearest found = tree_.nearest_from(point(b), guess);
        near_triangles_[b] = {found.place, found.squared_distance};
      }
      guess = near_triangles_[b].number;
    }
  });
  const auto guess_from = [&](std::size_t probe, Index node) {
    if (near_triangles_[probe].number < 0)
      near_triangles_[probe].number = near_triangles_[at(stars_.numbers[at(node)])].number;
  };
  for (std::size_t e = 0; e < stars_.edges.size(); ++e) guess_from(of_edge(e), stars_.edges[e][0]);
  for (std::size_t f = 0; f < stars_.faces.size(); ++f) guess_from(of_face(f), stars_.faces[f].nodes[0]);
}

void BoundaryProbes::update(const std::vector<std::uint8_t>& moved, const Threads& threads) {
  const auto count = static_cast<std::int64_t>(near_triangles_.size());
  threads.for_chunks(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto p = static_cast<std::size_t>(begin); p < static_cast<std::size_t>(end); ++p)
      if (near_triangles_[p].squared < 0 || has_moved(p, moved)) near_triangles_[p] = measure(p);
  });
}

bool BoundaryProbes::has_moved(std::size_t probe, const std::vector<std::uint8_t>& moved) const {
  const auto node_moved = [&](Index node) { return moved[at(stars_.numbers[at(node)])] != 0; };
  if (probe < of_edge(0)) return moved[probe] != 0;
  if (probe < of_face(0)) return std::ranges::any_of(stars_.edges[probe - of_edge(0)], node_moved);
  return std::ranges::any_of(stars_.faces[probe - of_face(0)].nodes, node_moved);
}

Vec3 BoundaryProbes::point(std::size_t probe) const {
  const auto position = [&](Index node) -> const Vec3& { return mesh_.nodes[at(node)]; };
  if (probe < of_edge(0)) return position(stars_.nodes[probe]);
  if (probe < of_face(0)) {
    const auto& [a, b] = stars_.edges[probe - of_edge(0)];
    return 0.5 * (position(a) + position(b));
  }
  const auto& [a, b, c] = stars_.faces[probe - of_face(0)].nodes;
  return (position(a) + position(b) + position(c)) / 3;
}

Vec3 BoundaryProbes::foot(std::size_t probe) const {
  const auto& [a, b, c] = tree_.corners()[at(near_triangles_[probe].number)];
  return nearest_on_triangle(point(probe), a, b, c);
}

NearTriangle BoundaryProbes::measure(std::size_t probe) const {
  const Vec3 x = point(probe);
  const Index place = near_triangles_[probe].number;
  if (place >= 0) {
    const auto& [a, b, c] = tree_.corners()[at(place)];
    const double squared = (nearest_on_triangle(x, a, b, c) - x).squaredNorm();
    if (squared < near_) return {place, squared};
  }
  const TriangleTree::Nearest found = tree_.nearest_from(x, place);
  return {found.place, found.squared_distance};
}

}  // namespace softreel
