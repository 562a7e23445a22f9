// The fields that vary a look over a surface: textures and vertex colours of a material, heat of a picture.
#include <fmt/format.h>

#include "tool/shot/codecs.h"
#include "tool/shot/schema_tables.h"

namespace softreel {
namespace {

/// Leaves a field out of written shots where `is_replaced` says that another one holds.
template <typename IsReplaced>
void write_unless(Table<MaterialSettings>& table, const std::string& name, IsReplaced is_replaced) {
  for (Field<MaterialSettings>& field : table.fields)
    if (field.text.path == name)
      field.write = [is_replaced, write = field.write](const MaterialSettings& m) {
        return is_replaced(m.textures) ? std::nullopt : write(m);
      };
}

void check_range(const Place& place, const TomlValue& value, const RenderSettings& render) {
  if (!render.heat.range || render.heat.range->x() < render.heat.range->y()) return;
  static const FieldText text{"heat_range", "", "", "", "two numbers, the second above the first", "", false, false};
  throw value_error({place.path + ".heat_range", &text, place.problems}, *value.find("heat_range"), "it has no extent",
                    "Exchange or change the two numbers.");
}

}  // namespace

void add_texture_fields(Table<MaterialSettings>& t) {
  const auto path = [&t](const char* name, std::string TextureSettings::*member, const char* sentence,
                         const char* otherwise) {
    t.add(
        name, [member](auto& m) -> auto& { return m.textures.*member; }, file_path(), "", sentence, otherwise);
  };
  using S = TextureSettings;
  path("base_color_texture", &S::base_color,
       "Picture (PNG, JPEG: sRGB; EXR, HDR: linear) of the base colour, by the mesh's texture coordinates; instead of "
       "base_color.",
       "none: base_color everywhere");
  t.add(
      "vertex_colors", [](auto& m) -> auto& { return m.textures.vertex_colors; }, toggle(), "",
      "The base colour is that of the mesh file's vertices (PLY, OBJ, glTF, ...); instead of base_color.");
  path("roughness_texture", &S::roughness,
       "Picture of the roughness: numbers as stored (no sRGB curve), green channel; instead of roughness.",
       "none: roughness everywhere");
  path("normal_texture", &S::normal, "Normal map in tangent space: numbers as stored, green upward (OpenGL, glTF).",
       "none");
  t.add(
      "normal_strength", [](auto& m) -> auto& { return m.textures.normal_strength; }, number(in_single(kNotNegative)),
      "", "Factor on the slopes of the normal map; 0: flat.");
  path("bump_texture", &S::bump, "Picture of heights: numbers as stored, green channel.", "none");
  t.add(
       "bump_height", [](auto& m) -> auto& { return m.textures.bump_height; }, number(in_single(kAnyNumber)), "m",
       "How much higher white lies than black; below 0: deeper.")
      .add(
          "texture_scale", [](auto& m) -> auto& { return m.textures.scale; },
          vector_of<Vec2>(in_single(kAnyNumber), "[u, v]"), "",
          "How often the pictures repeat where the texture coordinates go from 0 to 1.")
      .add(
          "texture_offset", [](auto& m) -> auto& { return m.textures.offset; },
          vector_of<Vec2>(in_single(kAnyNumber), "[u, v]"), "pictures", "Moves the pictures, after the scale.")
      .add(
          "texture_wrap", [](auto& m) -> auto& { return m.textures.wrap; },
          choice<TextureWrap>(
              {{"repeat", TextureWrap::Repeat}, {"clamp", TextureWrap::Clamp}, {"mirror", TextureWrap::Mirror}}),
          "", "What is beyond a picture's edge: the picture again, its last texels, or its mirror image.");
  write_unless(t, "base_color", [](const S& s) { return s.vertex_colors || !s.base_color.empty(); });
  write_unless(t, "vertex_colors", [](const S& s) { return !s.vertex_colors; });
  write_unless(t, "roughness", [](const S& s) { return !s.roughness.empty(); });
  t.check = [before = t.check](const Place& place, const TomlValue& value, MaterialSettings& material) {
    check_alternatives(place, value, "material.*");
    if (before) before(place, value, material);
  };
}

void add_heat_fields(Table<RenderSettings>& t) {
  t.add(
       "heat", [](auto& r) -> auto& { return r.heat.quantity; },
       choice<HeatQuantity>({{"none", HeatQuantity::None},
                             {"strain", HeatQuantity::Strain},
                             {"stress", HeatQuantity::Stress},
                             {"displacement", HeatQuantity::Displacement}}),
       "",
       "Shows a quantity as colour on all bodies, with a legend: \"strain\": the largest principal strain; "
       "\"stress\": von Mises; \"displacement\": distance from the place at rest.")
      .add(
          "heat_range", [](auto& r) -> auto& { return r.heat.range; },
          optional_of(vector_of<Vec2>(kAnyNumber, "[lowest, highest]")), "1, Pa, m",
          "What the ends of the colours mean.",
          "from 0 to what 99 % of each frame's surface stays below, in all frames of the shot, which are simulated for "
          "it");
  t.check = [before = t.check](const Place& place, const TomlValue& value, RenderSettings& render) {
    check_range(place, value, render);
    if (before) before(place, value, render);
  };
}

}  // namespace softreel
