#include "core/tetmesh/sample_pairing.h"

#include <algorithm>

#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

constexpr std::int64_t kGrain = 256;

/// A face is drawn to no sample further away than this, in lengths of its longest edge: that is not its own surface.
constexpr double kReach = 1.0;

/// A face is drawn by the farthest of its samples, and by about so many others.
constexpr Index kFaceSamples = 12;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

SamplePairing::SamplePairing(std::span<const Vec3> samples, const BoundaryStars& stars, const TetMesh& mesh,
                             double near)
    : samples_(samples), stars_(stars), mesh_(mesh), near_(near), near_faces_(samples.size()) {}

void SamplePairing::recall(const FitMemory& memory, const Recollection& known) {
  for (std::size_t s = 0; s < std::min(near_faces_.size(), memory.samples.size()); ++s) {
    const NearTriangle& old = memory.samples[s];
    if (const Index face = old.number < 0 ? -1 : known.new_faces[at(old.number)]; face >= 0)
      near_faces_[s] = {face, old.squared};
  }
}

std::vector<std::uint8_t> SamplePairing::update(const std::vector<std::uint8_t>& moved, const Threads& threads) {
  std::vector<Triangle> triangles(stars_.faces.size());
  std::transform(stars_.faces.begin(), stars_.faces.end(), triangles.begin(),
                 [](const BoundaryFace& face) { return face.nodes; });
  const TriangleTree boundary(mesh_.nodes, triangles);
  std::vector<Index> places(triangles.size());
  for (std::size_t p = 0; p < places.size(); ++p) places[at(boundary.order()[p])] = static_cast<Index>(p);
  const auto count = static_cast<std::int64_t>(samples_.size());
  std::vector<std::vector<Index>> changed(at(static_cast<Index>((count + kGrain - 1) / kGrain)));
  threads.for_chunks(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
    Index guess = -1;
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      const Index face = near_faces_[s].number;
      if (face >= 0) {
        if (!has_moved(face, moved) && near_faces_[s].squared < near_) continue;
        near_faces_[s].squared = squared_distance(samples_[s], face);
        if (near_faces_[s].squared < near_) continue;
        guess = places[at(face)];
      }
      const TriangleTree::Nearest found = boundary.nearest_from(samples_[s], guess, near_);
      guess = found.place;
      near_faces_[s] = {found.triangle, found.squared_distance};
      if (found.triangle == face) continue;
      std::vector<Index>& list = changed[static_cast<std::size_t>(begin / kGrain)];
      list.push_back(found.triangle);
      if (face >= 0) list.push_back(face);
    }
  });
  list_samples();
  std::vector<std::uint8_t> flags(triangles.size(), 0);
  for (const std::vector<Index>& list : changed)
    for (const Index face : list) flags[at(face)] = 1;
  return flags;
}

bool SamplePairing::has_moved(Index face, const std::vector<std::uint8_t>& moved) const {
  return std::ranges::any_of(stars_.faces[at(face)].nodes,
                             [&](Index node) { return moved[at(stars_.numbers[at(node)])] != 0; });
}

void SamplePairing::list_samples() {
  std::vector<double> reach(stars_.faces.size());
  for (std::size_t f = 0; f < reach.size(); ++f) {
    const auto& [i, j, k] = stars_.faces[f].nodes;
    const Vec3 &a = mesh_.nodes[at(i)], &b = mesh_.nodes[at(j)], &c = mesh_.nodes[at(k)];
    reach[f] = kReach * kReach * std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()});
  }
  std::vector<Index> counts(stars_.faces.size(), 0), farthest(stars_.faces.size(), -1);
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    const std::size_t f = at(near_faces_[s].number);
    if (near_faces_[s].squared > reach[f]) continue;
    ++counts[f];
    if (farthest[f] < 0 || near_faces_[s].squared > squared(farthest[f])) farthest[f] = static_cast<Index>(s);
  }
  face_samples_ = CompressedList(stars_.faces.size(), [&](const auto& with) {
    std::vector<Index> seen(stars_.faces.size(), 0);
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      const std::size_t f = at(near_faces_[s].number);
      if (near_faces_[s].squared > reach[f]) continue;
      const bool is_turn = seen[f]++ % (counts[f] / kFaceSamples + 1) == 0;
      if (is_turn || farthest[f] == static_cast<Index>(s)) with(f, static_cast<Index>(s));
    }
  });
}

double SamplePairing::squared_distance(const Vec3& p, Index face) const {
  const auto& [a, b, c] = stars_.faces[at(face)].nodes;
  return (nearest_on_triangle(p, mesh_.nodes[at(a)], mesh_.nodes[at(b)], mesh_.nodes[at(c)]) - p).squaredNorm();
}

}  // namespace softreel
