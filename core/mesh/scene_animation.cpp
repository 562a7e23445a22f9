#include "core/mesh/scene_animation.h"

#include <algorithm>
#include <numeric>

#include "core/base/fingerprint.h"

namespace softreel {
namespace {

Vec3 blend(const Vec3& a, const Vec3& b, double share) {
  return a + share * (b - a);
}

Quaternion blend(const Quaternion& a, const Quaternion& b, double share) {
  return a.slerp(share, b);
}

std::vector<double> blend(std::vector<double> a, const std::vector<double>& b, double share) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k] += share * (b[k] - a[k]);
  return a;
}

template <typename T>
T value_at(const Samples<T>& samples, double seconds) {
  const auto next = std::upper_bound(samples.seconds.begin(), samples.seconds.end(), seconds);
  if (next == samples.seconds.begin()) return samples.values.front();
  if (next == samples.seconds.end()) return samples.values.back();
  const auto b = static_cast<std::size_t>(next - samples.seconds.begin());
  const double share = (seconds - samples.seconds[b - 1]) / (*next - samples.seconds[b - 1]);
  return share == 0 ? samples.values[b - 1] : blend(samples.values[b - 1], samples.values[b], share);
}

Affine local_at(const NodeChannel& channel, double seconds) {
  Affine local;
  if (!channel.rotation.empty()) local.linear = value_at(channel.rotation, seconds).normalized().toRotationMatrix();
  if (!channel.scale.empty()) local.linear = (local.linear * value_at(channel.scale, seconds).asDiagonal()).eval();
  if (!channel.translation.empty()) local.offset = value_at(channel.translation, seconds);
  return local;
}

std::vector<Affine> joint_maps(const SceneMesh& mesh, const SceneNodes& nodes, const std::vector<Affine>& pose) {
  std::vector<Affine> maps;
  for (const SkinJoint& joint : mesh.joints) maps.push_back(pose[nodes.place(joint.node)] * joint.from_bind);
  return maps;
}

/// What the clip says of a mesh's morph targets; of several the last, as of a node.
const MorphChannel* morph_channel(const SceneClip* clip, Index mesh) {
  const MorphChannel* found = nullptr;
  if (clip != nullptr)
    for (const MorphChannel& channel : clip->morphs)
      if (channel.mesh == mesh) found = &channel;
  return found;
}

Vec3 posed_vertex(const SceneMesh& mesh, const Affine& node, const std::vector<Affine>& joints,
                  const std::vector<double>& morph_weights, std::size_t v) {
  Vec3 p = mesh.positions[v];
  for (std::size_t t = 0; t < morph_weights.size(); ++t)
    if (morph_weights[t] != 0) p += morph_weights[t] * mesh.morphs[t][v];
  const bool is_skinned = !joints.empty() && mesh.influence_offsets[v] < mesh.influence_offsets[v + 1];
  if (!is_skinned) return node(p);
  Vec3 sum = Vec3::Zero();
  for (Index k = mesh.influence_offsets[v]; k < mesh.influence_offsets[v + 1]; ++k) {
    const SkinInfluence& influence = mesh.influences[static_cast<std::size_t>(k)];
    sum += influence.weight * joints[static_cast<std::size_t>(influence.joint)](p);
  }
  return sum;
}

void add(std::vector<double>& numbers, const Affine& map) {
  for (int k = 0; k < 9; ++k) numbers.push_back(map.linear(k / 3, k % 3));
  for (int k = 0; k < 3; ++k) numbers.push_back(map.offset[k]);
}

}  // namespace

SceneNodes::SceneNodes(const SceneAnimation& scene, const SceneClip* clip, const std::vector<Index>& wanted)
    : scene_(scene) {
  std::vector<bool> is_taken(scene.nodes.size(), false);
  for (Index n : wanted)
    for (; n >= 0 && !is_taken[static_cast<std::size_t>(n)]; n = scene.nodes[static_cast<std::size_t>(n)].parent)
      is_taken[static_cast<std::size_t>(n)] = true;
  for (std::size_t n = 0; n < is_taken.size(); ++n)
    if (is_taken[n]) numbers_.push_back(static_cast<Index>(n));
  channels_.resize(numbers_.size(), nullptr);
  if (clip == nullptr) return;
  for (const NodeChannel& channel : clip->nodes)
    if (is_taken[static_cast<std::size_t>(channel.node)]) channels_[place(channel.node)] = &channel;
}

std::size_t SceneNodes::place(Index node) const {
  return static_cast<std::size_t>(std::lower_bound(numbers_.begin(), numbers_.end(), node) - numbers_.begin());
}

std::vector<Affine> SceneNodes::at(double seconds) const {
  std::vector<Affine> maps;
  maps.reserve(numbers_.size());
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    const SceneNode& node = scene_.nodes[static_cast<std::size_t>(numbers_[k])];
    const Affine local = channels_[k] != nullptr ? local_at(*channels_[k], seconds) : node.rest;
    maps.push_back(node.parent >= 0 ? maps[place(node.parent)] * local : local);
  }
  return maps;
}

