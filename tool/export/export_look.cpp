#include "tool/export/export_look.h"

#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/ranges.h>

#include "tool/cache/atomic_file.h"

namespace softreel {
namespace {

struct Loss {
  const char* what;
  const char* carried_by;  ///< the one format that has it; "": none
  bool (*has)(const MaterialSettings&);
};

bool is_other(const std::string& path) {
  return picture_kind(path) == PictureKind::Other;
}

constexpr std::array<Loss, 7> kLosses{{
    {"textures that are neither PNG nor JPEG", "usda",
     [](const MaterialSettings& m) {
       return is_other(m.textures.base_color) || is_other(m.textures.roughness) || is_other(m.textures.normal);
     }},
    {"bump_texture", "", [](const MaterialSettings& m) { return !m.textures.bump.empty(); }},
    {"sheen", "glb", [](const MaterialSettings& m) { return m.appearance.sheen > 0; }},
    {"absorption", "glb",
     [](const MaterialSettings& m) { return m.appearance.transmission > 0 && !m.appearance.absorption.isZero(0); }},
    {"coat_color and coat_ior", "",
     [](const MaterialSettings& m) {
       return m.appearance.coat > 0 && (m.appearance.coat_color != Vec3f::Ones() || m.appearance.coat_ior != 1.5f);
     }},
    {"subsurface", "", [](const MaterialSettings& m) { return m.appearance.subsurface > 0; }},
    {"changes over the frames", "", [](const MaterialSettings& m) { return !m.tracks.empty(); }},
}};

}  // namespace

PictureKind picture_kind(const std::string& path) {
  if (path.empty()) return PictureKind::None;
  const std::vector<std::uint8_t> bytes = read_file(path);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\x89PNG\r\n\x1a\n")) return PictureKind::Png;
  return text.starts_with("\xff\xd8\xff") ? PictureKind::Jpeg : PictureKind::Other;
}

double reflectance_of(double ior) {
  const double root = (ior - 1) / (ior + 1);
  return root * root;
}

double ior_of(double reflectance) {
  const double root = std::sqrt(reflectance);
  return (1 + root) / (1 - root);
}

double dielectric_reflectance(const Appearance& look) {
  const double glass = look.transmission;
  return (1 - glass) * 0.08 * look.specular + glass * reflectance_of(look.ior);
}

std::string lost_look(const std::string& format, const std::string& name, const MaterialSettings& material) {
  std::vector<std::string_view> lost;
  for (const Loss& loss : kLosses)
    if (format != loss.carried_by && loss.has(material)) lost.emplace_back(loss.what);
  if (lost.empty()) return "";
  return fmt::format(
      "material.{}: left out of {} files, which cannot say it: {}. Set it in the program that reads them.", name,
      format, fmt::join(lost, ", "));
}

}  // namespace softreel
