/// GLSL of the preview beside lit surfaces: background, display, shadows and edges, marks. OpenGL 3.3.
#pragma once

namespace softreel {

inline constexpr int kMaxPreviewShadows = 4;
inline constexpr int kShadowSize = 1024;  ///< pixels of a shadow map's edge

/// The surroundings in a direction, which need not be of length 1 where they are an image: the gradient, whose place
/// is the height of the direction, or the image. SKY_IMAGE: 0 or 1.
///   sky_light     irradiance / pi
///   mirrored_sky  what a surface of a roughness mirrors
inline constexpr const char* kEnvironmentFunctions = R"(
#if SKY_IMAGE
uniform sampler2D sky_map;        // rows from straight up to straight down
uniform vec2 sky_turn;            // cosine and sine of the rotation
uniform float sky_strength;
uniform float sky_texels;         // a radian of the horizon
uniform float sky_pixel;          // rad, of the picture
uniform vec3 sky_harmonics[9];    // as render/preview/sky_harmonics.h
vec3 turned(vec3 d) {
  return vec3(sky_turn.x * d.x - sky_turn.y * d.z, d.y, sky_turn.y * d.x + sky_turn.x * d.z);
}
vec3 blurred_sky(vec3 direction, float blur) {
  vec3 d = turned(normalize(direction));
  // Straight up and down any azimuth will do, but atan(0, 0) may be anything.
  vec2 at = vec2(atan(d.x, 1e-20 - d.z) / 6.28318531 + 0.5, acos(clamp(d.y, -1.0, 1.0)) / 3.14159265);
  return sky_strength * textureLod(sky_map, at, log2(max(blur, sky_pixel) * sky_texels)).rgb;
}
vec3 seen_sky(vec3 direction) { return blurred_sky(direction, 0.0); }
vec3 mirrored_sky(vec3 reflected, vec3 n, float rough) {
  return blurred_sky(mix(reflected, 0.5 * n, rough), rough * rough);
}
vec3 sky_light(vec3 n) {
  vec3 d = turned(n);
  vec3 sum = sky_harmonics[0] + sky_harmonics[1] * d.x + sky_harmonics[2] * d.y + sky_harmonics[3] * d.z +
             sky_harmonics[4] * (d.x * d.y) + sky_harmonics[5] * (d.y * d.z) + sky_harmonics[6] * (d.x * d.z) +
             sky_harmonics[7] * (3.0 * d.y * d.y - 1.0) + sky_harmonics[8] * (d.x * d.x - d.z * d.z);
  return sky_strength * max(sum, 0.0);
}
#else
uniform vec3 zenith, horizon, nadir;
vec3 environment(float height) {
  return mix(horizon, height > 0.0 ? zenith : nadir, abs(height));
}
vec3 seen_sky(vec3 direction) { return environment(direction.y); }
vec3 mirrored_sky(vec3 reflected, vec3 n, float rough) { return environment(mix(reflected.y, 0.5 * n.y, rough)); }
// Between the values at the pole and at the horizon, both hemispheres mixed by height.
vec3 sky_light(vec3 n) {
  vec3 upper = mix(horizon, zenith, 0.6), lower = mix(horizon, nadir, 0.6);
  return mix(lower, upper, 0.5 + 0.5 * n.y);
}
#endif
)";

/// Display values, as apply_view of render/image/view_transform.h. VIEW: 0 standard, 1 filmic, 2 aces-fit, 3 raw.
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
  color = vec4(display(seen_sky(normalize(direction))), 1.0);
}
)";

/// Positions alone: depths for shadows, and edges of triangles.
inline constexpr const char* kPlainVertexShader = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_world;
invariant gl_Position;  // glass is drawn where its depth is
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

/// Visible lamps: the tone is their radiance.
inline constexpr const char* kLampFragmentShader = R"(
in vec3 shade;
out vec4 color;
void main() { color = vec4(display(shade), 1.0); }
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
