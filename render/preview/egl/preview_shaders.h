/// GLSL programs of the preview: lit surfaces, background, shadows and edges, marks. OpenGL 3.3.
#pragma once

namespace softreel {

inline constexpr int kMaxPreviewLamps = 8;
inline constexpr int kMaxPreviewSuns = 4;
inline constexpr int kMaxPreviewShadows = 4;
inline constexpr int kShadowSize = 1024;  ///< pixels of a shadow map's edge

/// The environment's gradient; an image is summed up by three colours. Shaders that use it begin with "#version 330
/// core" and #defines, because software OpenGL computes both sides of every branch at every pixel: VIEW (0 standard, 1
/// filmic, 2 aces-fit, 3 raw), and for surfaces GROUND (0, 1), CHECKER (0, 1), SHADOWS (how many
/// maps), SHADOW_BLUR (texels), AT_VERTICES (0, 1), and LIGHTS(skin): the sum of from_lamp(k, layer, skin) and from_sun
/// of all lights, written out, as indices that are known make it a sixth faster there. layer: of the shadow map; -1:
/// none.
inline constexpr const char* kEnvironmentFunctions = R"(
uniform vec3 zenith, horizon, nadir;
vec3 environment(float height) {
  return mix(horizon, height > 0.0 ? zenith : nadir, abs(height));
}
)";

/// Display values, as apply_view of render/image/view_transform.h.
inline constexpr const char* kDisplayFunctions = R"(
uniform float exposure_scale;
vec3 aces_fit(vec3 linear) {
  const mat3 into = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
  const mat3 back = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
  vec3 a = into * min(linear, 1e6);
  return back * ((a * (a + 0.0245786) - 0.000090537) / (a * (0.983729 * a + 0.4329510) + 0.238081));
}
vec3 to_srgb(vec3 c) {
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}
vec3 display(vec3 radiance) {
  vec3 c = max(exposure_scale * radiance, 0.0);
#if VIEW == 1
  float peak = max(c.r, max(c.g, c.b));
  if (peak > 0.76) {
    float compressed = 1.0 - 0.24 * 0.24 / (peak + 0.24 - 0.76);
    float whiteness = 1.0 - 1.0 / (0.15 * (peak - compressed) + 1.0);
    c = mix(c * (compressed / peak), vec3(compressed), whiteness);
  }
#elif VIEW == 2
  c = aces_fit(c);
#endif
  c = clamp(c, 0.0, 1.0);
#if VIEW == 3
  return c;
#else
  return to_srgb(c);
#endif
}
)";

inline constexpr const char* kBackgroundVertexShader = R"(#version 330 core
uniform vec3 forward, right, up;  // right and up as long as half the window one metre ahead
out vec3 direction;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  direction = forward + corner.x * right + corner.y * up;
  gl_Position = vec4(corner, 1.0, 1.0);
}
)";

inline constexpr const char* kBackgroundFragmentShader = R"(
in vec3 direction;
out vec4 color;
void main() {
  color = vec4(display(environment(normalize(direction).y)), 1.0);
}
)";

/// Lamps are points with the irradiance of the rectangle's centre, wrapped around by its size; the environment lights
/// by its gradient in the direction of the normal (diffuse) and of the reflection (gloss). Lights with a shadow map
/// fall only where no body is in between; the edges of their shadows are about as soft as the map's texels.
///
/// kSurfaceFunctions need world_position, world_normal and base_color, which the pair of shaders around them says: they
/// are lit at pixels, or at vertices where triangles are about as small as pixels. Software OpenGL shades whole blocks
/// of 4 x 4 pixels for each triangle that touches them.
inline constexpr const char* kSurfaceAttributes = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 color_of_vertex;
uniform mat4 clip_from_world;
)";

inline constexpr const char* kPixelLitVertexShader = R"(
out vec3 world_position, world_normal, base_color;
void main() {
  world_position = position;
  world_normal = normal;
  base_color = color_of_vertex;
  gl_Position = clip_from_world * vec4(position, 1.0);
}
)";

inline constexpr const char* kPixelLitInputs = R"(
#define FACE_NORMAL cross(dFdx(world_position), dFdy(world_position))
in vec3 world_position, world_normal, base_color;
)";

inline constexpr const char* kPixelLitMain = R"(
out vec4 color;
void main() { color = vec4(display(seen_radiance()), 1.0); }
)";

