/// Small animated glTF files for tests: JSON and its buffer side by side.
#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace softreel::testing {

/// Collects the numbers of a glTF file. Accessors are numbered as they are added.
class GltfBuffer {
 public:
  /// type: "SCALAR", "VEC3", "VEC4", "MAT4".
  int add_floats(const std::vector<float>& numbers, const std::string& type) {
    const std::size_t width = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
    std::string bounds;
    if (type == "VEC3") bounds = R"(, "min": [-1e3, -1e3, -1e3], "max": [1e3, 1e3, 1e3])";
    return add(numbers.data(), numbers.size() * sizeof(float), 5126, numbers.size() / width, type, bounds);
  }
  int add_indices(const std::vector<std::uint16_t>& indices) {
    return add(indices.data(), indices.size() * sizeof(std::uint16_t), 5123, indices.size(), "SCALAR", "");
  }
  /// Four joints a vertex.
  int add_joints(const std::vector<std::uint16_t>& joints) {
    return add(joints.data(), joints.size() * sizeof(std::uint16_t), 5123, joints.size() / 4, "VEC4", "");
  }

  /// Writes FILE.gltf and FILE.bin; `parts`: what the JSON holds beside buffers, as "key": value lines.
  std::string write(const std::string& folder, const std::string& name, const std::string& parts) const {
    std::ofstream(folder + "/" + name + ".bin", std::ios::binary) << bytes_;
    std::ofstream(folder + "/" + name + ".gltf") << fmt::format(R"({{ "asset": {{ "version": "2.0" }}, "scene": 0,
"buffers": [{{ "uri": "{}.bin", "byteLength": {} }}],
"bufferViews": [{}],
"accessors": [{}],
{} }})",
                                                                name, bytes_.size(), views_, accessors_, parts);
    return folder + "/" + name + ".gltf";
  }

 private:
  int add(const void* data, std::size_t size, int component, std::size_t count, const std::string& type,
          const std::string& bounds) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    const char* comma = count_ > 0 ? ",\n" : "";
    views_ += fmt::format(R"({}{{ "buffer": 0, "byteOffset": {}, "byteLength": {} }})", comma, bytes_.size(), size);
    accessors_ += fmt::format(R"({}{{ "bufferView": {}, "componentType": {}, "count": {}, "type": "{}"{} }})", comma,
                              count_, component, count, type, bounds);
    bytes_.append(static_cast<const char*>(data), size);
    return count_++;
  }

  std::string bytes_, views_, accessors_;
  int count_ = 0;
};

/// A node "jaw" under a node "head" that stands at (0, 1, 0); the jaw at (0, 0, 0.5) from there turns by 90 degrees
/// about x within the clip "open" of one second. head also carries a triangle.
inline std::string write_jaw(const std::string& folder, const std::string& name = "jaw",
                             const std::string& clip = "open") {
  GltfBuffer buffer;
  const int positions = buffer.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const int triangle = buffer.add_indices({0, 1, 2});
  const int times = buffer.add_floats({0, 1}, "SCALAR");
  const float half = 0.70710678f;
  const int turns = buffer.add_floats({0, 0, 0, 1, half, 0, 0, half}, "VEC4");
  return buffer.write(folder, name,
                      fmt::format(R"("scenes": [{{ "nodes": [0] }}],
"nodes": [{{ "name": "head", "translation": [0, 1, 0], "mesh": 0, "children": [1] }},
          {{ "name": "jaw", "translation": [0, 0, 0.5] }}],
"meshes": [{{ "name": "skull", "primitives": [{{ "attributes": {{ "POSITION": {} }}, "indices": {} }}] }}],
"animations": [{{ "name": "{}", "channels": [{{ "sampler": 0, "target": {{ "node": 1, "path": "rotation" }} }}],
                "samplers": [{{ "input": {}, "output": {}, "interpolation": "LINEAR" }}] }}])",
                                  positions, triangle, clip, times, turns));
}

