/// The light that arrives along one camera ray: a path of scattering events with light sampling at each.
///
/// Kajiya, The Rendering Equation, 1986; multiple importance sampling: Veach, Robust Monte Carlo Methods for Light
/// Transport Simulation, 1997, chapter 9; caustics blurred instead of left to chance: Kaplanyan and Dachsbacher, Path
/// Space Regularization for Holistic and Robust Light Transport, 2013.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/pathtrace/direct_light.h"
#include "render/pathtrace/lights/light_set.h"
#include "render/pathtrace/materials/bsdf.h"
#include "render/pathtrace/materials/colored_surface.h"
#include "render/pathtrace/rays/ray_cone.h"
#include "render/pathtrace/rays/sampler.h"
#include "render/pathtrace/rays/scene_rays.h"
#include "render/pathtrace/rays/surface_point.h"
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
  Vec3f position = Vec3f::Zero();  ///< of the shadow catcher too
  Index mesh = -1, triangle = -1;  ///< of Picture::meshes; -1: nothing
  float u = 0, v = 0;              ///< as RayHit
  float coverage = 0;              ///< 1 where it hit what the camera sees; by a shadow catcher, where it met a lamp
  bool caught = false;             ///< it hit the shadow catcher:
  float unshadowed = 0, shadowed = 0;  ///< as CaughtLight
};

/// What paths that are traced side by side (path_group.h) share.
struct PathScratch {
  /// A ray towards a light, and what its path gains where nothing is in the way.
  struct LightRay {
    Ray ray;
    Vec3f part;
    std::size_t path;
  };
  std::vector<LightRay> light_rays;
  std::optional<Bsdf> colored;  ///< of the last hit, if its mesh has a coloring
};

/// One path, from event to event. While lives_on(), its ray is to be shot, and what it meets to be told: miss() or
/// arrive(); but of its last one, where is_on_last_ray(), end_on_last_ray() finds what counts.
class PathIntegrator {
 public:
  /// number: its place among the paths beside it, for LightRay::path.
  PathIntegrator(const Picture& picture, const Sampler& sampler, std::uint32_t sample, const Ray& camera_ray,
                 std::size_t number)
      : picture_(picture),
        sampler_(sampler),
        sample_(sample),
        number_(number),
        camera_ray_(camera_ray),
        ray_(camera_ray),
        cone_{0, picture.cone_spread} {}

  bool lives_on() const { return lives_on_; }
  const Ray& ray() const { return ray_; }
  /// Whether the ray is its last one. Where no mesh shines, what that hits need not be found: only whether.
  bool is_on_last_ray() const { return bounces_ > 0 && bounces_ == picture_.max_bounces && !picture_.has_emission; }
  void end_on_last_ray();
  void miss();
  /// Scatters where the ray hit, and leaves rays towards lights in `scratch`.
  void arrive(const RayHit& hit, PathScratch& scratch);
  /// Of a light ray that nothing is in the way of.
  void gain(const Vec3f& part) { radiance_ += part; }

  const Ray& camera_ray() const { return camera_ray_; }
  /// Radiance arriving at the start of the camera ray.
  const Vec3f& radiance() const { return radiance_; }
  const FirstHit& first_hit() const { return first_hit_; }

 private:
  using LightRay = PathScratch::LightRay;

  /// A place where light is scattered. view: of `bsdf` from where the path comes; not asked for while light leaves a
  /// body.
  struct Event {
    const Bsdf& bsdf;
    const SurfacePoint& point;
    const ShadingFrame& frame;
    const BsdfView& view;
  };

  const Bsdf& bsdf_at(const RayHit& hit, SurfacePoint& point, std::optional<Bsdf>& colored);
  /// Of the ground, which is the last mesh.
  const Bsdf& ground_at(const Vec3f& position) const;
  void record_first_hit(const RayHit& hit, const SurfacePoint& point, const Bsdf& bsdf);
  /// What the ray sees by itself: lights it passes, surroundings if it hit nothing.
  void collect(bool hit, float distance);
  /// What light that arrives at the last event adds.
  Vec3f part_of(const Vec3f& radiance) const;
  /// What the camera sees of the shadow catcher: nothing but its alpha.
  void catch_shadow(const RayHit& hit);
  /// Light sampling.
  void add_direct(const Event& event, const SampleBlock& numbers, PathScratch& scratch);
  /// Of every light, or of one of them. share: of the light that counts.
  void add_lights(const Event& event, float choice, const Vec2f& u, float share, PathScratch& scratch);
  void add_light(const Event& event, const LightSample& light, bool point_like, std::vector<LightRay>& light_rays);
  /// Continues the path; false where it ends.
  bool scatter(const Event& event, const SampleBlock& numbers, PathScratch& scratch);
  /// Takes a sampled direction.
  void follow(const BsdfSample& next, const SurfacePoint& point, const ShadingFrame& frame);
  /// From a subsurface sample at `point`, which led `inward` (local to the triangle's own normal), through the body to
  /// where it leaves, lights sampled there; counts as one scattering with the one that entered. False where the path
  /// ends.
  bool scatter_inside(const Bsdf& bsdf, const SurfacePoint& point, const Vec3f& inward, PathScratch& scratch);
  /// The side of the floor that light enters a body on.
  FloorSide side_of_floor(const SurfacePoint& entry) const;
  /// Walks from ray_, which begins at `entry`, through the body to where light leaves it on the same side of the floor;
  /// false where the path ends.
  bool walk_out(const Subsurface& inside, const SurfacePoint& entry, const SampleBlock& numbers, SurfacePoint& out);
  /// What the ray that arrives at `point` came through, and what is behind it.
  void find_media(const Bsdf& bsdf, const SurfacePoint& point);
  bool survives_roulette(float u);

  const Picture& picture_;
  Sampler sampler_;
  std::uint32_t sample_;
  std::size_t number_;
  Ray camera_ray_, ray_;
  bool lives_on_ = true;
  Vec3f radiance_ = Vec3f::Zero();
  Vec3f throughput_ = Vec3f::Ones();
  int bounces_ = 0;       ///< scattering events so far
  Index mesh_ = -1;       ///< last one hit
  bool leaving_ = false;  ///< lights are sampled for light that leaves a body
  bool scattered_wide_ = false;
  RayOrigin origin_;
  Vec3f before_ = Vec3f::Zero(), behind_ = Vec3f::Zero();  ///< 1/m, absorption on both sides of the last surface
  FirstHit first_hit_;
  RayCone cone_;
};

}  // namespace softreel
