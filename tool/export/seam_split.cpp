#include "tool/export/seam_split.h"

#include <numeric>

namespace softreel {
namespace {

/// Copies of each vertex, as chains: a vertex, its first duplicate, the next one, ...
class Copies {
 public:
  explicit Copies(SeamSplit& split)
      : split_(split), next_(split.sources.size(), -1), has_texture_(split.sources.size(), 0) {}

  /// The copy of `vertex` with this coordinate, made if there is none.
  Index with(Index vertex, const Vec2f& texture) {
    for (Index copy = vertex;; copy = next_[at(copy)]) {
      if (has_texture_[at(copy)] == 0) {
        has_texture_[at(copy)] = 1;
        split_.textures[at(copy)] = texture;
      }
      if (split_.textures[at(copy)] == texture) return copy;
      if (next_[at(copy)] >= 0) continue;
      const auto added = static_cast<Index>(split_.sources.size());
      next_[at(copy)] = added;
      split_.sources.push_back(vertex);
      split_.textures.push_back(texture);
      next_.push_back(-1);
      has_texture_.push_back(1);
      return added;
    }
  }

 private:
  static std::size_t at(Index index) { return static_cast<std::size_t>(index); }

  SeamSplit& split_;
  std::vector<Index> next_;
  std::vector<char> has_texture_;
};

}  // namespace

SeamSplit split_at_seams(const SurfaceMesh& mesh) {
  SeamSplit split;
  split.sources.resize(mesh.positions.size());
  std::iota(split.sources.begin(), split.sources.end(), 0);
  split.triangles = mesh.triangles;
  if (mesh.triangle_textures.empty()) return split;
  split.textures.assign(mesh.positions.size(), Vec2f::Zero());
  Copies copies(split);
  for (std::size_t t = 0; t < split.triangles.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Index texture = mesh.triangle_textures[t][corner];
      const Vec2f value =
          texture < 0 ? Vec2f(0, 0) : Vec2f(mesh.texture_coordinates[static_cast<std::size_t>(texture)].cast<float>());
      split.triangles[t][corner] = copies.with(split.triangles[t][corner], value);
    }
  return split;
}

}  // namespace softreel