/// A strip along y from 0 to 2, 0.2 wide, of 5 rows of 2 vertices: the joint "lower" at the origin holds the first
/// rows, "upper" at (0, 1, 0) the last ones, both the middle. In the clip "bend" of two seconds the upper one turns by
/// 90 degrees about z.
inline const std::vector<float>& strip_weights() {
  static const std::vector<float> upper{0, 0.25f, 0.5f, 0.75f, 1};
  return upper;
}
inline std::string write_strip(const std::string& folder, const std::string& name = "strip") {
  std::vector<float> positions, weights;
  std::vector<std::uint16_t> joints, indices;
  for (int row = 0; row < 5; ++row)
    for (const float x : {-0.1f, 0.1f}) {
      positions.insert(positions.end(), {x, 0.5f * static_cast<float>(row), 0});
      const float upper = strip_weights()[static_cast<std::size_t>(row)];
      weights.insert(weights.end(), {1 - upper, upper, 0, 0});
      joints.insert(joints.end(), {0, 1, 0, 0});
    }
  for (std::uint16_t row = 0; row < 4; ++row) {
    const auto v = static_cast<std::uint16_t>(2 * row);
    for (const int corner : {0, 1, 2, 1, 3, 2}) indices.push_back(static_cast<std::uint16_t>(v + corner));
  }
  GltfBuffer buffer;
  const int p = buffer.add_floats(positions, "VEC3"), w = buffer.add_floats(weights, "VEC4");
  const int j = buffer.add_joints(joints), i = buffer.add_indices(indices);
  const int bind = buffer.add_floats(
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1}, "MAT4");
  const int times = buffer.add_floats({0, 2}, "SCALAR");
  const float half = 0.70710678f;
  const int turns = buffer.add_floats({0, 0, 0, 1, 0, 0, half, half}, "VEC4");
  return buffer.write(folder, name,
                      fmt::format(R"("scenes": [{{ "nodes": [0, 2] }}],
"nodes": [{{ "name": "lower", "children": [1] }}, {{ "name": "upper", "translation": [0, 1, 0] }},
          {{ "name": "skin_node", "mesh": 0, "skin": 0 }}],
"skins": [{{ "joints": [0, 1], "inverseBindMatrices": {} }}],
"meshes": [{{ "name": "body_skin", "primitives": [{{ "attributes":
  {{ "POSITION": {}, "WEIGHTS_0": {}, "JOINTS_0": {} }}, "indices": {} }}] }}],
"animations": [{{ "name": "bend", "channels": [{{ "sampler": 0, "target": {{ "node": 1, "path": "rotation" }} }}],
                "samplers": [{{ "input": {}, "output": {} }}] }}])",
                                  bind, p, w, j, i, times, turns));
}

/// A triangle whose morph target "up" lifts its third vertex by 1 along y; in the clip "lift" of one second its weight
/// goes from 0 to 0.5.
inline std::string write_morph(const std::string& folder, const std::string& name = "morph") {
  GltfBuffer buffer;
  const int p = buffer.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const int d = buffer.add_floats({0, 0, 0, 0, 0, 0, 0, 1, 0}, "VEC3");
  const int i = buffer.add_indices({0, 1, 2});
  const int times = buffer.add_floats({0, 1}, "SCALAR"), weights = buffer.add_floats({0, 0.5f}, "SCALAR");
  return buffer.write(folder, name,
                      fmt::format(R"("scenes": [{{ "nodes": [0] }}],
"nodes": [{{ "name": "face", "mesh": 0 }}],
"meshes": [{{ "name": "face_mesh", "primitives": [{{ "attributes": {{ "POSITION": {} }}, "indices": {},
             "targets": [{{ "POSITION": {} }}] }}] }}],
"animations": [{{ "name": "lift", "channels": [{{ "sampler": 0, "target": {{ "node": 0, "path": "weights" }} }}],
                "samplers": [{{ "input": {}, "output": {} }}] }}])",
                                  p, i, d, times, weights));
}

}  // namespace softreel::testing
