#include "tool/stages/material_textures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "core/base/check.h"
#include "render/image/image_io.h"
#include "render/image/texture_pyramid.h"
#include "tool/bodies/at_field.h"
#include "tool/cache/atomic_file.h"

namespace softreel {
namespace {

struct TextureFile {
  const char* field;
  const std::string& path;
};

std::array<TextureFile, 4> files_of(const TextureSettings& t) {
  return {{{"base_color_texture", t.base_color},
           {"roughness_texture", t.roughness},
           {"normal_texture", t.normal},
           {"bump_texture", t.bump}}};
}

std::string field_path(const std::string& material, const char* field) {
  return fmt::format("material.{}.{}", material, field);
}

/// Names of the materials that bodies wear; a region's is only felt.
std::set<std::string> worn_materials(const Shot& shot) {
  std::set<std::string> names;
  for (const BodySettings& body : shot.bodies) names.insert(body.material);
  return names;
}

/// Texture coordinates that single precision can still place in a picture.
bool is_usable(const Vec2& at) {
  constexpr double kFarthest = 1e4;
  return std::abs(at.x()) <= kFarthest && std::abs(at.y()) <= kFarthest;
}

[[noreturn]] void fail(const MaterialSettings& material, const BodySettings& body, const char* field,
                       const std::string& problem, const std::string& advice) {
  throw input_error(fmt::format("{}: {}: {}, which body \"{}\" wears, {}.\n  {}", to_string(material.origin),
                                field_path(body.material, field), body.mesh, body.name, problem, advice));
}

void require_coordinates(const MaterialSettings& material, const BodySettings& body, const SurfaceMesh& surface,
                         const char* field) {
  const bool any = std::any_of(surface.triangle_textures.begin(), surface.triangle_textures.end(),
                               [](const Triangle& t) { return t[0] >= 0 && t[1] >= 0 && t[2] >= 0; });
  if (!any)
    fail(material, body, field, "has no texture coordinates",
         "Accepted: a mesh with texture coordinates (OBJ vt, PLY s and t, glTF TEXCOORD_0). Unwrap it in the program "
         "that "
         "made it, or leave the texture out.");
  for (const Triangle& corners : surface.triangle_textures)
    for (const Index c : corners)
      if (c >= 0 && !is_usable(surface.texture_coordinates[static_cast<std::size_t>(c)]))
        fail(material, body, field,
             fmt::format("has the texture coordinate ({}, {}) at number {}",
                         surface.texture_coordinates[static_cast<std::size_t>(c)].x(),
                         surface.texture_coordinates[static_cast<std::size_t>(c)].y(), c),
             "Accepted: numbers from -10000 to 10000. Export the mesh again.");
}

void require_colors(const MaterialSettings& material, const BodySettings& body, const SurfaceMesh& surface) {
  if (surface.colors.empty())
    fail(material, body, "vertex_colors", "has no colours at its vertices",
         "Accepted: a mesh with vertex colours (PLY red, green, blue; OBJ v x y z r g b; glTF COLOR_0). Export them "
         "too, or "
         "use base_color.");
  const std::vector<bool> used = used_vertices(surface);
  for (std::size_t v = 0; v < surface.colors.size(); ++v) {
    const Vec3f& c = surface.colors[v];
    if (used[v] && !(c.minCoeff() >= 0 && c.maxCoeff() <= 1))
      fail(material, body, "vertex_colors",
           fmt::format("has the colour ({:.4g}, {:.4g}, {:.4g}), made linear, at vertex {}", c.x(), c.y(), c.z(), v),
           "Accepted: colours from 0 to 1 (bytes from 0 to 255). Export the mesh again.");
  }
}

}  // namespace

MaterialTextures::MaterialTextures(const Shot& shot) : shot_(shot) {
  for (const std::string& name : worn_materials(shot))
    for (const TextureFile& file : files_of(material(name).textures))
      if (!file.path.empty() && checksums_.count(file.path) == 0)
        checksums_[file.path] = at_field(material(name).origin, field_path(name, file.field),
                                         [&] { return hash_bytes(read_file(file.path)); });
}

void MaterialTextures::require_match(const BodySettings& body, const LoadedBody& loaded) const {
  const MaterialSettings& worn = material(body.material);
  for (const TextureFile& file : files_of(worn.textures))
    if (!file.path.empty()) require_coordinates(worn, body, loaded.surface, file.field);
  if (worn.textures.vertex_colors) require_colors(worn, body, loaded.surface);
}

void MaterialTextures::add_key(KeyHasher& key, const BodySettings& body, const LoadedBody& loaded) const {
  const TextureSettings& t = material(body.material).textures;
  if (t.vertex_colors) key.add("vertex colours").add(loaded.surface.colors);
  if (!t.any()) return;
  key.add("textures").add(t.wrap).add(t.scale.x()).add(t.scale.y()).add(t.offset.x()).add(t.offset.y());
  for (const TextureFile& file : files_of(t)) key.add(file.path.empty() ? StageKey() : checksums_.at(file.path));
  if (!t.normal.empty()) key.add(t.normal_strength);
  if (!t.bump.empty()) key.add(t.bump_height);
  for (const Triangle& corners : loaded.surface.triangle_textures) key.add(corners);
  for (const Vec2& at : loaded.surface.texture_coordinates) key.add(at.x()).add(at.y());
}

double MaterialTextures::count_texels() const {
  double texels = 0;
  for (const std::string& name : worn_materials(shot_))
    for (const TextureFile& file : files_of(material(name).textures)) {
      if (file.path.empty()) continue;
      const auto [width, height] =
          at_field(material(name).origin, field_path(name, file.field), [&] { return picture_size(file.path); });
      texels += static_cast<double>(width) * height;
    }
  return texels;
}

void MaterialTextures::load() {
  for (const std::string& name : worn_materials(shot_)) {
    if (maps_.count(name) > 0) continue;
    const MaterialSettings& worn = material(name);
    const TextureSettings& t = worn.textures;
    const auto read = [&](const char* field, const std::string& path, const auto& reader) {
      return at_field(worn.origin, field_path(name, field), [&] {
        auto texture = std::make_shared<std::remove_cvref_t<decltype(reader(path))>>(reader(path));
        if (hash_bytes(read_file(path)) != checksums_.at(path))
          throw work_error(path + ": changed while the shot was being rendered.\n  Run again.");
        return texture;
      });
    };
    TextureMaps maps;
    if (!t.base_color.empty()) maps.base_color = read("base_color_texture", t.base_color, read_color_texture);
    if (!t.roughness.empty())
      maps.roughness =
          read("roughness_texture", t.roughness, [](const std::string& path) { return read_data_texture(path, true); });
    if (!t.normal.empty()) maps.normal = read("normal_texture", t.normal, read_normal_texture);
    if (!t.bump.empty())
      maps.bump = read("bump_texture", t.bump, [](const std::string& path) { return read_data_texture(path, false); });
    maps.wrap = t.wrap;
    maps.scale = t.scale.cast<float>();
    maps.offset = t.offset.cast<float>();
    maps.normal_strength = static_cast<float>(t.normal_strength);
    maps.bump_height = static_cast<float>(t.bump_height);
    maps_[name] = std::move(maps);
  }
}

SurfaceColoring MaterialTextures::coloring(const BodySettings& body, const LoadedBody& loaded) const {
  SurfaceColoring coloring;
  coloring.maps = maps_.at(body.material);
  if (material(body.material).textures.vertex_colors) coloring.colors = loaded.surface.colors;
  if (coloring.maps.empty()) return coloring;
  for (const Vec2& at : loaded.surface.texture_coordinates) coloring.coordinates.push_back(at.cast<float>());
  coloring.triangles = loaded.surface.triangle_textures;
  return coloring;
}

}  // namespace softreel
