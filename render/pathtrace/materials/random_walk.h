/// Light inside a body that scatters it: flesh, wax, marble, jelly.
///
/// A path enters, is scattered among particles of the body and leaves somewhere else. Both ways lead evenly over the
/// projected hemisphere, and the index of the body is that of the air; what the surface reflects is the Bsdf's.
/// Chiang, Kutz and Burley, Practical and Controllable Subsurface Scattering for Production Path Tracing, 2016: the
/// walk, its colours and the width of the blur. Extinction differs by channel: a walk is drawn for one of them, and
/// weighed by the mean density of all (Wilkie et al., Hero Wavelength Spectral Sampling, 2014). The channel is chosen
/// once, by a well-spread number, so that a pixel's walks are shared out evenly: it makes most of the noise of colours.
#pragma once

#include <cstdint>

#include "render/pathtrace/materials/bsdf.h"
#include "render/pathtrace/rays/ray_scene.h"

namespace softreel {

/// What scatters and absorbs, by colour channel.
struct ScatteringMedium {
  Vec3f extinction = Vec3f::Zero();  ///< 1/m
  Vec3f albedo = Vec3f::Zero();      ///< share of a collision's light that is scattered
  float anisotropy = 0;              ///< g of Henyey and Greenstein
};

/// The medium of which a half-space under even light returns `color`.
///
/// The albedo inverts van de Hulst's formula of the half-space (Multiple Light Scattering, 1980, 9.3; as by Kulla and
/// Conty 2017), within 0.01 of the reflectance (0.015 at g = 0.9). Extinction: Chiang et al., their mean
/// free path taken as the transport mean free path, 1 / ((1 - g) sigma_s + sigma_a).
ScatteringMedium medium_of(const Subsurface& subsurface);

/// Uniform numbers for what the sampler has no dimensions left: PCG32 of O'Neill, PCG: A Family of Simple Fast
/// Space-Efficient Statistically Good Algorithms for Random Number Generation, 2014.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed);
  /// In [0, 1).
  float next();

 private:
  std::uint32_t step();
  std::uint64_t state_;
};

/// How a walk begins.
struct WalkStart {
  Ray ray;                           ///< from the surface inwards; its length is not looked at
  Vec3f importance = Vec3f::Ones();  ///< of the channels; proportional to their chance of setting the walk's lengths
  float choice = 0;                  ///< number in [0, 1), for the channel
  float first = 0;                   ///< the same, for the first length
};

/// Where a walk left the body.
struct WalkExit {
  RayHit hit;
  Ray ray;  ///< from inside to the hit
  Vec3f weight = Vec3f::Ones();
};

/// Walks inside `mesh`. False if the light is absorbed or lost.
///
/// Inside is counted in the mesh's own surfaces: a front makes it one deeper, a back one less, so that a body may
/// overlap itself. Light that strays out through a hole of an open mesh goes on as if the body filled all space: it is
/// lost unless it meets the mesh again, so that open meshes are darker near their holes. Once directions are forgotten,
/// anisotropic scattering is replaced by isotropic scattering of the same transport length (Wyman, Patterson and
/// Wilson, Similarity Relations for the Interaction Parameters in Radiation Transport, 1989), which takes fewer steps.
/// After kMostSteps scatterings the rest leaves straight on, so that a white body returns all its light however large
/// it is.
bool random_walk(const RayScene& rays, Index mesh, const ScatteringMedium& medium, const WalkStart& start,
                 RandomStream& numbers, WalkExit& exit);

}  // namespace softreel