std::vector<Index> nodes_of_meshes(const SceneAnimation& scene, const std::vector<Index>& meshes) {
  std::vector<Index> nodes;
  for (const Index m : meshes) {
    const SceneMesh& mesh = scene.meshes[static_cast<std::size_t>(m)];
    nodes.push_back(mesh.node);
    for (const SkinJoint& joint : mesh.joints) nodes.push_back(joint.node);
  }
  return nodes;
}

SceneVertices::SceneVertices(const SceneAnimation& scene, const SceneClip* clip, std::vector<Index> meshes)
    : scene_(scene), meshes_(std::move(meshes)), nodes_(scene, clip, nodes_of_meshes(scene, meshes_)), first_{0} {
  for (const Index m : meshes_) {
    morphs_.push_back(morph_channel(clip, m));
    first_.push_back(first_.back() + static_cast<Index>(scene.meshes[static_cast<std::size_t>(m)].positions.size()));
  }
}

std::vector<std::vector<double>> SceneVertices::morph_weights(double seconds) const {
  std::vector<std::vector<double>> weights;
  for (std::size_t k = 0; k < meshes_.size(); ++k)
    weights.push_back(morphs_[k] != nullptr ? value_at(morphs_[k]->weights, seconds)
                                            : scene_.meshes[static_cast<std::size_t>(meshes_[k])].morph_weights);
  return weights;
}

std::vector<Vec3> SceneVertices::posed(const std::vector<Affine>& nodes,
                                       const std::vector<std::vector<double>>& morph_weights,
                                       std::span<const Index> vertices) const {
  std::vector<std::vector<Affine>> joints;
  for (const Index m : meshes_) joints.push_back(joint_maps(scene_.meshes[static_cast<std::size_t>(m)], nodes_, nodes));
  std::vector<Vec3> positions;
  positions.reserve(vertices.size());
  for (const Index v : vertices) {
    const auto k = static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), v) - first_.begin() - 1);
    const SceneMesh& mesh = scene_.meshes[static_cast<std::size_t>(meshes_[k])];
    positions.push_back(posed_vertex(mesh, nodes[nodes_.place(mesh.node)], joints[k], morph_weights[k],
                                     static_cast<std::size_t>(v - first_[k])));
  }
  return positions;
}

std::vector<Vec3> SceneVertices::at(double seconds, std::span<const Index> vertices) const {
  return posed(nodes_.at(seconds), morph_weights(seconds), vertices);
}

std::vector<Vec3> SceneVertices::rest() const {
  std::vector<Index> all(static_cast<std::size_t>(count()));
  std::iota(all.begin(), all.end(), Index{0});
  std::vector<std::vector<double>> weights;
  for (const Index m : meshes_) weights.push_back(scene_.meshes[static_cast<std::size_t>(m)].morph_weights);
  return posed(SceneNodes(scene_, nullptr, nodes_of_meshes(scene_, meshes_)).at(0), weights, all);
}

std::vector<double> SceneVertices::pose(double seconds) const {
  const std::vector<Affine> nodes = nodes_.at(seconds);
  const std::vector<std::vector<double>> weights = morph_weights(seconds);
  std::vector<double> numbers;
  for (std::size_t k = 0; k < meshes_.size(); ++k) {
    const SceneMesh& mesh = scene_.meshes[static_cast<std::size_t>(meshes_[k])];
    add(numbers, nodes[nodes_.place(mesh.node)]);
    for (const SkinJoint& joint : mesh.joints) add(numbers, nodes[nodes_.place(joint.node)]);
    numbers.insert(numbers.end(), weights[k].begin(), weights[k].end());
  }
  return numbers;
}

std::uint64_t SceneVertices::content() const {
  Fingerprint print;
  for (const Index m : meshes_) {
    const SceneMesh& mesh = scene_.meshes[static_cast<std::size_t>(m)];
    print.add(std::span<const Vec3>(mesh.positions));
    for (const auto& morph : mesh.morphs) print.add(std::span<const Vec3>(morph));
    for (const SkinJoint& joint : mesh.joints) print.add(joint.from_bind.linear).add(joint.from_bind.offset);
    print.add(std::span<const Index>(mesh.influence_offsets));
    for (const SkinInfluence& influence : mesh.influences) print.add(influence.joint).add(influence.weight);
  }
  return print.value();
}

std::vector<Triangle> SceneVertices::triangles() const {
  std::vector<Triangle> all;
  for (std::size_t k = 0; k < meshes_.size(); ++k)
    for (Triangle triangle : scene_.meshes[static_cast<std::size_t>(meshes_[k])].triangles) {
      for (Index& v : triangle) v += first_[k];
      all.push_back(triangle);
    }
  return all;
}

}  // namespace softreel
