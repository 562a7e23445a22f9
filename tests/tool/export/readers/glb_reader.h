/// A reader of animated GLB files for tests, written from the glTF 2.0 specification; it checks what the file says of
/// itself on the way.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace softreel::testing {

/// The one mesh of a file with its one animation of weights.
struct GlbScene {
  std::string header, binary;  ///< the chunks as they are: JSON and bytes
  std::string mesh_name, material_name;
  std::array<double, 3> translation{0, 0, 0}, scale{1, 1, 1};
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< x, y, z, w
  std::array<double, 4> base_color{1, 1, 1, 1};
  double metallic = 1, roughness = 1;
  std::vector<float> positions, normals, textures, colors;           ///< of the base
  std::vector<std::uint32_t> indices;                                ///< triangles
  std::vector<std::vector<float>> target_positions, target_normals;  ///< differences to the base
  std::vector<float> times;                                          ///< seconds, of the keys
  std::vector<std::vector<float>> weights;                           ///< per key, per target

  /// base + sum of weight times difference in float32, at a time between the keys.
  std::vector<float> positions_at(double seconds) const;
  std::vector<float> normals_at(double seconds) const;
};

/// Throws std::runtime_error where the file breaks a rule of the specification that it checks: chunks and their
/// padding, ranges and alignment of views and accessors, targets and strides of views, min and max, finite numbers,
/// times that grow, indices within the vertices, counts that agree.
GlbScene read_glb(const std::string& bytes);

}  // namespace softreel::testing
