#include "core/tetmesh/improvement/tet_stars.h"

#include <algorithm>

namespace softreel {
namespace {

bool has(const Tet& tet, Index node) {
  return tet[0] == node || tet[1] == node || tet[2] == node || tet[3] == node;
}

/// The two other nodes of an element with the edge from a to b, such that a, b and they are positively oriented.
std::array<Index, 2> opposite_edge(const Tet& tet, Index a, Index b) {
  // [place of a][place of b]: the places that complete an even permutation
  constexpr std::size_t kOther[4][4][2] = {{{0, 0}, {2, 3}, {3, 1}, {1, 2}},
                                           {{3, 2}, {0, 0}, {0, 3}, {2, 0}},
                                           {{1, 3}, {3, 0}, {0, 0}, {0, 1}},
                                           {{2, 1}, {0, 2}, {1, 0}, {0, 0}}};
  const auto place = [&](Index node) {
    return static_cast<std::size_t>(std::find(tet.begin(), tet.end(), node) - tet.begin());
  };
  const auto& other = kOther[place(a)][place(b)];
  return {tet[other[0]], tet[other[1]]};
}

}  // namespace

TetStars::TetStars(TetMesh& mesh, const AngleMeasure& measure)
    : mesh_(mesh), measure_(measure), stars_(mesh.nodes.size()), changes_(mesh.nodes.size(), 0) {
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    for (const Index node : mesh.tets[e]) stars_[at(node)].push_back(static_cast<Index>(e));
    qualities_.push_back(measure.quality(corners(mesh.tets[e])));
  }
}

TetCorners TetStars::corners(const Tet& tet) const {
  return {position(tet[0]), position(tet[1]), position(tet[2]), position(tet[3])};
}

TetCorners TetStars::corners(Index element) const {
  return corners(tet(element));
}

void TetStars::find_ring(Index a, Index b, EdgeRing& ring) const {
  ring = {};
  std::vector<std::array<Index, 2>> links;
  std::vector<Index> owners;
  for (const Index e : star(a))
    if (has(tet(e), b)) {
      links.push_back(opposite_edge(tet(e), a, b));
      owners.push_back(e);
    }
  if (links.empty()) return;
  Index next = links[0][0];
  for (std::size_t step = 0; step < links.size(); ++step) {
    const auto found = std::find_if(links.begin(), links.end(), [&](const auto& link) { return link[0] == next; });
    if (found == links.end() || (step > 0 && next == links[0][0])) return;
    ring.nodes.push_back(next);
    ring.elements.push_back(owners[static_cast<std::size_t>(found - links.begin())]);
    next = (*found)[1];
  }
  ring.closed = links.size() >= 3 && next == links[0][0];
}

Index TetStars::across(const Triangle& face, Index element) const {
  Index other = -1;
  for (const Index e : star(face[0]))
    if (e != element && has(tet(e), face[1]) && has(tet(e), face[2])) other = other == -1 ? e : -2;
  return other;
}

bool TetStars::has_edge(Index a, Index b) const {
  return std::ranges::any_of(star(a), [&](Index e) { return has(tet(e), b); });
}

void TetStars::move(Index node, const Vec3& to) {
  mesh_.nodes[at(node)] = to;
  ++now_;
  for (const Index e : star(node)) {
    qualities_[at(e)] = measure_.quality(corners(e));
    for (const Index touched : tet(e)) changes_[at(touched)] = now_;
  }
}

void TetStars::insert(Index slot, const Tet& tet) {
  mesh_.tets[at(slot)] = tet;
  qualities_[at(slot)] = measure_.quality(corners(tet));
  for (const Index node : tet) {
    stars_[at(node)].push_back(slot);
    changes_[at(node)] = now_;
  }
}

void TetStars::exchange(std::span<const Index> old_elements, std::span<const Tet> new_tets) {
  ++now_;
  for (const Index e : old_elements) {
    for (const Index node : tet(e)) {
      std::erase(stars_[at(node)], e);
      changes_[at(node)] = now_;
    }
    mesh_.tets[at(e)] = {-1, -1, -1, -1};
  }
  gaps_.insert(gaps_.end(), old_elements.rbegin(), old_elements.rend());
  for (const Tet& tet : new_tets) {
    if (gaps_.empty()) {
      gaps_.push_back(static_cast<Index>(mesh_.tets.size()));
      mesh_.tets.emplace_back();
      qualities_.push_back(0);
    }
    const Index slot = gaps_.back();
    gaps_.pop_back();
    insert(slot, tet);
  }
}

void TetStars::compact() {
  std::size_t kept = 0;
  for (std::size_t e = 0; e < mesh_.tets.size(); ++e) {
    if (is_gap(static_cast<Index>(e))) continue;
    mesh_.tets[kept] = mesh_.tets[e];
    qualities_[kept++] = qualities_[e];
  }
  mesh_.tets.resize(kept);
  qualities_.resize(kept);
  gaps_.clear();
}

}  // namespace softreel
