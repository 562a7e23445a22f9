#include "tool/bodies/followed_clip.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/mesh/readers/mesh_source.h"

namespace softreel {
namespace {

/// Keys that are baked are a frame apart, of the shot or of film, but for rounding.
constexpr double kBakedFrames = 1.5;
constexpr double kFilm = 24;

/// Values nearer to each other, relative or in radians, are one value that was rounded.
constexpr double kSameValue = 1e-4;

bool differ(const Vec3& a, const Vec3& b) {
  return (b - a).norm() > kSameValue * std::max(a.norm(), b.norm());
}

bool differ(const Quaternion& a, const Quaternion& b) {
  return a.angularDistance(b) > kSameValue;
}

bool differ(const std::vector<double>& a, const std::vector<double>& b) {
  for (std::size_t k = 0; k < a.size(); ++k)
    if (std::abs(b[k] - a[k]) > kSameValue) return true;
  return false;
}

/// The pieces of a curve at whose ends its values differ.
struct MovingPieces {
  std::string what;
  std::vector<std::pair<double, double>> seconds;
};

template <typename T>
void add_pieces(const Samples<T>& samples, const std::string& what, std::vector<MovingPieces>& curves) {
  MovingPieces curve{what, {}};
  for (std::size_t k = 1; k < samples.values.size(); ++k)
    if (differ(samples.values[k - 1], samples.values[k]))
      curve.seconds.emplace_back(samples.seconds[k - 1], samples.seconds[k]);
  if (!curve.seconds.empty()) curves.push_back(std::move(curve));
}

bool follows_mesh(const FollowedClip& followed, Index mesh) {
  return std::find(followed.meshes.begin(), followed.meshes.end(), mesh) != followed.meshes.end();
}

/// Of all that the clip moves of what is followed.
std::vector<MovingPieces> moving_pieces(const FollowedClip& followed) {
  std::vector<MovingPieces> curves;
  for (const NodeChannel* channel : followed.nodes.channels()) {
    if (channel == nullptr) continue;
    const std::string& node = followed.scene.nodes[static_cast<std::size_t>(channel->node)].name;
    add_pieces(channel->translation, fmt::format("translation of node '{}'", node), curves);
    add_pieces(channel->rotation, fmt::format("rotation of node '{}'", node), curves);
    add_pieces(channel->scale, fmt::format("scale of node '{}'", node), curves);
  }
  for (const MorphChannel& channel : followed.clip.morphs)
    if (follows_mesh(followed, channel.mesh))
      add_pieces(
          channel.weights,
          fmt::format("morph weights of mesh '{}'", followed.scene.meshes[static_cast<std::size_t>(channel.mesh)].name),
          curves);
  return curves;
}

/// Names that several nodes have.
std::set<std::string> shared_names(const SceneAnimation& scene) {
  std::set<std::string> seen, shared;
  for (const SceneNode& node : scene.nodes)
    if (!seen.insert(node.name).second) shared.insert(node.name);
  return shared;
}

/// What is told by a name out of `shared`, and that name; none: nothing is.
std::optional<std::pair<std::string, std::string>> find_shared(const FollowedClip& followed,
                                                               const std::set<std::string>& shared) {
  const auto name = [&](Index node) { return followed.scene.nodes[static_cast<std::size_t>(node)].name; };
  for (const Index m : followed.meshes) {
    const SceneMesh& mesh = followed.scene.meshes[static_cast<std::size_t>(m)];
    for (const SkinJoint& joint : mesh.joints)
      if (shared.contains(name(joint.node)))
        return {{fmt::format("a joint of mesh '{}'", mesh.name), name(joint.node)}};
  }
  const std::string moved = fmt::format("what clip '{}' moves", followed.clip.name);
  std::set<std::string> at_stake;
  for (const Index n : followed.nodes.numbers())
    if (shared.contains(name(n))) at_stake.insert(name(n));
  for (const NodeChannel& channel : followed.clip.nodes)
    if (at_stake.contains(name(channel.node))) return {{moved, name(channel.node)}};
  for (const MorphChannel& channel : followed.clip.morphs) {
    const std::string node = name(followed.scene.meshes[static_cast<std::size_t>(channel.mesh)].node);
    if (follows_mesh(followed, channel.mesh) && shared.contains(node)) return {{moved, node}};
  }
  return std::nullopt;
}

}  // namespace

void require_own_names(const FollowedClip& followed) {
  const std::set<std::string> shared = shared_names(followed.scene);
  if (shared.empty()) return;
  if (const auto found = find_shared(followed, shared))
    throw input_error(
        fmt::format("{}: {} is '{}', but several nodes have this name.\n  Accepted: nodes whose names are their own. "
                    "Rename them and export the scene again.",
                    followed.file, found->first, found->second));
}

std::string straight_curve_warning(const FollowedClip& followed, double fps) {
  const std::string extension = detail::lower_extension(followed.file);
  if (extension == ".gltf" || extension == ".glb") return "";  // says the kind of its curves: import_scene warns
  const double most = kBakedFrames / std::min(fps, kFilm);
  for (const MovingPieces& curve : moving_pieces(followed))
    for (const auto& [begin, end] : curve.seconds)
      if (end - begin > most)
        return fmt::format(
            "{}: clip '{}' has no key of the {} from {:.4g} to {:.4g} s, where it is taken as a straight line, "
            "whatever "
            "curve was drawn. Bake the animation, a key a frame, to follow its curves",
            followed.file, followed.clip.name, curve.what, begin, end);
  return "";
}

std::string still_clip_warning(const FollowedClip& followed, const ClipTiming& timing, int first_frame,
                               int last_frame) {
  const auto [begin, end] = std::minmax({timing.seconds(first_frame), timing.seconds(last_frame)});
  const std::vector<MovingPieces> curves = moving_pieces(followed);
  if (curves.empty()) return "";
  double first = curves.front().seconds.front().first, last = first;
  for (const MovingPieces& curve : curves) {
    first = std::min(first, curve.seconds.front().first);
    last = std::max(last, curve.seconds.back().second);
  }
  if (first <= end && last >= begin) return "";
  return fmt::format(
      "{}: nothing of clip '{}' that is followed moves in the shot: frames {} to {} are its {:.4g} to {:.4g} s, and it "
      "moves from {:.4g} to {:.4g} s. start = {:.10g} would begin that at frame {}",
      followed.file, followed.clip.name, first_frame, last_frame, begin, end, first, last,
      first_frame - first * timing.fps / timing.speed, first_frame);
}

}  // namespace softreel