inline constexpr const char* kVertexLitInputs = R"(
#define FACE_NORMAL world_normal
vec3 world_position, world_normal, base_color;
)";

inline constexpr const char* kVertexLitMain = R"(
out vec3 shade;
void main() {
  world_position = position;
  world_normal = normal;
  base_color = color_of_vertex;
  shade = display(seen_radiance());
  gl_Position = clip_from_world * vec4(position, 1.0);
}
)";

inline constexpr const char* kVertexLitFragmentShader = R"(#version 330 core
in vec3 shade;
out vec4 color;
void main() { color = vec4(shade, 1.0); }
)";

inline constexpr const char* kSurfaceFunctions = R"(
uniform vec3 eye;
uniform vec3 emission;
uniform float roughness, metallic, specular, transmission;
uniform bool flat_normals;
uniform bool upright_ground;          // the pattern follows world axes
uniform float checker, ground_height, sweep, fade_start, fade_end;
uniform vec3 checker_color, across, along;
uniform vec3 lamp_center[8], lamp_normal[8], lamp_radiance[8];
uniform float lamp_area[8];
uniform vec3 sun_towards[4], sun_irradiance[4];
uniform sampler2DArrayShadow shadow_maps;
uniform mat4 shadow_from_world[4];
uniform float shadow_share;      // a texel, share of a map's edge
uniform float shadow_texel[4];   // m, edge of a texel where the bodies are

const float kPi = 3.14159265;

vec3 surface_color() {
#if CHECKER
  float x = dot(world_position, across), y = dot(world_position, along);
  if (!upright_ground && y > sweep) {
    float radius = 0.5 * sweep, rise = world_position.y - ground_height;
    y = rise < radius ? sweep + radius * atan(y - sweep, radius - rise) : sweep + radius * 0.5 * kPi + (rise - radius);
  }
  return mod(floor(x / checker) + floor(y / checker), 2.0) == 1.0 ? checker_color : base_color;
#else
  return base_color;
#endif
}

vec3 reflectance(vec3 f0, float cosine) {
  float rest = 1.0 - cosine;
  return f0 + (max(vec3(1.0 - roughness), f0) - f0) * (rest * rest * rest * rest * rest);
}

// GGX highlight times pi, with the visibility of Karis 2013.
float highlight(vec3 n, vec3 v, vec3 l, float alpha) {
  vec3 h = normalize(v + l);
  float nh = max(dot(n, h), 0.0), nv = max(dot(n, v), 1e-3), nl = max(dot(n, l), 1e-3);
  float a2 = alpha * alpha, t = nh * nh * (a2 - 1.0) + 1.0, k = 0.5 * alpha;
  return a2 / (t * t) * 0.25 / ((nv * (1.0 - k) + k) * (nl * (1.0 - k) + k));
}

// Share of a light that reaches the surface. At pixels: two taps, each the mean of four texels; more cost too much in
// software. At vertices, which are few, twelve in a spiral of equal areas (Vogel): a sharp edge would have teeth there.
float reached(int layer, vec3 n) {
#if SHADOWS == 0
  return 1.0;
#else
  if (layer < 0) return 1.0;
  float offset = (2.5 + SHADOW_BLUR) * shadow_texel[layer];  // along the normal, so that no surface shades itself
  vec4 seen = shadow_from_world[layer] * vec4(world_position + offset * n, 1.0);
  if (seen.w <= 0.0) return 1.0;
  vec3 at = 0.5 * seen.xyz / seen.w + 0.5;
  if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0))) || at.z <= 0.0) return 1.0;
  float z = min(at.z, 1.0), blur = SHADOW_BLUR * shadow_share;
#if AT_VERTICES
  float sum = 0.0;
  for (int k = 0; k < 12; ++k) {
    float radius = blur * sqrt((float(k) + 0.5) / 12.0), angle = 2.39996323 * float(k);
    sum += textureGrad(shadow_maps, vec4(at.xy + radius * vec2(cos(angle), sin(angle)), layer, z), vec2(0.0), vec2(0.0));
  }
  return sum / 12.0;
#else
  vec2 r = blur * vec2(0.8, 0.6);
  return 0.5 * (texture(shadow_maps, vec4(at.xy + r, layer, z)) + texture(shadow_maps, vec4(at.xy - r, layer, z)));
