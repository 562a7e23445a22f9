/// Nodes, clips, skins and morph targets out of assimp; assimp_reader.cpp reads the shapes of bodies.
#include "core/mesh/readers/assimp_scene_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "core/mesh/readers/assimp_loading.h"
#include "core/mesh/readers/mesh_source.h"

namespace softreel::detail {
namespace {

Vec3 to_vector(const aiVector3D& v) {
  return {double{v.x}, double{v.y}, double{v.z}};
}

Affine to_affine(const aiMatrix4x4& m) {
  Affine map;
  map.linear << double{m.a1}, double{m.a2}, double{m.a3}, double{m.b1}, double{m.b2}, double{m.b3}, double{m.c1},
      double{m.c2}, double{m.c3};
  map.offset << double{m.a4}, double{m.b4}, double{m.c4};
  return map;
}

bool is_finite(const Affine& map) {
  return map.linear.allFinite() && map.offset.allFinite();
}

bool is_finite(const Vec3& v) {
  return v.allFinite();
}

bool is_finite(const Quaternion& q) {
  return q.coeffs().allFinite();
}

bool is_finite(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

Error contradiction(const std::string& path, const std::string& problem) {
  return unusable_file(path, problem, "Export the scene again");
}

bool is_same(const Quaternion& a, const Quaternion& b) {
  return a.coeffs() == b.coeffs();
}

template <typename T>
bool is_same(const T& a, const T& b) {
  return a == b;
}

/// Of two different values at one time the first holds until just before it. Exporters also repeat whole keys.
template <typename T>
void add_sample(Samples<T>& samples, double seconds, T value) {
  std::vector<double>& times = samples.seconds;
  if (!times.empty() && seconds == times.back()) {
    if (is_same(samples.values.back(), value)) return;
    const double before = std::nextafter(seconds, -std::numeric_limits<double>::infinity());
    if (times.size() > 1 && times[times.size() - 2] >= before) {
      samples.values.back() = std::move(value);  // the third of one time, or more
      return;
    }
    times.back() = before;
  }
  times.push_back(seconds);
  samples.values.push_back(std::move(value));
}

/// Puts our scene together; checks every index and number that it follows.
class SceneReader {
 public:
  SceneReader(const aiScene& scene, const std::string& path) : from_(scene), path_(path) {}

  SceneAnimation read() {
    if (from_.mRootNode != nullptr) add_node(*from_.mRootNode, -1);
    for (std::size_t m = 0; m < sources_.size(); ++m) add_skin(*sources_[m], to_.meshes[m]);
    for (unsigned c = 0; c < from_.mNumAnimations; ++c)
      if (from_.mAnimations[c] != nullptr) add_clip(*from_.mAnimations[c], c);
    return std::move(to_);
  }

 private:
  void add_node(const aiNode& node, Index parent) {
    const auto number = static_cast<Index>(to_.nodes.size());
    to_.nodes.push_back({node.mName.C_Str(), parent, to_affine(node.mTransformation)});
    if (!is_finite(to_.nodes.back().rest))
      throw contradiction(path_, fmt::format("the place of node '{}' is not finite", node.mName.C_Str()));
    node_of_.try_emplace(node.mName.C_Str(), number);
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      if (node.mMeshes[m] >= from_.mNumMeshes || from_.mMeshes[node.mMeshes[m]] == nullptr)
        throw contradiction(path_, fmt::format("a node has mesh {} of {}", node.mMeshes[m], from_.mNumMeshes));
      add_mesh(*from_.mMeshes[node.mMeshes[m]], number);
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c)
      if (node.mChildren[c] != nullptr) add_node(*node.mChildren[c], number);
  }

  void add_mesh(const aiMesh& from, Index node) {
    SceneMesh mesh;
    mesh.name = from.mName.C_Str();
    mesh.node = node;
    for (unsigned v = 0; v < from.mNumVertices; ++v) {
      mesh.positions.push_back(to_vector(from.mVertices[v]));
      if (!mesh.positions.back().allFinite())
        throw contradiction(path_, fmt::format("vertex {} of mesh '{}' is nowhere", v, mesh.name));
    }
    for (unsigned f = 0; f < from.mNumFaces; ++f) {
      const aiFace& face = from.mFaces[f];
      for (unsigned k = 0; k < face.mNumIndices; ++k)
        if (face.mIndices[k] >= from.mNumVertices)
          throw contradiction(path_, fmt::format("a face of mesh '{}' refers to vertex {} of {}", mesh.name,
                                                 face.mIndices[k], from.mNumVertices));
      for (unsigned k = 2; k < face.mNumIndices; ++k)
        mesh.triangles.push_back({static_cast<Index>(face.mIndices[0]), static_cast<Index>(face.mIndices[k - 1]),
                                  static_cast<Index>(face.mIndices[k])});
    }
    for (unsigned t = 0; t < from.mNumAnimMeshes; ++t) {
      const aiAnimMesh& target = *from.mAnimMeshes[t];
      std::vector<Vec3>& displacements = mesh.morphs.emplace_back(mesh.positions.size(), Vec3::Zero());
      mesh.morph_weights.push_back(double{target.mWeight});
      if (target.mVertices == nullptr) continue;
      if (target.mNumVertices != from.mNumVertices)
        throw contradiction(path_, fmt::format("a morph target of mesh '{}' has {} vertices, the mesh {}", mesh.name,
                                               target.mNumVertices, from.mNumVertices));
      for (unsigned v = 0; v < from.mNumVertices; ++v) {
        displacements[v] = to_vector(target.mVertices[v]) - mesh.positions[v];
        if (!displacements[v].allFinite())
          throw contradiction(path_, fmt::format("vertex {} of a morph target of mesh '{}' is nowhere", v, mesh.name));
      }
    }
    to_.meshes.push_back(std::move(mesh));
    sources_.push_back(&from);
  }

  Index find_node(const char* name, const std::string& what) const {
    const auto found = node_of_.find(name);
    if (found == node_of_.end())
      throw contradiction(path_, fmt::format("{} is '{}', but no node has this name", what, name));
    return found->second;
  }

  /// Weights are brought to a sum of 1, as the formats ask for.
  void add_skin(const aiMesh& from, SceneMesh& mesh) const {
    if (!from.HasBones()) return;
    std::vector<std::vector<SkinInfluence>> of_vertex(mesh.positions.size());
    for (unsigned b = 0; b < from.mNumBones; ++b) {
      const aiBone& bone = *from.mBones[b];
      const auto joint = static_cast<Index>(mesh.joints.size());
      mesh.joints.push_back({find_node(bone.mName.C_Str(), fmt::format("a joint of mesh '{}'", mesh.name)),
                             to_affine(bone.mOffsetMatrix)});
      if (!is_finite(mesh.joints.back().from_bind))
        throw contradiction(
            path_, fmt::format("where joint '{}' was bound to mesh '{}' is not finite", bone.mName.C_Str(), mesh.name));
      for (unsigned k = 0; k < bone.mNumWeights; ++k) {
        const aiVertexWeight& weight = bone.mWeights[k];
        if (weight.mVertexId >= from.mNumVertices || !std::isfinite(weight.mWeight))
          throw contradiction(path_, fmt::format("joint '{}' has weight {} at vertex {} of {}", bone.mName.C_Str(),
                                                 weight.mWeight, weight.mVertexId, from.mNumVertices));
        if (weight.mWeight > 0) of_vertex[weight.mVertexId].push_back({joint, double{weight.mWeight}});
      }
    }
    mesh.influence_offsets.push_back(0);
    for (const std::vector<SkinInfluence>& influences : of_vertex) {
      double sum = 0;
      for (const SkinInfluence& influence : influences) sum += influence.weight;
      for (const SkinInfluence& influence : influences)
        mesh.influences.push_back({influence.joint, influence.weight / sum});
      mesh.influence_offsets.push_back(static_cast<Index>(mesh.influences.size()));
    }
  }

  /// In ticks a second; 0 says nothing: glTF counts milliseconds then, and assimp's own programs take 25 for the rest.
  double ticks_per_second(const aiAnimation& clip) const {
    if (clip.mTicksPerSecond > 0) return clip.mTicksPerSecond;
    const std::string extension = lower_extension(path_);
    return extension == ".gltf" || extension == ".glb" ? 1000.0 : 25.0;
  }

  void add_clip(const aiAnimation& from, unsigned number) {
    SceneClip clip;
    clip.name = from.mName.length > 0 ? std::string(from.mName.C_Str()) : fmt::format("{}", number);
    const double ticks = ticks_per_second(from);
    for (unsigned c = 0; c < from.mNumChannels; ++c) {
      const aiNodeAnim& channel = *from.mChannels[c];
      NodeChannel out;
      out.node = find_node(channel.mNodeName.C_Str(), fmt::format("what clip '{}' moves", clip.name));
      const auto vector = [](const aiVectorKey& key) { return to_vector(key.mValue); };
      const auto turn = [](const aiQuatKey& key) {
        return Quaternion(double{key.mValue.w}, double{key.mValue.x}, double{key.mValue.y}, double{key.mValue.z})
            .normalized();
      };
      const std::string node = fmt::format(" of node '{}'", channel.mNodeName.C_Str());
      read_keys(channel.mPositionKeys, channel.mNumPositionKeys, ticks, "translation" + node, vector, clip,
                out.translation);
      read_keys(channel.mRotationKeys, channel.mNumRotationKeys, ticks, "rotation" + node, turn, clip, out.rotation);
      read_keys(channel.mScalingKeys, channel.mNumScalingKeys, ticks, "scale" + node, vector, clip, out.scale);
      clip.nodes.push_back(std::move(out));
    }
    for (unsigned c = 0; c < from.mNumMorphMeshChannels; ++c) add_morphs(*from.mMorphMeshChannels[c], ticks, clip);
    to_.clips.push_back(std::move(clip));
  }

  /// Keys that come before the one before them are left out; two of one time are a step. What they key is only for
  /// messages.
  template <typename Key, typename Value, typename T>
  void read_keys(const Key* keys, unsigned count, double ticks, const std::string& what, const Value& value,
                 SceneClip& clip, Samples<T>& samples) const {
    for (unsigned k = 0; k < count; ++k) {
      const double seconds = keys[k].mTime / ticks;
      if (!std::isfinite(seconds))
        throw contradiction(
            path_, fmt::format("in clip '{}', the time of key {} of the {} is not finite", clip.name, k, what));
      if (!samples.empty() && seconds < samples.seconds.back()) continue;
      T sample = value(keys[k]);
      if (!is_finite(sample))
        throw contradiction(path_, fmt::format("in clip '{}', the value of key {} of the {}, at {:g} s, is not finite",
                                               clip.name, k, what, seconds));
      add_sample(samples, seconds, std::move(sample));
      clip.seconds = std::max(clip.seconds, seconds);
    }
  }

  /// The meshes that a channel of morph weights moves. It names a node, or (FBX) a mesh, with a number behind '*'. A
  /// mesh may have the name of another one's node, so that the names of meshes count only where no node has it.
  std::vector<std::size_t> morphed_meshes(const std::string& name) const {
    const std::string mesh_name = name.substr(0, name.find('*'));
    const auto node_name = [&](const SceneMesh& mesh) { return to_.nodes[static_cast<std::size_t>(mesh.node)].name; };
    std::vector<std::size_t> of_node, of_mesh, of_numbered;
    for (std::size_t m = 0; m < to_.meshes.size(); ++m) {
      const SceneMesh& mesh = to_.meshes[m];
      if (mesh.morphs.empty()) continue;
      if (node_name(mesh) == name) of_node.push_back(m);
      if (mesh.name == mesh_name) of_mesh.push_back(m);
      if (node_name(mesh) == mesh_name) of_numbered.push_back(m);
    }
    return !of_node.empty() ? of_node : !of_mesh.empty() ? of_mesh : of_numbered;
  }

  void add_morphs(const aiMeshMorphAnim& channel, double ticks, SceneClip& clip) {
    for (const std::size_t m : morphed_meshes(channel.mName.C_Str())) {
      const SceneMesh& mesh = to_.meshes[m];
      MorphChannel out{static_cast<Index>(m), {}};
      const auto weights = [&](const aiMeshMorphKey& key) {
        std::vector<double> of_target(mesh.morphs.size(), 0.0);
        for (unsigned k = 0; k < key.mNumValuesAndWeights; ++k)
          if (key.mValues[k] < of_target.size()) of_target[key.mValues[k]] = key.mWeights[k];
        return of_target;
      };
      read_keys(channel.mKeys, channel.mNumKeys, ticks, fmt::format("morph weights of mesh '{}'", mesh.name), weights,
                clip, out.weights);
      if (!out.weights.empty()) clip.morphs.push_back(std::move(out));
    }
  }

  const aiScene& from_;
  const std::string& path_;
  SceneAnimation to_;
  std::map<std::string, Index> node_of_;  ///< the first of several of one name
  std::vector<const aiMesh*> sources_;    ///< of to_.meshes
};

}  // namespace

SceneAnimation softreel_read_scene_with_assimp(const std::string& path) {
  Assimp::Importer importer;
  std::string problem;
  const aiScene* scene = load_scene(importer, path, problem);
  if (scene == nullptr)
    throw contradiction(path, "the scene cannot be read: " + problem.substr(0, problem.find_last_not_of(".\n ") + 1));
  return SceneReader(*scene, path).read();
}

}  // namespace softreel::detail
