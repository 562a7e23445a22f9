#include "tool/bodies/followed_files.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/nearest_name.h"
#include "core/constraints/followed_node.h"
#include "core/constraints/followed_surface.h"
#include "core/mesh/readers/point_cache_reader.h"
#include "core/mesh/readers/scene_import.h"

namespace softreel {
namespace {

constexpr std::size_t kMostNames = 12;  ///< in a message

/// "'jaw', 'skull'": names without repetition.
std::string name_list(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNames); ++i) list += (i > 0 ? ", '" : "'") + names[i] + "'";
  return names.size() > kMostNames ? fmt::format("{} and {} more", list, names.size() - kMostNames) : list;
}

Error unknown_name(const std::string& file, const std::string& kind, const std::string& name,
                   const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(name, known);
  return input_error(fmt::format("{} has no {} '{}'.\n  Accepted: {}. {}", file, kind, name,
                                 known.empty() ? "none, it has no " + kind : name_list(known),
                                 nearest.empty() ? "Name one of them." : fmt::format("Did you mean '{}'?", nearest)));
}

const SceneClip& find_clip(const SceneAnimation& scene, const FollowSettings& follow) {
  std::vector<std::string> names;
  for (const SceneClip& clip : scene.clips) names.push_back(clip.name);
  if (scene.clips.empty())
    throw input_error(
        fmt::format("{} holds no animation.\n  Accepted: a scene with an animation clip, or a point cache. Export it "
                    "with its animation, or use keys.",
                    follow.file));
  if (follow.clip.empty() && scene.clips.size() == 1) return scene.clips.front();
  if (follow.clip.empty())
    throw input_error(fmt::format("{} holds {} animations.\n  Accepted: clip = one of {}. Name the one to follow.",
                                  follow.file, names.size(), name_list(names)));
  const auto found = std::find(names.begin(), names.end(), follow.clip);
  if (found == names.end()) throw unknown_name(follow.file, "clip", follow.clip, names);
  if (const auto count = std::count(names.begin(), names.end(), follow.clip); count > 1)
    throw input_error(
        fmt::format("{} has {} animations '{}'.\n  Accepted: a clip whose name is its own. Rename the others.",
                    follow.file, count, follow.clip));
  return scene.clips[static_cast<std::size_t>(found - names.begin())];
}

Index find_node(const SceneAnimation& scene, const FollowSettings& follow) {
  std::vector<std::string> names;
  for (const SceneNode& node : scene.nodes) names.push_back(node.name);
  const auto found = std::find(names.begin(), names.end(), follow.node);
  if (found == names.end()) throw unknown_name(follow.file, "node", follow.node, names);
  if (const auto count = std::count(names.begin(), names.end(), follow.node); count > 1)
    throw input_error(fmt::format("{} has {} nodes '{}'.\n  Accepted: a node whose name is its own. Rename the others.",
                                  follow.file, count, follow.node));
  return static_cast<Index>(found - names.begin());
}

/// A mesh of several materials comes as several, numbered behind a dash.
bool is_named(const SceneAnimation& scene, const SceneMesh& mesh, const std::string& name) {
  if (mesh.name == name || scene.nodes[static_cast<std::size_t>(mesh.node)].name == name) return true;
  if (!mesh.name.starts_with(name + "-")) return false;
  return std::all_of(mesh.name.begin() + static_cast<std::ptrdiff_t>(name.size()) + 1, mesh.name.end(),
                     [](char c) { return c >= '0' && c <= '9'; });
}

std::vector<Index> find_meshes(const SceneAnimation& scene, const FollowSettings& follow) {
  std::vector<Index> meshes;
  std::vector<std::string> names;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const SceneMesh& mesh = scene.meshes[m];
    names.push_back(mesh.name);
    names.push_back(scene.nodes[static_cast<std::size_t>(mesh.node)].name);
    if (follow.mesh.empty() || is_named(scene, mesh, follow.mesh)) meshes.push_back(static_cast<Index>(m));
  }
  if (meshes.empty()) throw unknown_name(follow.file, "mesh", follow.mesh, names);
  return meshes;
}

Error count_mismatch(const FollowSettings& follow, Index count, const LoadedBody& body, const std::string& advice) {
  return input_error(
      fmt::format("{} moves {} vertices, but the body has {}.\n  Accepted: as many, in the order of the body's mesh "
                  "file. {}.",
                  follow.file, count, body.surface.positions.size(), advice));
}

std::vector<Index> all_vertices(Index count) {
  std::vector<Index> vertices(static_cast<std::size_t>(count));
  std::iota(vertices.begin(), vertices.end(), Index{0});
  return vertices;
}

using Binding = FollowedSurface::Binding;

/// The vertices are the body's own: where they are at rest is where the body rests.
std::unique_ptr<const FollowedMotion> follow_vertices(std::shared_ptr<const AnimatedVertices> vertices,
                                                      const LoadedBody& body, const ClipTiming& timing,
                                                      const Placement& placement) {
  return std::make_unique<FollowedSurface>(std::move(vertices), body.surface.positions, body.surface.triangles,
                                           Binding::Vertex, timing, placement);
}

