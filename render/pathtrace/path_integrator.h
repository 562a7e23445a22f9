/// The light that arrives along one camera ray: a path of scattering events with light sampling at each.
///
/// Kajiya, The Rendering Equation, 1986; multiple importance sampling: Veach, Robust Monte Carlo Methods for Light
/// Transport Simulation, 1997, chapter 9; caustics blurred instead of left to chance: Kaplanyan and Dachsbacher, Path
/// Space Regularization for Holistic and Robust Light Transport, 2013.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/pathtrace/bsdf.h"
#include "render/pathtrace/colored_surface.h"
#include "render/pathtrace/direct_light.h"
#include "render/pathtrace/light_set.h"
#include "render/pathtrace/ray_cone.h"
#include "render/pathtrace/sampler.h"
#include "render/pathtrace/scene_rays.h"
#include "render/pathtrace/surface_point.h"
#include "render/scene/ground_mesh.h"

namespace softreel {

/// A scene made ready for paths. Borrows the scene's meshes and `rays`.
struct Picture {
  const SceneRays* rays = nullptr;
  std::vector<const MotionMesh*> meshes;                 ///< in the order of `rays`
  std::vector<Bsdf> bsdfs;                               ///< per mesh; last, if there is a pattern: its second tone
  std::vector<Bsdf> blurred;                             ///< the same, as seen by way of a wide scattering
  std::vector<std::optional<Bsdf>> lines;                ///< per mesh, of its EdgeLines
  std::vector<std::unique_ptr<ColoredSurface>> colored;  ///< per mesh; null for one whose look is the same everywhere
  float pixel = 0;                       ///< m, edge of a pixel of the window one metre ahead of the camera
  float cone_spread = 0;                 ///< of a camera ray's cone
  bool has_textures = false;             ///< anything asks how wide a ray's cone is
  bool has_emission = false;             ///< any mesh shines
  std::optional<GroundPattern> pattern;  ///< on the last mesh
  bool catches_shadows = false;          ///< the last mesh is a shadow catcher
  const LightSet* lights = nullptr;
  int samples = 1;  ///< paths a pixel
  DirectLight direct_light = DirectLight::Weighed;
  int max_bounces = 8;
  float clamp = 0;
};

/// What the auxiliary channels show of one camera ray; zeros where it hit nothing.
struct FirstHit {
  Vec3f albedo = Vec3f::Zero();
  Vec3f normal = Vec3f::Zero();
  float distance = 0;
  Vec3f position = Vec3f::Zero();
  Index mesh = -1, triangle = -1;      ///< of Picture::meshes; -1: nothing
  float u = 0, v = 0;                  ///< as RayHit
  float coverage = 0;                  ///< 1 where it hit what the camera sees
  bool caught = false;                 ///< it hit the shadow catcher:
  float unshadowed = 0, shadowed = 0;  ///< as CaughtLight
};

/// One path.
class PathIntegrator {
 public:
  PathIntegrator(const Picture& picture, const Sampler& sampler, std::uint32_t sample)
      : picture_(picture), sampler_(sampler), sample_(sample), cone_{0, picture.cone_spread} {}

  /// Radiance arriving at the start of a camera ray.
  Vec3f trace(const Ray& camera_ray);
  const FirstHit& first_hit() const { return first_hit_; }

 private:
  const Bsdf& bsdf_at(const RayHit& hit, SurfacePoint& point, const Ray& ray);
  void record_first_hit(const RayHit& hit, const SurfacePoint& point, const Bsdf& bsdf);
  /// What the ray sees by itself: lights it passes, surroundings if it hit nothing.
  void collect(const Ray& ray, bool hit, float distance);
  /// The same of a path's last ray where no mesh shines: what it hits need not be found.
  void collect_last(const Ray& ray);
  void add(const Vec3f& radiance);
  /// What the camera sees of the shadow catcher: nothing but its alpha.
  void catch_shadow(const RayHit& hit, const Ray& ray);
  /// Light sampling at a point. view: of `bsdf` from where the path comes; not asked for while light leaves a body.
  void add_direct(const Bsdf& bsdf, const SurfacePoint& point, const ShadingFrame& frame, const BsdfView& view,
                  const SampleBlock& numbers);
  /// Of every light, or of one of them. share: of the light that counts.
  void add_lights(const Bsdf& bsdf, const SurfacePoint& point, const ShadingFrame& frame, const BsdfView& view,
                  float choice, const Vec2f& u, float share);
  void add_light(const Bsdf& bsdf, const SurfacePoint& point, const ShadingFrame& frame, const BsdfView& view,
                 const LightSample& light, bool point_like);
  /// Continues the path; false where it ends.
  bool scatter(const Bsdf& bsdf, const SurfacePoint& point, const ShadingFrame& frame, const BsdfView& view,
               const SampleBlock& numbers, Ray& ray);
  /// Takes a sampled direction.
  void follow(const BsdfSample& next, const SurfacePoint& point, const ShadingFrame& frame, Ray& ray);
  /// From a subsurface sample at `point` through the body to where it leaves, lights sampled there; counts as one
  /// scattering with the one that entered. False where the path ends.
  bool scatter_inside(const Bsdf& bsdf, const SurfacePoint& point, const SampleBlock& numbers, Ray& ray);
  bool survives_roulette(float u);

  const Picture& picture_;
  const Sampler& sampler_;
  std::uint32_t sample_;
  Vec3f radiance_ = Vec3f::Zero();
  Vec3f throughput_ = Vec3f::Ones();
  int bounces_ = 0;  ///< scattering events so far
  float time_ = 0;
  Index mesh_ = -1;       ///< last one hit
  bool leaving_ = false;  ///< lights are sampled for light that leaves a body
  bool scattered_wide_ = false;
  RayOrigin origin_;
  FirstHit first_hit_;
  RayCone cone_;
  std::optional<Bsdf> colored_;  ///< of the last hit, if its mesh has a coloring
};

}  // namespace softreel