#endif
#endif
}

struct Skin {
  vec3 n, v, f0, diffuse;
  float alpha;
};

vec3 from_lamp(int k, int shadow, Skin s) {
  vec3 to = lamp_center[k] - world_position;
  float squared = dot(to, to);
  vec3 l = to * inversesqrt(squared);
  // A sphere has no normal, and faces everything.
  float facing = lamp_normal[k] == vec3(0.0) ? 1.0 : max(-dot(l, lamp_normal[k]), 0.0);
  vec3 irradiance = lamp_radiance[k] * (lamp_area[k] * facing / (squared + 0.25 * lamp_area[k]));
  float widened = min(1.0, s.alpha + 0.25 * sqrt(lamp_area[k] / squared));
  float narrow = (s.alpha * s.alpha) / (widened * widened);  // the same energy over a wider highlight
  vec3 gloss = reflectance(s.f0, max(dot(s.v, normalize(s.v + l)), 0.0)) * highlight(s.n, s.v, l, widened) * mix(narrow, 1.0, 0.5);
  return reached(shadow, s.n) * irradiance / kPi * max(dot(s.n, l), 0.0) * (s.diffuse + gloss);
}

vec3 from_sun(int k, int shadow, Skin s) {
  vec3 l = sun_towards[k];
  vec3 gloss = reflectance(s.f0, max(dot(s.v, normalize(s.v + l)), 0.0)) * highlight(s.n, s.v, l, s.alpha);
  return reached(shadow, s.n) * sun_irradiance[k] / kPi * max(dot(s.n, l), 0.0) * (s.diffuse + gloss);
}

vec3 seen_radiance() {
  vec3 albedo = surface_color();
  vec3 v = normalize(eye - world_position);
  vec3 n = normalize(flat_normals ? FACE_NORMAL : world_normal);
  // The back of a sheet; or a front whose smooth normal points a little away, as near outlines.
  float side = dot(n, v);
  n = side < -0.3 ? -n : normalize(n - min(side, 0.0) * v);
  vec3 f0 = mix(vec3(0.08 * specular), albedo, metallic);
  vec3 diffuse = albedo * (1.0 - metallic) * (1.0 - 0.6 * transmission);
  Skin skin = Skin(n, v, f0, diffuse, max(roughness * roughness, 0.01));
  vec3 sum = emission + LIGHTS(skin);
  // Irradiance / pi of a gradient: between its values at the pole and at the horizon, both hemispheres mixed by height.
  vec3 upper = mix(horizon, zenith, 0.6), lower = mix(horizon, nadir, 0.6);
  sum += diffuse * mix(lower, upper, 0.5 + 0.5 * n.y);
  vec3 r = reflect(-v, n);
  sum += reflectance(f0, max(dot(n, v), 0.0)) * environment(mix(r.y, 0.5 * n.y, roughness));
  sum = mix(sum, environment(mix(-v.y, r.y, 0.3)), 0.6 * transmission * (1.0 - metallic));

#if GROUND
  sum = mix(sum, environment(-v.y), smoothstep(fade_start, fade_end, length(world_position.xz)));
#endif
  return sum;
}
)";

/// Positions alone: depths for shadows, and edges of triangles.
inline constexpr const char* kPlainVertexShader = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_world;
void main() { gl_Position = clip_from_world * vec4(position, 1.0); }
)";

inline constexpr const char* kPlainFragmentShader = R"(#version 330 core
uniform vec4 tint;
out vec4 color;
void main() { color = tint; }
)";

/// Marks over the picture: OverlayVertex of render/preview/gizmo_marks.h, display values.
inline constexpr const char* kOverlayVertexShader = R"(#version 330 core
layout(location = 0) in vec4 clip;
layout(location = 1) in vec2 disk;
layout(location = 2) in vec3 tone;
out vec2 place;
out vec3 shade;
void main() {
  place = disk;
  shade = tone;
  gl_Position = clip;
}
)";

inline constexpr const char* kOverlayFragmentShader = R"(#version 330 core
in vec2 place;
in vec3 shade;
uniform float opacity;
out vec4 color;
void main() {
  float radius = length(place);
  if (radius > 1.0) discard;
  color = vec4(radius > 0.75 ? 0.35 * shade : shade, opacity);  // a dark rim stands out from any body
}
)";

}  // namespace softreel