/// A point cache has vertices and nothing else.
void require_cache_fields(const FollowSettings& follow) {
  using Given = std::pair<const char*, bool>;
  for (const auto& [field, given] :
       {Given{"node", !follow.node.empty()}, Given{"mesh", !follow.mesh.empty()}, Given{"clip", !follow.clip.empty()},
        Given{"reference", follow.reference.has_value()}})
    if (given)
      throw input_error(
          fmt::format("{} is a point cache, which has no {}.\n  Accepted: file, start, speed, placement. "
                      "Remove {}.",
                      follow.file, field, field));
  if (follow.bind == Binding::Nearest)
    throw input_error(
        fmt::format("{} is a point cache, which has no triangles to bind to.\n  Accepted: bind = "
                    "\"vertex\". Remove bind.",
                    follow.file));
}

std::unique_ptr<const FollowedMotion> follow_meshes(SceneVertices moved, const FollowSettings& follow,
                                                    const LoadedBody& body, const ClipTiming& timing,
                                                    const Placement& placement) {
  auto vertices = std::make_shared<const SceneVertices>(std::move(moved));
  const bool as_many = vertices->count() == static_cast<Index>(body.surface.positions.size());
  const Binding binding = follow.bind.value_or(as_many && !follow.reference ? Binding::Vertex : Binding::Nearest);
  if (binding == Binding::Vertex) {
    if (follow.reference)
      throw input_error(
          fmt::format("{}: bind = \"vertex\" starts from the body at rest, so that reference = {} says nothing.\n"
                      "  Accepted: reference with bind = \"nearest\". Leave one of the two out.",
                      follow.file, *follow.reference));
    if (!as_many) throw count_mismatch(follow, vertices->count(), body, "Or use bind = \"nearest\"");
    return follow_vertices(std::move(vertices), body, timing, placement);
  }
  std::vector<Vec3> reference = follow.reference
                                    ? vertices->at(timing.seconds(*follow.reference), all_vertices(vertices->count()))
                                    : vertices->rest();
  for (Vec3& p : reference) p = placement(p);
  std::vector<Triangle> triangles = vertices->triangles();
  return std::make_unique<FollowedSurface>(std::move(vertices), std::move(reference), std::move(triangles), binding,
                                           timing, placement);
}

}  // namespace

const SceneAnimation& FollowedFiles::scene(const std::string& path, const Log& log) {
  std::unique_ptr<const SceneAnimation>& scene = scenes_[path];
  if (!scene) scene = std::make_unique<const SceneAnimation>(import_scene(path, log));
  return *scene;
}

std::unique_ptr<const FollowedMotion> FollowedFiles::follow_cache(const Shot& shot, const FollowSettings& follow,
                                                                  const LoadedBody& body, const ClipTiming& timing,
                                                                  const Placement& placement) {
  require_cache_fields(follow);
  std::shared_ptr<const CachedVertices>& vertices = caches_[follow.file];
  if (!vertices) vertices = std::make_shared<const CachedVertices>(read_point_cache(follow.file, shot.settings.fps));
  if (vertices->count() != static_cast<Index>(body.surface.positions.size()))
    throw count_mismatch(follow, vertices->count(), body, "Export the cache of this mesh");
  return follow_vertices(vertices, body, timing, placement);
}

void FollowedFiles::check(const Shot& shot, const FollowedClip& clip, const ClipTiming& timing, const Log& log) {
  require_own_names(clip);
  const ShotSettings& settings = shot.settings;
  for (const std::string& warning : {straight_curve_warning(clip, settings.fps),
                                     still_clip_warning(clip, timing, settings.first_frame, settings.last_frame)})
    if (!warning.empty() && said_.insert(warning).second) log.warn(warning);
}

const FollowedMotion& FollowedFiles::motion(const Shot& shot, const FollowSettings& follow, const LoadedBody& body,
                                            const Log& log) {
  const ClipTiming timing{follow.start.value_or(shot.settings.first_frame), shot.settings.fps, follow.speed};
  const Placement placement = follow.in_scene ? Placement{} : body.placement;
  if (is_point_cache_file(follow.file)) {
    motions_.push_back(follow_cache(shot, follow, body, timing, placement));
    return *motions_.back();
  }
  const SceneAnimation& from = scene(follow.file, log);
  const SceneClip& clip = find_clip(from, follow);
  if (follow.node.empty()) {
    const std::vector<Index> meshes = find_meshes(from, follow);
    check(shot, {follow.file, from, clip, meshes, SceneNodes(from, &clip, nodes_of_meshes(from, meshes))}, timing, log);
    motions_.push_back(follow_meshes(SceneVertices(from, &clip, meshes), follow, body, timing, placement));
  } else {
    const Index node = find_node(from, follow);
    check(shot, {follow.file, from, clip, {}, SceneNodes(from, &clip, {node})}, timing, log);
    motions_.push_back(std::make_unique<FollowedNode>(from, clip, node, timing, follow.reference, placement));
  }
  return *motions_.back();
}

}  // namespace softreel
