/// A material in the words of glTF 2.0 and of its Khronos extensions, with the pictures that it shows.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tool/export/exporter.h"

namespace softreel {

/// The share of light that a look lets through, in [0, 1].
float glass_share(const Appearance& look);

/// Extensions are used where the look has what they say, and named in extensionsUsed. Glass is a volume, whose sides
/// are not both drawn: the thickness that readers without ray tracing bend light by is the shortest side of the body's
/// box. As glTF tints glass by the base colour, which we do not, that goes to white with the share of glass. It is
/// white where the vertices have the colours, which it would multiply.
class GltfLook {
 public:
  struct Picture {
    std::vector<std::uint8_t> bytes;
    const char* mime = nullptr;
  };

  /// Reads the pictures, if the mesh is written with texture coordinates. Throws input_error.
  GltfLook(const ExportBody& body, bool has_coordinates);

  /// To be written as buffer views of their own.
  const std::vector<Picture>& pictures() const { return pictures_; }
  /// Adds the material, its textures and its extensions; views: of the pictures, in order.
  void describe(std::span<const int> views, nlohmann::ordered_json& header) const;

 private:
  using Json = nlohmann::ordered_json;

  void add_textures(const ExportBody& body, Json& metallic_roughness);
  /// A reference to the picture of this path; null if glTF has no such pictures.
  Json texture(const std::string& path, const TextureSettings& settings, bool is_roughness_of_metal = false);

  Json material_, textures_ = Json::array(), sampler_;
  std::vector<Picture> pictures_;
  std::set<std::string> extensions_;
};

}  // namespace softreel
