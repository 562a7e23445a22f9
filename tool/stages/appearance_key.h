/// All of an Appearance that a shot can say, for keys.
#pragma once

#include "render/scene/material.h"
#include "tool/cache/key.h"

namespace softreel {

inline void add(KeyHasher& key, const Appearance& a) {
  key.add(a.base_color).add(a.roughness).add(a.metallic).add(a.specular).add(a.transmission).add(a.ior);
  key.add(a.absorption).add(a.emission);
  key.add(a.coat).add(a.coat_roughness).add(a.coat_ior).add(a.coat_color);
  key.add(a.sheen).add(a.sheen_roughness).add(a.sheen_color);
  key.add(a.subsurface).add(a.subsurface_radius).add(a.subsurface_scale).add(a.subsurface_anisotropy);
}

}  // namespace softreel
