/// The textures of a shot's materials: their files' checksums at once, their pyramids when a scene needs them.
#pragma once

#include <map>
#include <string>

#include "render/scene/texture.h"
#include "tool/bodies/loaded_body.h"
#include "tool/cache/key.h"
#include "tool/shot/shot.h"

namespace softreel {

class MaterialTextures {
 public:
  /// Reads the bytes of all texture files of materials that bodies wear. shot is kept by reference. Throws input_error
  /// naming file and field.
  explicit MaterialTextures(const Shot& shot);

  /// Throws input_error if the material asks for textures or vertex colours that the body's mesh has not, or if its
  /// numbers cannot be used.
  void require_match(const BodySettings& body, const LoadedBody& loaded) const;

  /// Whether the body has more than one look.
  bool varies(const BodySettings& body) const {
    const TextureSettings& t = material(body.material).textures;
    return t.any() || t.vertex_colors;
  }

  /// Everything that the coloring of a body depends on beside its shape; nothing for a material of one look.
  void add_key(KeyHasher& key, const BodySettings& body, const LoadedBody& loaded) const;

  /// Of the pictures that load() decodes, by their headers. Throws input_error.
  double count_texels() const;

  /// Decodes the files that are not decoded yet. Throws input_error.
  void load();
  /// After load().
  SurfaceColoring coloring(const BodySettings& body, const LoadedBody& loaded) const;

 private:
  const MaterialSettings& material(const std::string& name) const { return shot_.materials.at(name); }

  const Shot& shot_;
  std::map<std::string, StageKey> checksums_;  ///< per file
  std::map<std::string, TextureMaps> maps_;    ///< per material; filled by load()
};

}  // namespace softreel
