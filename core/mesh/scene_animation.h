/// The nodes of a scene file in time, and the meshes that they carry, skin and morph.
///
/// Linear-blend skinning: a vertex is at sum_j w_j G_j B_j v, with G_j the joint's node in the scene, B_j the inverse
/// of where that node was when the skin was bound, and v the morphed vertex: its base plus weighted displacements.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/animated_vertices.h"

namespace softreel {

/// p -> linear p + offset.
struct Affine {
  Mat3 linear = Mat3::Identity();
  Vec3 offset = Vec3::Zero();

  Vec3 operator()(const Vec3& p) const { return linear * p + offset; }
  Affine operator*(const Affine& inner) const { return {linear * inner.linear, linear * inner.offset + offset}; }
  bool operator==(const Affine&) const = default;
};

/// Values at rising times; before the first and after the last, that one holds, between them they blend linearly.
template <typename T>
struct Samples {
  std::vector<double> seconds;
  std::vector<T> values;
  bool empty() const { return values.empty(); }
};

struct SceneNode {
  std::string name;
  Index parent = -1;  ///< stands before its children; -1: none
  Affine rest;        ///< to the parent, without a clip
};

/// What a clip says of a node takes the place of all of its rest: a part without samples is 0, no turn or 1.
struct NodeChannel {
  Index node = 0;
  Samples<Vec3> translation;
  Samples<Quaternion> rotation;  ///< blended along the shorter arc
  Samples<Vec3> scale;
};

struct MorphChannel {
  Index mesh = 0;
  Samples<std::vector<double>> weights;  ///< per morph target
};

struct SceneClip {
  std::string name;  ///< its number where the file gives none
  double seconds = 0;
  std::vector<NodeChannel> nodes;
  std::vector<MorphChannel> morphs;
};

struct SkinJoint {
  Index node = 0;
  Affine from_bind;  ///< from the mesh as it was bound to the joint
};

struct SkinInfluence {
  Index joint = 0;
  double weight = 0;
};

/// A mesh under a node, in the order in which import_mesh puts the file's meshes together.
struct SceneMesh {
  std::string name;
  Index node = 0;
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;        ///< polygons cut as fans
  std::vector<std::vector<Vec3>> morphs;  ///< per target, displacements of all vertices
  std::vector<double> morph_weights;      ///< per target, at rest
  std::vector<SkinJoint> joints;          ///< empty: the mesh moves with its node
  std::vector<Index> influence_offsets;   ///< vertices + 1; vertex v has influences [offsets[v], offsets[v + 1])
  std::vector<SkinInfluence> influences;  ///< weights of a vertex sum to 1; one without any moves with the node
};

struct SceneAnimation {
  std::vector<SceneNode> nodes;
  std::vector<SceneClip> clips;
  std::vector<SceneMesh> meshes;
};

/// Some nodes of a scene and those above them: posing them costs what they are, however many others there are.
class SceneNodes {
 public:
  /// scene, clip: kept by reference; clip null: they rest. wanted: numbers in scene.nodes.
  SceneNodes(const SceneAnimation& scene, const SceneClip* clip, const std::vector<Index>& wanted);

  /// The wanted nodes and those above them, rising.
  const std::vector<Index>& numbers() const { return numbers_; }
  /// Their maps to the scene, in the order of numbers(): the same bits whatever others are wanted.
  std::vector<Affine> at(double seconds) const;
  /// Where one of numbers() stands among them.
  std::size_t place(Index node) const;
  /// What the clip says of them, in the order of numbers(); null: nothing.
  const std::vector<const NodeChannel*>& channels() const { return channels_; }

 private:
  const SceneAnimation& scene_;
  std::vector<Index> numbers_;
  std::vector<const NodeChannel*> channels_;
};

/// The nodes that place the vertices of some meshes: their own, and the joints that they hang on.
std::vector<Index> nodes_of_meshes(const SceneAnimation& scene, const std::vector<Index>& meshes);

/// Some meshes of a scene, one after the other, moved by a clip.
class SceneVertices : public AnimatedVertices {
 public:
  /// scene, clip: kept by reference; clip null: they rest. meshes: numbers in scene.meshes.
  SceneVertices(const SceneAnimation& scene, const SceneClip* clip, std::vector<Index> meshes);

  Index count() const override { return first_.back(); }
  std::vector<Vec3> at(double seconds, std::span<const Index> vertices) const override;
  std::vector<Vec3> rest() const override;
  std::vector<double> pose(double seconds) const override;
  std::uint64_t content() const override;
  /// Of all meshes, by the numbers of the vertices here.
  std::vector<Triangle> triangles() const;

 private:
  std::vector<Vec3> posed(const std::vector<Affine>& nodes, const std::vector<std::vector<double>>& morph_weights,
                          std::span<const Index> vertices) const;
  std::vector<std::vector<double>> morph_weights(double seconds) const;

  const SceneAnimation& scene_;
  std::vector<Index> meshes_;
  SceneNodes nodes_;
  std::vector<const MorphChannel*> morphs_;  ///< per mesh what the clip says of it; null: nothing
  std::vector<Index> first_;                 ///< per mesh, its first vertex; then the number of all
};

}  // namespace softreel
