/// GLSL of lit surfaces: what goes in and out at vertices and pixels. OpenGL 3.3.
#pragma once

namespace softreel {

/// Lamps are points with the irradiance of the rectangle's centre, wrapped around by its size; the environment lights
/// from the direction of the normal (diffuse) and of the reflection (gloss). Lights with a shadow map
/// fall only where no body is in between; the edges of their shadows are about as soft as the map's texels.
///
/// Software OpenGL computes both sides of every branch at every pixel, so shaders begin with "#version 330 core" and
/// #defines of what they need (all 0 or 1, if nothing else is said):
///   VIEW         0 standard, 1 filmic, 2 aces-fit, 3 raw;  SKY_IMAGE: the surroundings are an image
///   LAMPS, SUNS  how many there are, at least 1
///   LIGHTS(s)    the sum of from_lamp(k, layer, open, s) and from_sun of all lights, written out, as indices that are
///                known make it a sixth faster; layer: of the shadow map; -1: none
///   GROUND_HIDES    there is a light that the ground may hide: open is ground_open
///   SHADOWS      how many maps;  SHADOW_BLUR: texels
///   AT_VERTICES  lit at vertices, where triangles are about as small as pixels: software OpenGL shades whole blocks of
///                4 x 4 pixels for each triangle that touches them
///   GROUND, CHECKER, CATCHER    the ground, its pattern, only the shadow on it
///   COLOR_MAP, ROUGHNESS_MAP, NORMAL_MAP, BUMP_MAP    textures; MAPS: any of them
///   RICH         transmission, coat, sheen or a metal of its own colour
///   GLASS        what is behind shows through: two outputs, to blend as first + second * what is there
///   LINES        along the edges of triangles
inline constexpr const char* kSurfaceAttributes = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 color_of_vertex;
layout(location = 3) in vec3 coordinate;  // u, v upward, 1 where textures hold
layout(location = 4) in vec3 corner;      // barycentric
uniform mat4 clip_from_world;
#if GLASS
invariant gl_Position;  // depths are drawn first
#endif
uniform vec2 map_scale, map_offset;
vec3 placed(vec3 c) {
  vec2 at = map_scale * c.xy + map_offset;
  return vec3(at.x, 1.0 - at.y, c.z);
}
)";

inline constexpr const char* kPixelLitVertexShader = R"(
out vec3 world_position, world_normal, base_color;
#if MAPS
out vec3 place;
#endif
#if LINES
out vec3 corner_weights;
#endif
void main() {
  world_position = position;
  world_normal = normal;
  base_color = color_of_vertex;
#if MAPS
  place = placed(coordinate);
#endif
#if LINES
  corner_weights = corner;
#endif
  gl_Position = clip_from_world * vec4(position, 1.0);
}
)";

inline constexpr const char* kPixelLitInputs = R"(
#define FACE_NORMAL cross(dFdx(world_position), dFdy(world_position))
in vec3 world_position, world_normal, base_color;
#if MAPS
in vec3 place;
uniform sampler2D color_map, roughness_map, normal_map, bump_map;
uniform float normal_strength, bump_height;
#endif
#if LINES
in vec3 corner_weights;
uniform float line_width, line_share;
uniform vec3 line_color;

// How much of a pixel is on a line, as render/pathtrace/rays/edge_lines.h has them, by its distances to the edges.
float line_coverage() {
  vec3 dx = dFdx(corner_weights), dy = dFdy(corner_weights);
  vec3 slope = max(sqrt(dx * dx + dy * dy), 1e-6);  // 1 / heights of the triangle, pixels
  vec3 away = corner_weights / slope;
  float radius = 1.0 / (slope.x + slope.y + slope.z);
  float reach = min(0.5 * line_width, line_share * min(1.0, radius) * radius);
  vec3 covered = min(vec3(reach), away + 0.5) - max(vec3(-reach), away - 0.5);
  return clamp(max(covered.x, max(covered.y, covered.z)), 0.0, 1.0);
}
#endif
)";

inline constexpr const char* kPixelLitMain = R"(
#if GLASS
layout(location = 0, index = 0) out vec4 color;
layout(location = 0, index = 1) out vec4 passed;
#else
out vec4 color;
#endif
void main() {
  vec3 albedo = surface_color();
  light_surface(albedo);
#if CATCHER
  color = vec4(0.0, 0.0, 0.0, caught_shadow());
#elif GLASS
  color = vec4(before_glass(albedo), 1.0);
  passed = vec4(to_display_factor(through), 0.0);
#else
  color = vec4(display(seen_radiance(albedo)), 1.0);
#endif
}
)";

inline constexpr const char* kVertexLitInputs = R"(
#define FACE_NORMAL world_normal
vec3 world_position, world_normal, base_color;
)";

inline constexpr const char* kVertexLitMain = R"(
#if COLOR_MAP
out vec3 place, diffuse_shade, other_shade, own_color;
#else
out vec3 shade;
#endif
#if GLASS
out vec3 factor;
#endif
void main() {
  world_position = position;
  world_normal = normal;
  base_color = color_of_vertex;
  light_surface(base_color);
#if COLOR_MAP
  place = placed(coordinate);
  diffuse_shade = lit_diffuse;
  other_shade = lit_other;
  own_color = base_color;
#elif GLASS
  shade = before_glass(base_color);
#else
  shade = display(seen_radiance(base_color));
#endif
#if GLASS
  factor = to_display_factor(through);
#endif
  gl_Position = clip_from_world * vec4(position, 1.0);
}
)";

inline constexpr const char* kVertexLitFragmentShader = R"(
#if GLASS
in vec3 shade, factor;
layout(location = 0, index = 0) out vec4 color;
layout(location = 0, index = 1) out vec4 passed;
void main() {
  color = vec4(shade, 1.0);
  passed = vec4(factor, 0.0);
}
#elif COLOR_MAP
in vec3 place, diffuse_shade, other_shade, own_color;
uniform sampler2D color_map;
out vec4 color;
void main() {
  vec3 albedo = mix(own_color, texture(color_map, place.xy).rgb, place.z);
  color = vec4(display(albedo * diffuse_shade + other_shade), 1.0);
}
#else
in vec3 shade;
out vec4 color;
void main() { color = vec4(shade, 1.0); }
#endif
)";

}  // namespace softreel
