#include "render/preview/egl/surface_programs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/preview/egl/light_shaders.h"
#include "render/preview/egl/preview_shaders.h"
#include "render/preview/egl/surface_shaders.h"
#include "render/scene/ground_mesh.h"

namespace softreel {
namespace {

std::size_t index_at(const std::vector<int>& indices, int k) {
  return static_cast<std::size_t>(indices[static_cast<std::size_t>(k)]);
}

bool is_rich(const Appearance& look) {
  return look.transmission > 0 || look.coat > 0 || look.sheen > 0 || look.metal_color.has_value();
}

/// Colours of vertices, and heat, win over a texture.
bool shows_color_map(const SurfaceColoring& coloring) {
  return coloring.maps.base_color != nullptr && coloring.heat.empty() && coloring.colors.empty();
}

/// Mean chord of a body, m: 4 V / S, which holds for convex ones. 0 for what encloses nothing.
float mean_chord(const MotionMesh& mesh) {
  const std::vector<Vec3f>& positions = mesh.times.back().positions;
  const auto at = [&](Index p) { return positions[static_cast<std::size_t>(p)].cast<double>().eval(); };
  double volume = 0, area = 0;
  if (mesh.triangles.empty()) return 0;
  const Vec3 origin = at(mesh.triangles.front()[0]);
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = at(t[0]) - origin, b = at(t[1]) - origin, c = at(t[2]) - origin;
    volume += a.cross(b).dot(c) / 6;
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area > 0 ? static_cast<float>(4 * std::abs(volume) / area) : 0.0f;
}

void set_sky(const GlProgram& program, const SurfaceView& view) {
  const Environment& environment = view.environment;
  program.set("sky_map", int{kSkyUnit});
  glUniform2f(program.at("sky_turn"), std::cos(environment.rotation), std::sin(environment.rotation));
  program.set("sky_strength", environment.strength);
  program.set("sky_texels", static_cast<float>(view.sky->width()) / (2 * std::numbers::pi_v<float>));
  program.set("sky_pixel", view.pixel_angle);
  for (int k = 0; k < kSkyHarmonics; ++k)
    program.set("sky_harmonics", k, view.sky->harmonics()[static_cast<std::size_t>(k)]);
}

float normal_reflectance(float ior) {
  const float slope = (ior - 1) / (ior + 1);
  return slope * slope;
}

}  // namespace

std::string shader_head(const SurfaceView& view) {
  return fmt::format("#version 330 core\n#define VIEW {}\n#define SKY_IMAGE {}\n", static_cast<int>(view.view),
                     view.sky != nullptr ? 1 : 0);
}

void set_surroundings(const GlProgram& program, const SurfaceView& view) {
  const Environment& environment = view.environment;
  program.use();
  program.set("exposure_scale", std::exp2(view.exposure));
  if (view.sky != nullptr) {
    set_sky(program, view);
    return;
  }
  program.set("zenith", Vec3f(environment.strength * environment.zenith));
  program.set("horizon", Vec3f(environment.strength * environment.horizon));
  program.set("nadir", Vec3f(environment.strength * environment.nadir));
}

bool is_see_through(const Appearance& look) {
  return look.transmission > 0 && look.metallic < 1;
}

bool may_be_lit_at_vertices(const MotionMesh& mesh) {
  const TextureMaps& maps = mesh.coloring.maps;
  if (mesh.lines || maps.normal || maps.bump || maps.roughness || mesh.times.back().normals.empty()) return false;
  // There the colour of a texture is known to what it scatters only.
  return !shows_color_map(mesh.coloring) || (mesh.appearance.metallic == 0 && mesh.appearance.transmission == 0);
}

/// Whether the ground may lie between a light and what stands before it: of lights on the hollow side of the ground,
/// which is convex, it does not.
bool SurfacePrograms::may_be_hidden(bool is_sun, int light) const {
  if (!ground_) return false;
  if (!is_sun) return !is_hollow_at(*ground_, scene_.area_lights[static_cast<std::size_t>(light)].center);
  const Vec3f towards = -scene_.suns[static_cast<std::size_t>(light)].direction;
  return towards.y() <= 0 || (ground_->has_wall && towards.dot(ground_->along) > 0);
}

bool SurfacePrograms::ground_hides() const {
  const auto is_hidden = [&](bool is_sun) { return [this, is_sun](int k) { return may_be_hidden(is_sun, k); }; };
  return std::any_of(lights_.lamps.begin(), lights_.lamps.end(), is_hidden(false)) ||
         std::any_of(lights_.suns.begin(), lights_.suns.end(), is_hidden(true));
}

/// The sum of what the lights send.
std::string SurfacePrograms::lights_text() const {
  std::string text = "vec3(0.0)";
  const auto add = [&](bool is_sun, std::size_t place, int light) {
    int layer = -1;
    for (std::size_t k = 0; k < view_.shadows.size(); ++k)
      if (view_.shadows[k].is_sun == is_sun && view_.shadows[k].light == light) layer = static_cast<int>(k);
    std::string open = "1.0";
    if (may_be_hidden(is_sun, light))
      open = is_sun ? fmt::format("ground_open(sun_towards[{}], 1e30)", place)
                    : fmt::format("ground_open(lamp_center[{}] - world_position, 1.0)", place);
    text += fmt::format(" + {}({}, {}, {}, skin)", is_sun ? "from_sun" : "from_lamp", place, layer, open);
  };
  for (std::size_t k = 0; k < lights_.lamps.size(); ++k) add(false, k, lights_.lamps[k]);
  for (std::size_t k = 0; k < lights_.suns.size(); ++k) add(true, k, lights_.suns[k]);
  return text;
}

const GlProgram& SurfacePrograms::program(const Needs& needs, bool at_vertices, bool in_shadow) {
  std::string begin = shader_head(view_);
  for (const char* name : {"GROUND", "CHECKER", "CATCHER", "COLOR_MAP", "ROUGHNESS_MAP", "NORMAL_MAP", "BUMP_MAP",
                           "MAPS", "RICH", "GLASS", "LINES"}) {
    const auto need = needs.find(name);
    begin += fmt::format("#define {} {}\n", name, need == needs.end() ? 0 : need->second);
  }
  begin += fmt::format("#define SHADOWS {}\n#define LIGHTS(skin) {}\n#define AT_VERTICES {}\n#define SHADOW_BLUR {}\n",
                       in_shadow ? view_.shadows.size() : 0, lights_text(), at_vertices ? 1 : 0,
                       at_vertices ? "5.0" : "1.0");
  begin += fmt::format("#define LAMPS {}\n#define SUNS {}\n#define GROUND_HIDES {}\n",
                       std::max<std::size_t>(1, lights_.lamps.size()), std::max<std::size_t>(1, lights_.suns.size()),
                       ground_hides() ? 1 : 0);
  const std::string functions = std::string(kEnvironmentFunctions) + kDisplayFunctions + kSurfaceFunctions;
  const std::string attributes = begin + kSurfaceAttributes;
  const bool display_last = needs.at("COLOR_MAP") != 0;
  const GlProgram& surface =
      at_vertices
          ? programs_.of(attributes + kVertexLitInputs + functions + kVertexLitMain,
                         begin + (display_last ? kDisplayFunctions : "") + kVertexLitFragmentShader)
          : programs_.of(attributes + kPixelLitVertexShader, begin + kPixelLitInputs + functions + kPixelLitMain);
  if (prepared_.insert(&surface).second)
    set_picture(surface);
  else
    surface.use();
  return surface;
}

void SurfacePrograms::use_for_body(const MotionMesh& mesh, bool flat, bool at_vertices, bool glass) {
  const TextureMaps& maps = mesh.coloring.maps;
  Needs needs{{"COLOR_MAP", shows_color_map(mesh.coloring)},
              {"ROUGHNESS_MAP", maps.roughness != nullptr},
              {"NORMAL_MAP", maps.normal != nullptr},
              {"BUMP_MAP", maps.bump != nullptr},
              {"RICH", is_rich(mesh.appearance)},
              {"GLASS", glass},
              {"LINES", mesh.lines.has_value()}};
  needs["MAPS"] = needs["COLOR_MAP"] | needs["ROUGHNESS_MAP"] | needs["NORMAL_MAP"] | needs["BUMP_MAP"];
  const GlProgram& surface = program(needs, at_vertices, true);
  set_appearance(surface, mesh, flat);
  if (needs["RICH"] != 0) set_layers(surface, mesh);
  if (needs["MAPS"] != 0) set_maps(surface, maps);
  if (!mesh.lines) return;
  surface.set("line_width", mesh.lines->width);
  surface.set("line_share", mesh.lines->max_share);
  surface.set("line_color", mesh.lines->color);
}

void SurfacePrograms::use_for_ground(const Ground& ground, const MotionMesh& mesh, bool in_shadow) {
  const bool rich = is_rich(mesh.appearance);
  const GlProgram& surface = program({{"GROUND", 1},
                                      {"CHECKER", ground.checker > 0},
                                      {"CATCHER", ground.shadow_catcher},
                                      {"COLOR_MAP", 0},
                                      {"RICH", rich}},
                                     false, in_shadow);
  set_appearance(surface, mesh, mesh.times.back().normals.empty());
  if (rich) set_layers(surface, mesh);
  set_ground(surface, ground);
}

void SurfacePrograms::set_picture(const GlProgram& surface) const {
  set_surroundings(surface, view_);
  set_lights(surface);
  set_shadows(surface);
  glUniformMatrix4fv(surface.at("clip_from_world"), 1, GL_FALSE, view_.clip_from_world.data());
  surface.set("eye", view_.eye);
}

void SurfacePrograms::set_lights(const GlProgram& surface) const {
  for (int k = 0; k < static_cast<int>(lights_.lamps.size()); ++k) {
    const AreaLight& lamp = scene_.area_lights[index_at(lights_.lamps, k)];
    const bool sphere = lamp.shape == LampShape::Sphere;
    surface.set("lamp_center", k, lamp.center);
    surface.set("lamp_normal", k, sphere ? Vec3f(Vec3f::Zero()) : Vec3f(lamp.u.cross(lamp.v).normalized()));
    surface.set("lamp_radiance", k, lamp.radiance);
    surface.set("lamp_area", k, seen_area(lamp));
  }
  for (int k = 0; k < static_cast<int>(lights_.suns.size()); ++k) {
    const SunLight& sun = scene_.suns[index_at(lights_.suns, k)];
    surface.set("sun_towards", k, Vec3f(-sun.direction.normalized()));
    surface.set("sun_irradiance", k, sun.irradiance);
  }
  if (!ground_) return;
  surface.set("hide_across", ground_->across);
  surface.set("hide_along", ground_->along);
  surface.set("hide_height", ground_->height);
  surface.set("hide_half", ground_->half_width);
  surface.set("hide_floor_end", ground_->floor_end);
  surface.set("hide_radius", ground_->has_wall ? ground_->radius : 0.0f);
  surface.set("hide_top", ground_->top);
}

void SurfacePrograms::set_shadows(const GlProgram& surface) const {
  surface.set("shadow_share", 1.0f / kShadowSize);
  for (std::size_t layer = 0; layer < view_.shadows.size(); ++layer) {
    const ShadowView& view = view_.shadows[layer];
    const int k = static_cast<int>(layer);
    surface.set("shadow_texel", k, view.texel);
    glUniformMatrix4fv(surface.at(fmt::format("shadow_from_world[{}]", k).c_str()), 1, GL_FALSE,
                       view.clip_from_world.data());
  }
}

void SurfacePrograms::set_appearance(const GlProgram& surface, const MotionMesh& mesh, bool flat) const {
  const Appearance& look = mesh.appearance;
  surface.set("emission", look.emission);
  surface.set("roughness", look.roughness);
  surface.set("metallic", look.metallic);
  surface.set("specular", look.specular);
  // What has no coat does not reflect along the surface either, as the path tracer has it.
  const bool is_coated = look.specular > 0 || look.transmission > 0;
  surface.set("grazing", look.metallic + (1 - look.metallic) * (is_coated ? 1.0f : 0.0f));
  surface.set("flat_normals", flat ? 1 : 0);
}

void SurfacePrograms::set_layers(const GlProgram& surface, const MotionMesh& mesh) const {
  const Appearance& look = mesh.appearance;
  surface.set("transmission", look.transmission);
  surface.set("glass_f0", normal_reflectance(look.ior));
  surface.set("glass_bend", 1 / (look.ior * look.ior));
  // The longest chord of a ball is 1.5 times its mean one.
  surface.set("chord", look.absorption.isZero(0) ? 0.0f : 1.5f * mean_chord(mesh));
  surface.set("absorption", look.absorption);
  surface.set("metal_color", look.metal_color.value_or(look.base_color));
  surface.set("own_metal", look.metal_color ? 1.0f : 0.0f);
  surface.set("coat", look.coat);
  surface.set("coat_alpha", std::max(look.coat_roughness * look.coat_roughness, 0.01f));
  surface.set("coat_f0", normal_reflectance(look.coat_ior));
  surface.set("coat_color", look.coat_color);
  surface.set("sheen_exponent", 1 / look.sheen_roughness);
  surface.set("sheen_color", Vec3f(look.sheen * look.sheen_color));
}

void SurfacePrograms::set_maps(const GlProgram& surface, const TextureMaps& maps) {
  glUniform2fv(surface.at("map_scale"), 1, maps.scale.data());
  glUniform2fv(surface.at("map_offset"), 1, maps.offset.data());
  if (maps.base_color) textures_.bind_colors(kColorUnit, maps.base_color, maps.wrap);
  if (maps.roughness) textures_.bind_shares(kRoughnessUnit, maps.roughness, maps.wrap);
  if (maps.normal) textures_.bind_normals(kNormalUnit, maps.normal, maps.wrap);
  if (maps.bump) textures_.bind_heights(kBumpUnit, maps.bump, maps.wrap);
  surface.set("color_map", int{kColorUnit});
  surface.set("roughness_map", int{kRoughnessUnit});
  surface.set("normal_map", int{kNormalUnit});
  surface.set("bump_map", int{kBumpUnit});
  surface.set("normal_strength", maps.normal_strength);
  surface.set("bump_height", maps.bump_height);
}

void SurfacePrograms::set_ground(const GlProgram& surface, const Ground& ground) const {
  const GroundPattern pattern(ground, scene_.camera);
  const bool plane = ground.style == GroundStyle::Plane;
  surface.set("upright_ground", plane ? 1 : 0);
  surface.set("checker", ground.checker);
  surface.set("checker_color", ground.checker_color);
  surface.set("ground_height", ground.height);
  surface.set("sweep", ground.sweep);
  surface.set("across", pattern.across());
  surface.set("along", pattern.along());
  surface.set("ground_edge", plane ? 0.5f * ground.size : 1e30f);
}

}  // namespace softreel
