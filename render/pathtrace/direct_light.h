/// The strategies of light sampling, which tests compare; pictures use both, weighed.
#pragma once

namespace softreel {

/// How light from lamps and sky is found at a point.
enum class DirectLight {
  Weighed,     ///< by sampling lights and by scattering, each weighed by its density
  Lights,      ///< by sampling lights, where they can be sampled and the surface is no mirror
  Scattering,  ///< by scattering only: lights without extent stay dark
};

}  // namespace softreel
