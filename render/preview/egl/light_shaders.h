/// GLSL of light on surfaces. OpenGL 3.3; see surface_shaders.h for its #defines.
#pragma once

namespace softreel {

/// Needs world_position, world_normal and base_color, which the shaders around it say; in light_surface they become
/// lit_diffuse and lit_other: the radiance is albedo * lit_diffuse + lit_other.
inline constexpr const char* kSurfaceFunctions = R"(
uniform vec3 eye;
uniform vec3 emission;
uniform float roughness, metallic, specular, grazing;  // grazing: what a smooth one reflects along the surface
uniform bool flat_normals;
uniform bool upright_ground;          // the pattern follows world axes
uniform float checker, ground_height, sweep, ground_edge;  // ground_edge: m, half the square; of a backdrop none
uniform vec3 checker_color, across, along;
uniform vec3 lamp_center[LAMPS], lamp_normal[LAMPS], lamp_radiance[LAMPS];
uniform float lamp_area[LAMPS];
uniform vec3 sun_towards[SUNS], sun_irradiance[SUNS];
uniform sampler2DArrayShadow shadow_maps;
uniform mat4 shadow_from_world[4];
uniform float shadow_share;      // a texel, share of a map's edge
uniform float shadow_texel[4];   // m, edge of a texel where the bodies are

const float kPi = 3.14159265;

vec3 lit_diffuse, lit_other;
vec3 view, surface_normal;  // unit, both away from the surface
#if RICH
uniform float transmission, glass_f0, glass_bend, chord;  // glass_bend: 1 / ior^2; chord: m, longest
uniform vec3 absorption, metal_color;
uniform float own_metal;                                  // 1: the metal has a colour of its own
uniform float coat, coat_alpha, coat_f0, sheen_exponent;
uniform vec3 coat_color, sheen_color;
vec3 top_gloss;  // of coat and sheen
vec3 through;    // share of what is behind that is seen
#endif
#if CATCHER
vec3 unshadowed;
#endif

vec3 surface_color() {
  vec3 color = base_color;
#if COLOR_MAP && !AT_VERTICES
  color = mix(color, texture(color_map, place.xy).rgb, place.z);
#endif
#if LINES
  color = mix(color, line_color, line_coverage());
#endif
#if CHECKER
  float x = dot(world_position, across), y = dot(world_position, along);
  if (!upright_ground && y > sweep) {
    float radius = 0.5 * sweep, rise = world_position.y - ground_height;
    y = rise < radius ? sweep + radius * atan(y - sweep, radius - rise) : sweep + radius * 0.5 * kPi + (rise - radius);
  }
  color = mod(floor(x / checker) + floor(y / checker), 2.0) == 1.0 ? checker_color : color;
#endif
  return color;
}

float rest_of(float cosine) {
  float rest = 1.0 - cosine;
  return rest * rest * rest * rest * rest;
}

vec3 reflectance(vec3 f0, float cosine, float rough) {
  return f0 + (max(vec3(grazing * (1.0 - rough)), f0) - f0) * rest_of(cosine);
}

// GGX highlight times pi, with the visibility of Karis 2013.
float highlight(vec3 n, vec3 v, vec3 l, float alpha) {
  vec3 h = normalize(v + l);
  float nh = max(dot(n, h), 0.0), nv = max(dot(n, v), 1e-3), nl = max(dot(n, l), 1e-3);
  float a2 = alpha * alpha, t = nh * nh * (a2 - 1.0) + 1.0, k = 0.5 * alpha;
  return a2 / (t * t) * 0.25 / ((nv * (1.0 - k) + k) * (nl * (1.0 - k) + k));
}

// Share of a light that reaches the surface. At pixels: two taps, each the mean of four texels; more cost too much in
// software. At vertices, which are few, a spiral of equal areas (Vogel): a sharp edge would have teeth there.
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

#if GROUND_HIDES
uniform vec3 hide_across, hide_along;  // horizontal, unit
uniform float hide_height, hide_half, hide_floor_end, hide_radius, hide_top;  // GroundShape; hide_radius 0: no wall

// 0 where the ground lies between the point and what is up to `most` times `to` away, else 1; as
// render/pathtrace/rays/swept_ground.h.
float ground_open(vec3 to, float most) {
  float least = 1e-4 * distance(eye, world_position) / length(to), x = dot(world_position, hide_across),
        dx = dot(to, hide_across);
  vec2 o = vec2(dot(world_position, hide_along), world_position.y), d = vec2(dot(to, hide_along), to.y);
  float at = (hide_height - o.y) / d.y, y = o.x + at * d.x;
  if (d.y != 0.0 && at > least && at < most && abs(x + at * dx) <= hide_half && y >= -hide_half && y <= hide_floor_end)
    return 0.0;
  if (hide_radius <= 0.0) return 1.0;
  vec2 center = vec2(hide_floor_end, hide_height + hide_radius), from = o - center;
  at = (hide_radius - from.x) / d.x;
  y = o.y + at * d.y;
  if (d.x != 0.0 && at > least && at < most && abs(x + at * dx) <= hide_half && y >= center.y && y <= hide_top)
    return 0.0;
  float a = dot(d, d), b = dot(from, d), under = b * b - a * (dot(from, from) - hide_radius * hide_radius);
  for (float side = -1.0; under > 0.0 && side < 2.0; side += 2.0) {
    at = (side * sqrt(under) - b) / a;
    vec2 p = from + at * d;
    if (at > least && at < most && abs(x + at * dx) <= hide_half && p.x >= 0.0 && p.y <= 0.0) return 0.0;
  }
  return 1.0;
}
#endif

struct Skin {
  vec3 n, v, f0;
  float rough, alpha;
};

#if RICH
// Fibres: the distribution of Estevez and Kulla 2017, times pi, with the visibility of Neubelt and Pettineo 2013.
float fibres(vec3 n, vec3 v, vec3 l) {
  float nh = dot(n, normalize(v + l)), nl = max(dot(n, l), 0.0), nv = max(dot(n, v), 1e-3);
  float sine = sqrt(max(1.0 - nh * nh, 0.0));
  return 0.5 * (2.0 + sheen_exponent) * pow(sine, sheen_exponent) * 0.25 / max(nl + nv - nl * nv, 1e-3);
}
#endif

// Adds the light to lit_diffuse, and returns its highlight. light: irradiance across it / pi; widened: alpha of the
// highlight; narrow: what is left of its height.
vec3 lit_by(vec3 light, vec3 l, int shadow, Skin s, float widened, float narrow) {
  vec3 open = light * max(dot(s.n, l), 0.0);
  vec3 arrived = reached(shadow, s.n) * open;
  float vh = max(dot(s.v, normalize(s.v + l)), 0.0);
  lit_diffuse += arrived;
#if CATCHER
  unshadowed += open;
#endif
#if RICH
  float varnish = coat * mix(coat_f0, 1.0, rest_of(vh));
  float wide = min(1.0, coat_alpha + widened - s.alpha);
  varnish *= mix((coat_alpha * coat_alpha) / (wide * wide), 1.0, 0.5);
  top_gloss += arrived * (varnish * highlight(s.n, s.v, l, wide) + sheen_color * fibres(s.n, s.v, l));
#endif
  return arrived * reflectance(s.f0, vh, s.rough) * (narrow * highlight(s.n, s.v, l, widened));
}

// open: share that the ground lets pass
vec3 from_lamp(int k, int shadow, float open, Skin s) {
  vec3 to = lamp_center[k] - world_position;
  float squared = dot(to, to);
  vec3 l = to * inversesqrt(squared);
  // A sphere has no normal, and faces everything.
  float facing = lamp_normal[k] == vec3(0.0) ? 1.0 : max(-dot(l, lamp_normal[k]), 0.0);
  vec3 irradiance = lamp_radiance[k] * (lamp_area[k] * facing / (squared + 0.25 * lamp_area[k]));
  float widened = min(1.0, s.alpha + 0.25 * sqrt(lamp_area[k] / squared));
  float narrow = (s.alpha * s.alpha) / (widened * widened);  // the same energy over a wider highlight
  return lit_by(open * irradiance / kPi, l, shadow, s, widened, mix(narrow, 1.0, 0.5));
}

vec3 from_sun(int k, int shadow, float open, Skin s) {
  return lit_by(open * sun_irradiance[k] / kPi, sun_towards[k], shadow, s, s.alpha, 1.0);
}

#if (NORMAL_MAP || BUMP_MAP) && !AT_VERTICES
// The outward normal as the textures bend it. Gradients along the surface by how much the pixels beside differ
// (Mikkelsen, Bump Mapping Unparametrized Surfaces on the GPU, 2010).
vec3 bent(vec3 n) {
  vec3 dx = dFdx(world_position), dy = dFdy(world_position);
  vec3 of_x = cross(dy, n), of_y = cross(n, dx);
  float area = dot(dx, of_x);
  if (abs(area) < 1e-20 || place.z < 0.5) return n;
  of_x /= area;
  of_y /= area;
  vec2 cx = dFdx(place.xy), cy = dFdy(place.xy);
#if NORMAL_MAP
  vec3 du = cx.x * of_x + cy.x * of_y, dv = -(cx.y * of_x + cy.y * of_y);
  float turned = dot(cross(du, dv), n) < 0.0 ? -1.0 : 1.0;
  vec3 tangent = turned * cross(dv, n);
  vec3 texel = texture(normal_map, place.xy).xyz;
  if (dot(tangent, tangent) > 1e-20) {
    tangent = normalize(tangent);
    n = normalize(normal_strength * (texel.x * tangent + texel.y * turned * cross(n, tangent)) + texel.z * n);
  }
#endif
#if BUMP_MAP
  float here = texture(bump_map, place.xy).r;
  float rise_x = texture(bump_map, place.xy + cx).r - here, rise_y = texture(bump_map, place.xy + cy).r - here;
  vec3 uphill = bump_height * (rise_x * of_x + rise_y * of_y);
  n = normalize(n - uphill + dot(uphill, n) * n);
#endif
  return n;
}
#endif

void light_surface(vec3 albedo) {
  vec3 v = normalize(eye - world_position);
  vec3 n = normalize(flat_normals ? FACE_NORMAL : world_normal);
  // The back of a sheet; or a front whose smooth normal points away, as near outlines and hard edges. The face tells
  // them apart where it is known.
#if AT_VERTICES
  float side = dot(n, v) < -0.3 ? -1.0 : 1.0;
#else
  vec3 face = FACE_NORMAL;
  float side = dot(face, v) * dot(face, n) < 0.0 ? -1.0 : 1.0;
#endif
#if (NORMAL_MAP || BUMP_MAP) && !AT_VERTICES
  n = bent(n);
#endif
  n *= side;
  n = normalize(n - min(dot(n, v), 0.0) * v);
  float rough = roughness;
#if ROUGHNESS_MAP && !AT_VERTICES
  rough = mix(rough, texture(roughness_map, place.xy).r, place.z);
#endif
  float nv = max(dot(n, v), 0.0);
  vec3 r = reflect(-v, n);
  vec3 open_sky = sky_light(n);
  lit_diffuse = open_sky;
#if CATCHER
  unshadowed = lit_diffuse;
#endif
#if RICH
  float clear = transmission * (1.0 - metallic);
  vec3 f0 = mix(vec3(mix(0.08 * specular, glass_f0, transmission)), mix(albedo, metal_color, own_metal), metallic);
  top_gloss = vec3(0.0);
#else
  vec3 f0 = mix(vec3(0.08 * specular), albedo, metallic);
#endif
  Skin skin = Skin(n, v, f0, rough, max(rough * rough, 0.01));
  vec3 gloss = LIGHTS(skin);
  vec3 mirrored = reflectance(f0, nv, rough);
  gloss += mirrored * mirrored_sky(r, n, rough);
  lit_diffuse *= 1.0 - metallic;
#if RICH
  lit_diffuse *= 1.0 - transmission;
  // Beer's law along the refracted ray through a body as thick as its mean chord.
  float inward = sqrt(max(1.0 - (1.0 - nv * nv) * glass_bend, 0.0));
  through = clear * (1.0 - mirrored) * exp(-absorption * (chord * inward));
  float varnish = coat * mix(coat_f0, 1.0, rest_of(nv));
  // What fibres reflect of an even sky, within 0.06 of render/pathtrace/materials/sheen.h. nv may be rounded to above 1, where
  // the power is undefined.
  float cover = 0.17 / sheen_exponent + 0.73 * pow(max(1.0 - nv, 0.0), 1.8 + 0.13 * sheen_exponent);
  vec3 under = (1.0 - varnish) * mix(vec3(1.0), coat_color, coat) * (1.0 - cover * sheen_color);
  top_gloss += varnish * mirrored_sky(r, n, sqrt(coat_alpha)) + cover * sheen_color * open_sky;
  lit_diffuse *= under;
  through *= under;
  gloss = gloss * under + top_gloss;
#endif
  lit_other = emission + gloss;
  view = v;
  surface_normal = n;
}

#if GROUND
// Share of a pixel on the square, where its edge is narrower than one.
float on_ground() {
  float inside = ground_edge - max(abs(world_position.x), abs(world_position.z));
  return clamp(inside / max(fwidth(inside), 1e-20), 0.0, 1.0);
}
#endif

vec3 seen_radiance(vec3 albedo) {
  vec3 sum = albedo * lit_diffuse + lit_other;
#if RICH && !GLASS
  sum += through * seen_sky(mix(-view, reflect(-view, surface_normal), 0.3));
#endif
#if GROUND
  sum = mix(seen_sky(-view), sum, on_ground());
#endif
  return sum;
}

#if GLASS
// Display values are no light, and do not add up: what glass itself sends counts as it would before the surroundings.
vec3 before_glass(vec3 albedo) {
  vec3 behind = through * seen_sky(-view);
  return max(display(albedo * lit_diffuse + lit_other + behind) - display(behind), 0.0);
}

vec3 to_display_factor(vec3 share) {
#if VIEW == 3
  return share;
#else
  return pow(max(share, 0.0), vec3(1.0 / 2.2));
#endif
}
#endif

#if CATCHER
float caught_shadow() {
  const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);
  float open = dot(luminance, unshadowed);
  float shade = open > 0.0 ? 1.0 - dot(luminance, lit_diffuse) / open : 0.0;
  return shade * on_ground();
}
#endif
)";

}  // namespace softreel
