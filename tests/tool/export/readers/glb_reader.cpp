#include "tests/tool/export/readers/glb_reader.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace softreel::testing {
namespace {

using Json = nlohmann::json;

void require(bool holds, const std::string& rule) {
  if (!holds) throw std::runtime_error("glb: " + rule);
}

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  require(at + 4 <= bytes.size(), "the file is too short");
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

struct Chunks {
  Json header;
  std::string binary;
};

Chunks read_chunks(const std::string& bytes) {
  require(bytes.substr(0, 4) == "glTF" && word_at(bytes, 4) == 2, "signature and version 2");
  require(word_at(bytes, 8) == bytes.size(), "the length of the file");
  const std::size_t header = word_at(bytes, 12);
  require(bytes.substr(16, 4) == "JSON" && header % 4 == 0, "the first chunk is JSON, padded to 4 bytes");
  Chunks chunks{Json::parse(bytes.substr(20, header)), {}};
  const std::size_t at = 20 + header, size = word_at(bytes, at);
  require(bytes.substr(at + 4, 4) == std::string("BIN\0", 4) && size % 4 == 0, "the second chunk is binary, padded");
  require(at + 8 + size == bytes.size(), "nothing behind the binary chunk");
  chunks.binary = bytes.substr(at + 8);
  require(chunks.header.at("buffers").size() == 1 && chunks.header["buffers"][0].at("byteLength") == size,
          "one buffer, of the binary chunk");
  return chunks;
}

/// What an accessor is for decides what its view must say.
enum class Use { Vertices, Indices, Other };

template <typename T>
std::vector<T> read_accessor(const Chunks& file, const Json& index, const std::string& type, Use use) {
  const Json& accessor = file.header.at("accessors").at(index.get<std::size_t>());
  const std::size_t components = type == "VEC3" ? 3 : type == "VEC2" ? 2 : 1;
  require(accessor.at("type") == type, "an accessor of type " + type);
  require(accessor.at("componentType") == (std::is_same_v<T, float> ? 5126 : 5125), "component type");
  const Json& view = file.header.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  const auto offset = view.value("byteOffset", std::size_t{0}), size = view.at("byteLength").get<std::size_t>();
  const auto count = accessor.at("count").get<std::size_t>();
  require(offset % 4 == 0 && offset + size <= file.binary.size(), "a view within the buffer, aligned");
  require(count > 0 && count * components * 4 == size, "an accessor that fills its view");
  if (use == Use::Vertices) require(view.value("target", 0) == 34962, "vertex data in an ARRAY_BUFFER");
  if (use == Use::Indices) require(view.value("target", 0) == 34963, "indices in an ELEMENT_ARRAY_BUFFER");
  if (use == Use::Other) require(!view.contains("target"), "no target of a view of animation data");
  if (use == Use::Vertices)
    require(view.value("byteStride", components * 4) == components * 4, "a stride of packed vertices");
  else
    require(!view.contains("byteStride"), "strides of vertex data only");
  std::vector<T> values(count * components);
  std::memcpy(values.data(), file.binary.data() + offset, size);
  if constexpr (std::is_same_v<T, float>)
    for (const float value : values) require(std::isfinite(value), "finite numbers");
  return values;
}

/// The accessor's min and max are exactly those of its values.
void require_bounds(const Chunks& file, const Json& index, const std::vector<float>& values) {
  const Json& accessor = file.header.at("accessors").at(index.get<std::size_t>());
  const auto low = accessor.at("min").get<std::vector<double>>(), high = accessor.at("max").get<std::vector<double>>();
  std::vector<double> least(low.size(), INFINITY), most(low.size(), -INFINITY);
  for (std::size_t i = 0; i < values.size(); ++i) {
    least[i % low.size()] = std::min(least[i % low.size()], double{values[i]});
    most[i % low.size()] = std::max(most[i % low.size()], double{values[i]});
  }
  require(low == least && high == most, "min and max of an accessor");
}

void read_mesh(const Chunks& file, GlbScene& scene) {
  require(file.header.at("meshes").size() == 1, "one mesh");
  const Json& mesh = file.header["meshes"][0];
  scene.mesh_name = mesh.value("name", "");
  require(mesh.at("primitives").size() == 1, "one primitive");
  const Json& primitive = mesh["primitives"][0];
  require(primitive.value("mode", 4) == 4, "triangles");
  const Json& attributes = primitive.at("attributes");
  scene.positions = read_accessor<float>(file, attributes.at("POSITION"), "VEC3", Use::Vertices);
  require_bounds(file, attributes["POSITION"], scene.positions);
  if (attributes.contains("NORMAL"))
    scene.normals = read_accessor<float>(file, attributes["NORMAL"], "VEC3", Use::Vertices);
  if (attributes.contains("TEXCOORD_0"))
    scene.textures = read_accessor<float>(file, attributes["TEXCOORD_0"], "VEC2", Use::Vertices);
  if (attributes.contains("COLOR_0"))
    scene.colors = read_accessor<float>(file, attributes["COLOR_0"], "VEC3", Use::Vertices);
  scene.indices = read_accessor<std::uint32_t>(file, primitive.at("indices"), "SCALAR", Use::Indices);
  require(scene.indices.size() % 3 == 0, "whole triangles");
  const std::size_t vertices = scene.positions.size() / 3;
  for (const std::uint32_t index : scene.indices) require(index < vertices, "indices of vertices");
  require(scene.normals.empty() || scene.normals.size() == 3 * vertices, "as many normals as positions");
  require(scene.textures.empty() || scene.textures.size() == 2 * vertices, "as many coordinates as positions");
  require(scene.colors.empty() || scene.colors.size() == 3 * vertices, "as many colours as positions");
  for (const float value : scene.colors) require(value >= 0 && value <= 1, "colours from 0 to 1");
  for (const Json& target : primitive.at("targets")) {
    scene.target_positions.push_back(read_accessor<float>(file, target.at("POSITION"), "VEC3", Use::Vertices));
    require_bounds(file, target["POSITION"], scene.target_positions.back());
    require(scene.target_positions.back().size() == 3 * vertices, "targets as large as the base");
    require(target.contains("NORMAL") == !scene.normals.empty(), "normals in all targets or in none");
    if (!target.contains("NORMAL")) continue;
    scene.target_normals.push_back(read_accessor<float>(file, target["NORMAL"], "VEC3", Use::Vertices));
    require(scene.target_normals.back().size() == 3 * vertices, "targets as large as the base");
  }
  require(mesh.at("extras").at("targetNames").size() == scene.target_positions.size(), "a name for each target");
  const Json& material = file.header.at("materials").at(primitive.at("material").get<std::size_t>());
  const Json& look = material.at("pbrMetallicRoughness");
  scene.material_name = material.value("name", "");
  scene.base_color = look.value("baseColorFactor", scene.base_color);
  scene.metallic = look.value("metallicFactor", 1.0);
  scene.roughness = look.value("roughnessFactor", 1.0);
}

void read_node(const Chunks& file, GlbScene& scene) {
  require(file.header.at("nodes").size() == 1, "one node");
  const Json& node = file.header["nodes"][0];
  require(!node.contains("matrix"), "no matrix of an animated node");
  require(node.at("mesh") == 0, "the node holds the mesh");
  scene.translation = node.value("translation", scene.translation);
  scene.scale = node.value("scale", scene.scale);
  scene.rotation = node.value("rotation", scene.rotation);
  require(file.header.at("scenes").at(file.header.at("scene").get<std::size_t>()).at("nodes") == Json::array({0}),
          "the scene holds the node");
}

void read_animation(const Chunks& file, GlbScene& scene) {
  require(file.header.at("animations").size() == 1, "one animation");
  const Json& animation = file.header["animations"][0];
  require(animation.at("channels").size() == 1, "one channel");
  const Json& target = animation["channels"][0].at("target");
  require(target.at("path") == "weights" && target.at("node") == 0, "weights of the node are animated");
  const Json& sampler = animation.at("samplers").at(animation["channels"][0].at("sampler").get<std::size_t>());
  require(sampler.value("interpolation", "LINEAR") == "LINEAR", "linear interpolation");
  scene.times = read_accessor<float>(file, sampler.at("input"), "SCALAR", Use::Other);
  require_bounds(file, sampler["input"], scene.times);
  require(scene.times[0] >= 0, "no time before 0");
  for (std::size_t k = 1; k < scene.times.size(); ++k) require(scene.times[k] > scene.times[k - 1], "times that grow");
  const std::vector<float> all = read_accessor<float>(file, sampler.at("output"), "SCALAR", Use::Other);
  const std::size_t targets = scene.target_positions.size();
  require(all.size() == targets * scene.times.size(), "a weight of each target at each key");
  for (std::size_t k = 0; k < scene.times.size(); ++k)
    scene.weights.emplace_back(all.begin() + static_cast<std::ptrdiff_t>(k * targets),
                               all.begin() + static_cast<std::ptrdiff_t>((k + 1) * targets));
}

std::vector<float> blended(const GlbScene& scene, double seconds, const std::vector<float>& base,
                           const std::vector<std::vector<float>>& targets) {
  const auto after = std::lower_bound(scene.times.begin(), scene.times.end(), static_cast<float>(seconds));
  const auto last = static_cast<std::ptrdiff_t>(scene.times.size()) - 1;
  const auto b = static_cast<std::size_t>(std::min(after - scene.times.begin(), last));
  const std::size_t a = b == 0 || scene.times[b] <= static_cast<float>(seconds) ? b : b - 1;
  const float share = a == b ? 0 : (static_cast<float>(seconds) - scene.times[a]) / (scene.times[b] - scene.times[a]);
  std::vector<float> result = base;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const float weight = (1 - share) * scene.weights[a][t] + share * scene.weights[b][t];
    if (weight == 0) continue;
    for (std::size_t i = 0; i < result.size(); ++i) result[i] += weight * targets[t][i];
  }
  return result;
}

}  // namespace

std::vector<float> GlbScene::positions_at(double seconds) const {
  return blended(*this, seconds, positions, target_positions);
}

std::vector<float> GlbScene::normals_at(double seconds) const {
  return blended(*this, seconds, normals, target_normals);
}

GlbScene read_glb(const std::string& bytes) {
  const Chunks file = read_chunks(bytes);
  require(file.header.at("asset").at("version") == "2.0", "version 2.0");
  GlbScene scene;
  scene.header = file.header.dump();
  scene.binary = file.binary;
  read_mesh(file, scene);
  read_node(file, scene);
  read_animation(file, scene);
  return scene;
}

}  // namespace softreel::testing
