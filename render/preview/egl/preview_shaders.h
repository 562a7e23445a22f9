/// GLSL of the preview beside lit surfaces: background, display, shadows and edges, marks. OpenGL 3.3.
#pragma once

namespace softreel {

inline constexpr int kMaxPreviewLamps = 8;
inline constexpr int kMaxPreviewSuns = 4;
inline constexpr int kMaxPreviewShadows = 4;
inline constexpr int kShadowSize = 1024;  ///< pixels of a shadow map's edge

/// The environment's gradient; an image is summed up by three colours.
inline constexpr const char* kEnvironmentFunctions = R"(
uniform vec3 zenith, horizon, nadir;
vec3 environment(float height) {
  return mix(horizon, height > 0.0 ? zenith : nadir, abs(height));
}
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
  color = vec4(display(environment(normalize(direction).y)), 1.0);
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
