#include "core/tetmesh/boundary/face_samples.h"

#include <algorithm>

#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

constexpr std::int64_t kPairGrain = 256;

/// A face is drawn to no sample further away than this, in lengths of its longest edge: that is not its own surface.
constexpr double kFaceReach = 1.0;

/// A face is drawn by the farthest of its samples, and by about so many others.
constexpr Index kFaceSamples = 12;

}  // namespace

FaceSamples::FaceSamples(const TetMesh& mesh, const BoundaryStars& stars, const SurfaceSamples& samples, double near,
                         const Threads& threads)
    : mesh_(mesh), stars_(stars), samples_(samples), near_(near), threads_(threads), faces_(samples.size(), -1) {}

double FaceSamples::squared_distance(const Vec3& p, Index face) const {
  const auto& [a, b, c] = stars_.faces[at(face)].nodes;
  return (nearest_on_triangle(p, mesh_.nodes[at(a)], mesh_.nodes[at(b)], mesh_.nodes[at(c)]) - p).squaredNorm();
}

bool FaceSamples::has_moved(Index face, const std::vector<bool>& moved) const {
  const Triangle& nodes = stars_.faces[at(face)].nodes;
  return std::any_of(nodes.begin(), nodes.end(), [&](Index node) { return moved[at(stars_.numbers[at(node)])]; });
}

void FaceSamples::pair(const std::vector<bool>& moved) {
  std::vector<Triangle> triangles(stars_.faces.size());
  std::transform(stars_.faces.begin(), stars_.faces.end(), triangles.begin(),
                 [](const BoundaryFace& face) { return face.nodes; });
  const TriangleTree boundary(mesh_.nodes, triangles);
  std::vector<Index> places(triangles.size());
  for (std::size_t p = 0; p < places.size(); ++p) places[at(boundary.order()[p])] = static_cast<Index>(p);
  squared_.resize(samples_.size());
  threads_.for_chunks(static_cast<std::int64_t>(samples_.size()), kPairGrain,
                      [&](std::int64_t begin, std::int64_t end) {
                        Index guess = -1;
                        for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
                          const Index face = faces_[s];
                          if (face >= 0 && squared_[s] < near_ && !has_moved(face, moved)) continue;
                          const Vec3 x = samples_[s];
                          if (face >= 0) {
                            squared_[s] = squared_distance(x, face);
                            if (squared_[s] < near_) continue;
                            guess = places[at(face)];
                          }
                          const TriangleTree::Nearest found = boundary.nearest_from(x, guess, near_);
                          guess = found.place;
                          faces_[s] = found.triangle;
                          squared_[s] = found.squared_distance;
                        }
                      });
  list();
}

double FaceSamples::squared_reach(std::size_t face) const {
  const auto& [i, j, k] = stars_.faces[face].nodes;
  const Vec3 &a = mesh_.nodes[at(i)], &b = mesh_.nodes[at(j)], &c = mesh_.nodes[at(k)];
  return kFaceReach * kFaceReach * std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()});
}

void FaceSamples::list() {
  const std::size_t count = stars_.faces.size();
  std::vector<double> reach(count);
  for (std::size_t f = 0; f < count; ++f) reach[f] = squared_reach(f);
  std::vector<Index> counts(count, 0), farthest(count, -1);
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    const std::size_t f = at(faces_[s]);
    if (squared_[s] > reach[f]) continue;
    ++counts[f];
    if (farthest[f] < 0 || squared_[s] > squared_[at(farthest[f])]) farthest[f] = static_cast<Index>(s);
  }
  lists_ = {};  // before there is a new one
  lists_ = CompressedList(count, [&](const auto& with) {
    std::vector<Index> seen(count, 0);
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      const std::size_t f = at(faces_[s]);
      if (squared_[s] > reach[f]) continue;
      const bool is_turn = seen[f]++ % (counts[f] / kFaceSamples + 1) == 0;
      if (is_turn || farthest[f] == static_cast<Index>(s)) with(f, static_cast<Index>(s));
    }
  });
}

}  // namespace softreel
