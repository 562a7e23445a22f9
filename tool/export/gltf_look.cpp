#include "tool/export/gltf_look.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.h"
#include "render/image/image_io.h"
#include "tool/cache/atomic_file.h"
#include "tool/export/export_colors.h"
#include "tool/export/export_look.h"

namespace softreel {
namespace {

using Json = nlohmann::ordered_json;

struct Extension {
  const char* name;
  /// Its object, or null where the look does not need it. thickness: of the body, in its own unit.
  Json (*of)(const Appearance& look, double thickness);
};

Json triple(const Vec3f& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Json emissive_strength(const Appearance& look, double) {
  const float most = look.emission.maxCoeff();
  return most > 1 ? Json::object({{"emissiveStrength", most}}) : Json();
}

Json transmission(const Appearance& look, double) {
  return look.transmission > 0 ? Json::object({{"transmissionFactor", look.transmission}}) : Json();
}

Json ior(const Appearance& look, double) {
  return look.transmission > 0 && look.ior != 1.5f ? Json::object({{"ior", look.ior}}) : Json();
}

/// Factors on the reflectance that the index gives.
Json specular(const Appearance& look, double) {
  if (look.metallic >= 1) return {};
  if (look.specular <= 0 && look.transmission <= 0) return Json::object({{"specularFactor", 0}});
  const double of_index = reflectance_of(look.transmission > 0 ? look.ior : 1.5);
  const double factor = of_index > 1e-9 ? dielectric_reflectance(look) / of_index : 1;
  if (std::abs(factor - 1) < 1e-5) return {};
  return Json::object({{"specularColorFactor", triple(Vec3f::Constant(static_cast<float>(factor)))}});
}

Json clearcoat(const Appearance& look, double) {
  if (look.coat <= 0) return {};
  return Json::object({{"clearcoatFactor", look.coat}, {"clearcoatRoughnessFactor", look.coat_roughness}});
}

Json sheen(const Appearance& look, double) {
  if (look.sheen <= 0) return {};
  return Json::object(
      {{"sheenColorFactor", triple(look.sheen * look.sheen_color)}, {"sheenRoughnessFactor", look.sheen_roughness}});
}

/// Of white light, attenuationColor is left after attenuationDistance: here where the channel taken in most is at 1/e.
Json volume(const Appearance& look, double thickness) {
  if (look.transmission <= 0 || !(thickness > 0)) return {};
  Json volume = Json::object({{"thicknessFactor", thickness}});
  const float most = look.absorption.maxCoeff();
  if (!(most > 0)) return volume;
  volume["attenuationDistance"] = 1 / static_cast<double>(most);
  volume["attenuationColor"] = triple((-look.absorption.array() / most).exp().matrix());
  return volume;
}

constexpr const char* kVolume = "KHR_materials_volume";
constexpr std::array<Extension, 7> kExtensions{{{"KHR_materials_emissive_strength", emissive_strength},
                                                {"KHR_materials_transmission", transmission},
                                                {"KHR_materials_ior", ior},
                                                {"KHR_materials_specular", specular},
                                                {"KHR_materials_clearcoat", clearcoat},
                                                {"KHR_materials_sheen", sheen},
                                                {kVolume, volume}}};

/// glTF multiplies the metal by the blue channel: here by 1 everywhere.
std::vector<std::uint8_t> without_blue(const std::string& path) {
  const TexturePicture picture = read_texture_picture(path);
  DisplayImage image{picture.width, picture.height, {}};
  image.linear = true;
  for (const Vec3f& value : picture.pixels) {
    const auto green = static_cast<std::uint8_t>(std::lround(255 * std::clamp(value.y(), 0.0f, 1.0f)));
    image.pixels.insert(image.pixels.end(), {255, green, 255});
  }
  return encode_png(image);
}

int wrap_mode(TextureWrap wrap) {
  constexpr int kRepeat = 10497, kClamp = 33071, kMirror = 33648;
  return wrap == TextureWrap::Repeat ? kRepeat : wrap == TextureWrap::Clamp ? kClamp : kMirror;
}

double least_side(const ExportBody& body) {
  const Bounds bounds = used_bounds(*body.mesh);
  return (bounds.max - bounds.min).minCoeff() * std::cbrt(body.file_to_space.linear.determinant());
}

}  // namespace

float glass_share(const Appearance& look) {
  return (1 - look.metallic) * look.transmission;
}

GltfLook::GltfLook(const ExportBody& body, bool has_coordinates) {
  const Appearance& look = body.appearance;
  const float glass = glass_share(look);
  const Vec3f color = shows_vertex_colors(body) ? Vec3f(Vec3f::Ones()) : look.base_color;
  const Vec3f base = (1 - glass) * color + glass * Vec3f::Ones();
  material_ = {{"name", body.material},
               {"pbrMetallicRoughness",
                {{"baseColorFactor", {base.x(), base.y(), base.z(), 1}},
                 {"metallicFactor", look.metallic},
                 {"roughnessFactor", look.roughness}}}};
  if (const float most = look.emission.maxCoeff(); most > 0)
    material_["emissiveFactor"] = triple(look.emission / std::max(1.0f, most));
  const double thickness = least_side(body);
  for (const Extension& extension : kExtensions) {
    Json object = extension.of(look, thickness);
    if (object.is_null()) continue;
    extensions_.insert(extension.name);
    material_["extensions"][extension.name] = std::move(object);
  }
  material_["doubleSided"] = extensions_.count(kVolume) == 0;
  if (has_coordinates) add_textures(body, material_["pbrMetallicRoughness"]);
}

void GltfLook::add_textures(const ExportBody& body, Json& metallic_roughness) {
  const TextureSettings& settings = body.textures;
  if (Json color = texture(settings.base_color, settings); !color.is_null()) {
    metallic_roughness["baseColorFactor"] = {1, 1, 1, 1};
    metallic_roughness["baseColorTexture"] = std::move(color);
  }
  if (Json rough = texture(settings.roughness, settings, body.appearance.metallic > 0); !rough.is_null()) {
    metallic_roughness["roughnessFactor"] = 1;
    metallic_roughness["metallicRoughnessTexture"] = std::move(rough);
  }
  if (Json normal = texture(settings.normal, settings); !normal.is_null()) {
    normal["scale"] = settings.normal_strength;
    material_["normalTexture"] = std::move(normal);
  }
  const int wrap = wrap_mode(settings.wrap);
  sampler_ = {{"wrapS", wrap}, {"wrapT", wrap}};
}

Json GltfLook::texture(const std::string& path, const TextureSettings& settings, bool is_roughness_of_metal) {
  const PictureKind kind = picture_kind(path);
  if (kind != PictureKind::Png && kind != PictureKind::Jpeg) return {};
  if (is_roughness_of_metal)
    pictures_.push_back({without_blue(path), "image/png"});
  else
    pictures_.push_back({read_file(path), kind == PictureKind::Png ? "image/png" : "image/jpeg"});
  textures_.push_back({{"sampler", 0}, {"source", pictures_.size() - 1}});
  Json reference{{"index", textures_.size() - 1}};
  if (settings.scale == Vec2::Ones() && settings.offset.isZero(0)) return reference;
  // v counts downwards there: 1 - (scale (1 - v) + offset).
  constexpr const char* kTransform = "KHR_texture_transform";
  extensions_.insert(kTransform);
  reference["extensions"][kTransform] = {
      {"offset", {settings.offset.x(), 1 - settings.scale.y() - settings.offset.y()}},
      {"scale", {settings.scale.x(), settings.scale.y()}}};
  return reference;
}

void GltfLook::describe(std::span<const int> views, Json& header) const {
  CHECK(views.size() == pictures_.size());
  if (!extensions_.empty()) header["extensionsUsed"] = extensions_;
  header["materials"] = Json::array({material_});
  if (pictures_.empty()) return;
  header["textures"] = textures_;
  header["samplers"] = Json::array({sampler_});
  for (std::size_t k = 0; k < views.size(); ++k)
    header["images"].push_back({{"bufferView", views[k]}, {"mimeType", pictures_[k].mime}});
}

}  // namespace softreel
