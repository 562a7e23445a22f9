/// What varies over a surface: textures, colours of vertices, values that are shown as heat.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// What a texture shows beyond its picture.
enum class TextureWrap : std::uint8_t { Repeat, Clamp, Mirror };

/// A picture and its halvings down to one texel (Williams, Pyramidal Parametrics, 1983). Texel: float or Vec3f.
template <typename Texel>
struct TexturePyramid {
  struct Level {
    int width = 0, height = 0;
    std::vector<Texel> texels;  ///< height x width, row 0 on top, where the texture coordinate v is 1
  };
  std::vector<Level> levels;  ///< [0]: the picture; back(): 1 x 1
};

using ColorTexture = TexturePyramid<Vec3f>;
using DataTexture = TexturePyramid<float>;

/// Textures of one material; null: the appearance's own value holds everywhere.
struct TextureMaps {
  std::shared_ptr<const ColorTexture> base_color;  ///< linear albedo in [0, 1]
  std::shared_ptr<const DataTexture> roughness;    ///< in [0, 1]
  std::shared_ptr<const ColorTexture> normal;      ///< x along u, y along v, z outward; about unit length
  std::shared_ptr<const DataTexture> bump;         ///< heights in units of bump_height
  TextureWrap wrap = TextureWrap::Repeat;
  Vec2f scale = Vec2f::Ones(), offset = Vec2f::Zero();  ///< place in the picture = scale * coordinate + offset
  float normal_strength = 1;                            ///< factor on x and y of the normals; 0: flat
  float bump_height = 0.01f;                            ///< m

  bool empty() const { return !base_color && !roughness && !normal && !bump; }
};

/// How the base colour of a mesh varies. The first of these that is there holds: heat, colors, maps.base_color.
struct SurfaceColoring {
  TextureMaps maps;
  std::vector<Vec2f> coordinates;   ///< texture coordinates, v upward
  std::vector<Triangle> triangles;  ///< into coordinates, per triangle corner; -1: without, the maps do not hold there
  std::vector<Vec3f> colors;        ///< per vertex, linear albedo
  std::vector<float> heat;          ///< per vertex, place in the colour map: 0 to 1, beyond it the ends hold

  bool empty() const { return maps.empty() && colors.empty() && heat.empty(); }
};

}  // namespace softreel
