#include "render/pathtrace/path_integrator.h"

#include <bit>
#include <cmath>

#include "render/pathtrace/materials/random_walk.h"
#include "render/pathtrace/rays/edge_lines.h"
#include "render/pathtrace/shadow_catcher.h"

namespace softreel {

namespace {

/// Paths of this many scattering events may be ended by chance, once less than this share of light would come back:
/// a path costs less than what it finds is worth for longer than its share falls. With 1 in place of a quarter the
/// standard picture has a tenth more squared error, and takes 2 % less time.
constexpr int kRouletteStart = 3;
constexpr float kRouletteShare = 0.25f;

/// Up to so many lights are all sampled at what the camera sees directly, which makes most of the noise.
constexpr std::size_t kFewLights = 4;

/// Blocks of numbers from here on are those of the points where light leaves a body, one a scattering event.
constexpr std::uint32_t kLeavingBlocks = 1u << 16;

/// Block of the points on lights where they are sampled twice.
constexpr std::uint32_t kTwoLightsBlock = 1u << 17;

/// Times that a walk inside a body may meet the ground that the body stands on or in.
constexpr int kMostGroundMeetings = 16;

/// Dimensions of a scattering event's block.
enum Dimension : std::size_t {
  kLightU = 0,
  kLightV = 1,
  kBsdfU = 2,
  kBsdfV = 3,
  kSide = 4,
  kLight = 5,
  kRoulette = 6,
  kLength = 7
};

/// Towards a light that was sampled from point.lifted. Through the surface it starts at point.lowered, which may be
/// nearer to the light by more than the light's distance is short of it: the ray aims at the same end from there.
Ray shadow_ray(const SurfacePoint& point, bool through, const LightSample& light, float time) {
  Ray ray{point.lifted, light.direction, light.distance, time};
  if (!through) return ray;
  ray.origin = point.lowered;
  if (!std::isfinite(light.distance)) return ray;
  const Vec3f to = point.lifted + light.distance * light.direction - point.lowered;
  ray.max_distance = to.norm();
  ray.direction = to.normalized();
  return ray;
}

}  // namespace

const Bsdf& PathIntegrator::bsdf_at(const RayHit& hit, SurfacePoint& point, std::optional<Bsdf>& colored) {
  const auto mesh = static_cast<std::size_t>(hit.mesh);
  // Lines have a width in the picture only: no other ray sees them.
  if (picture_.lines[mesh] && origin_.from_camera && on_edge_line(*picture_.meshes[mesh], hit, ray_, picture_.pixel))
    return *picture_.lines[mesh];
  if (const ColoredSurface* surface = picture_.colored[mesh].get())
    return colored.emplace(surface->at(hit, ray_, cone_.width_at(hit.distance), scattered_wide_, point));
  if (picture_.pattern && mesh + 1 == picture_.meshes.size()) return ground_at(point.position);
  return (scattered_wide_ ? picture_.blurred : picture_.bsdfs)[mesh];
}

const Bsdf& PathIntegrator::ground_at(const Vec3f& position) const {
  const std::vector<Bsdf>& bsdfs = scattered_wide_ ? picture_.blurred : picture_.bsdfs;
  const bool alternates = picture_.pattern && picture_.pattern->alternate(position);
  return alternates ? bsdfs.back() : bsdfs[picture_.meshes.size() - 1];
}

void PathIntegrator::record_first_hit(const RayHit& hit, const SurfacePoint& point, const Bsdf& bsdf) {
  first_hit_.albedo = bsdf.albedo();
  first_hit_.normal = point.shading_normal;
  first_hit_.distance = hit.distance;
  first_hit_.position = point.position;
  first_hit_.mesh = hit.mesh;
  first_hit_.triangle = hit.triangle;
  first_hit_.u = hit.u;
  first_hit_.v = hit.v;
  first_hit_.coverage = 1;
}

Vec3f PathIntegrator::part_of(const Vec3f& radiance) const {
  Vec3f part = throughput_.cwiseProduct(radiance);
  // After the first scattering the light is direct; only what comes by way of another surface is clamped.
  if (picture_.clamp > 0 && bounces_ > 1) {
    const float largest = part.maxCoeff();
    if (largest > picture_.clamp) part *= picture_.clamp / largest;
  }
  return part;
}

void PathIntegrator::collect(bool hit, float distance) {
  const float reach = hit ? distance : ray_.max_distance;
  Vec3f found = picture_.lights->area_lights_along(ray_.origin, ray_.direction, reach, origin_);
  const bool shows_surroundings = !picture_.catches_shadows || bounces_ > 0;
  // Else what the camera sees of a lamp before nothing would be light without alpha, which PNGs cannot show.
  if (!shows_surroundings && found.maxCoeff() > 0) first_hit_.coverage = 1;
  if (!hit && shows_surroundings) found += picture_.lights->surroundings(ray_.direction, origin_);
  radiance_ += part_of(found);
}

void PathIntegrator::miss() {
  collect(false, 0);
  lives_on_ = false;
}

void PathIntegrator::end_on_last_ray() {
  lives_on_ = false;
  if (picture_.lights->area_lights_along(ray_.origin, ray_.direction, ray_.max_distance, origin_).maxCoeff() > 0) {
    RayHit hit;
    const bool found = picture_.rays->intersect(ray_, hit);
    collect(found, hit.distance);
    return;
  }
  const Vec3f beyond = picture_.lights->surroundings(ray_.direction, origin_);
  if (beyond.maxCoeff() > 0 && !picture_.rays->occluded(ray_)) radiance_ += part_of(beyond);
}

void PathIntegrator::catch_shadow(const RayHit& hit) {
  const SurfacePoint point = picture_.rays->surface_point(*picture_.meshes.back(), hit, ray_);
  const CaughtLight light = caught_light(picture_, point, ray_.time, sampler_.numbers(sample_, 1));
  first_hit_.caught = true;
  first_hit_.position = point.position;
  first_hit_.unshadowed = light.unshadowed;
  first_hit_.shadowed = light.shadowed;
}

void PathIntegrator::add_direct(const Event& event, const SampleBlock& numbers, PathScratch& scratch) {
  // Most of the noise of glossy bodies is in the highlights of lamps: two points halve it for one more shadow ray.
  if (bounces_ == 1 && !leaving_ && event.bsdf.has_highlight()) {
    for (const Vec2f& u : sampler_.two_points(sample_, kTwoLightsBlock))
      add_lights(event, numbers[kLight], u, 0.5f, scratch);
  } else {
    add_lights(event, numbers[kLight], Vec2f(numbers[kLightU], numbers[kLightV]), 1, scratch);
  }
}

void PathIntegrator::add_lights(const Event& event, float choice, const Vec2f& u, float share, PathScratch& scratch) {
  const LightSet& lights = *picture_.lights;
  const std::size_t rays = origin_.receiver.every_light ? lights.count() : 1;
  for (std::size_t k = 0; k < rays; ++k) {
    LightSample light;
    bool point_like = false;
    const bool found = origin_.receiver.every_light
                           ? lights.sample_light(k, origin_.receiver, choice, u, light, point_like)
                           : lights.sample(origin_.receiver, choice, u, light, point_like);
    light.radiance *= share;
    if (found) add_light(event, light, point_like, scratch.light_rays);
  }
}

void PathIntegrator::add_light(const Event& event, const LightSample& light, bool point_like,
                               std::vector<LightRay>& light_rays) {
  if (picture_.direct_light == DirectLight::Scattering) return;
  const Vec3f towards = event.frame.to_local(light.direction);
  const BsdfValue value = leaving_ ? event.bsdf.evaluate_leaving(towards) : event.bsdf.evaluate(event.view, towards);
  if (value.value.maxCoeff() <= 0) return;
  const bool weighed = !point_like && picture_.direct_light == DirectLight::Weighed;
  const float weight = weighed ? power_heuristic(light.pdf, value.pdf) : 1.0f;
  const bool through = towards.z() < 0;
  const Ray shadow = shadow_ray(event.point, through, light, ray_.time);
  const Vec3f arriving = light.radiance.cwiseProduct(transmittance(through ? behind_ : before_, shadow.max_distance));
  light_rays.push_back({shadow, part_of(value.value.cwiseProduct(arriving) * (weight / light.pdf)), number_});
}

bool PathIntegrator::scatter(const Event& event, const SampleBlock& numbers, PathScratch& scratch) {
  BsdfSample next;
  if (!event.bsdf.sample(event.view, numbers[kSide], Vec2f(numbers[kBsdfU], numbers[kBsdfV]), next)) return false;
  throughput_ = throughput_.cwiseProduct(next.weight);
  if (!(throughput_.maxCoeff() > 0)) return false;
  follow(next, event.point, event.frame);
  if (next.subsurface && !scatter_inside(event.bsdf, event.point, next.direction, scratch)) return false;
  return bounces_ < kRouletteStart || survives_roulette(numbers[kRoulette]);
}

void PathIntegrator::follow(const BsdfSample& next, const SurfacePoint& point, const ShadingFrame& frame) {
  ray_.origin = next.direction.z() < 0 ? point.lowered : point.lifted;
  ray_.direction = frame.to_world(next.direction);
  ray_.max_distance = std::numeric_limits<float>::infinity();
  // Density 0 gives lights that are met by scattering no weight beside their sampling.
  origin_.pdf = picture_.direct_light == DirectLight::Lights ? 0 : next.pdf;
  origin_.only_way = next.mirror || picture_.direct_light == DirectLight::Scattering;
  scattered_wide_ = scattered_wide_ || next.wide;
  origin_.from_camera = false;
  origin_.absorption = next.direction.z() < 0 ? behind_ : before_;
}

bool PathIntegrator::scatter_inside(const Bsdf& bsdf, const SurfacePoint& point, const Vec3f& inward,
                                    PathScratch& scratch) {
  // About the triangle's own normal: the interpolated one could lead out again.
  ray_.direction = ShadingFrame(point.geometric_normal).to_world(inward);
  const SampleBlock leaving_numbers = sampler_.numbers(sample_, kLeavingBlocks + static_cast<std::uint32_t>(bounces_));
  SurfacePoint out;
  if (!walk_out(bsdf.subsurface(), point, leaving_numbers, out)) return false;
  const ShadingFrame frame(out.shading_normal);
  origin_.receiver = {out.lifted, out.shading_normal, false, origin_.receiver.every_light, ray_.time};
  leaving_ = true;
  add_direct({bsdf, out, frame, {}}, leaving_numbers, scratch);
  leaving_ = false;
  BsdfSample next;
  next.direction = cosine_hemisphere(Vec2f(leaving_numbers[kBsdfU], leaving_numbers[kBsdfV]));
  const BsdfValue value = bsdf.evaluate_leaving(next.direction);
  if (!(value.pdf > 0)) return false;
  throughput_ = throughput_.cwiseProduct(value.value / value.pdf);
  next.pdf = value.pdf;
  next.wide = true;
  follow(next, out, frame);
  return true;
}

FloorSide PathIntegrator::side_of_floor(const SurfacePoint& entry) const {
  const FloorSide side = picture_.rays->side_of_floor(entry.position);
  if (side != FloorSide::Near) return side;
  return entry.lifted.y() < entry.position.y() ? FloorSide::Below : FloorSide::Above;
}

bool PathIntegrator::walk_out(const Subsurface& inside, const SurfacePoint& entry, const SampleBlock& numbers,
                              SurfacePoint& out) {
  RandomStream stream(std::uint64_t{std::bit_cast<std::uint32_t>(numbers[kRoulette])} << 32 |
                      std::bit_cast<std::uint32_t>(numbers[kBsdfU]));
  const ScatteringMedium medium = medium_of(inside);
  const FloorSide side = side_of_floor(entry);
  SurfacePoint from = entry;
  WalkStart start{ray_, throughput_.cwiseProduct(inside.color), numbers[kSide], numbers[kLength]};
  for (int k = 0; k < kMostGroundMeetings; ++k) {
    WalkExit exit;
    if (!random_walk(picture_.rays->trees(), mesh_, medium, start, stream, exit)) return false;
    throughput_ = throughput_.cwiseProduct(exit.weight);
    // Seen from outside: the ray that would come in where the walk goes out.
    Ray seen = exit.ray;
    seen.direction = -exit.ray.direction;
    out = surface_point(*picture_.meshes[static_cast<std::size_t>(mesh_)], exit.hit, seen);
    const FloorSide now = picture_.rays->side_of_floor(out.position);
    if (now != FloorSide::Near && (now == side || now == FloorSide::Beyond || side == FloorSide::Beyond)) return true;
    // The floor was in the way: it sends the light back in, where the sole is in the floor from there, where the floor
    // cuts the body from the last place on this side of it, which stands for the cut.
    throughput_ = throughput_.cwiseProduct(ground_at(out.position).albedo());
    if (now == FloorSide::Near) from = out;
    const Vec3f inward = -cosine_hemisphere(Vec2f(stream.next(), stream.next()));
    start.ray.origin = from.lowered;
    start.ray.direction = ShadingFrame(from.geometric_normal).to_world(inward);
    start.importance = throughput_.cwiseProduct(inside.color);
    start.choice = stream.next();
    start.first = stream.next();
  }
  return false;
}

bool PathIntegrator::survives_roulette(float u) {
  const float chance = std::min(1.0f, throughput_.maxCoeff() / kRouletteShare);
  if (u >= chance) return false;
  throughput_ /= chance;
  return true;
}

/// Bodies of dyed glass may hold others, or stand in the ground. Behind the back of a body lies air, also where that
/// body is inside another: what it meets next there is the other's back, which tells.
void PathIntegrator::find_media(const Bsdf& bsdf, const SurfacePoint& point) {
  before_ = point.inside && bsdf.transmits() ? bsdf.absorption() : origin_.absorption;
  behind_ = !point.inside && bsdf.transmits() ? bsdf.absorption() : Vec3f(Vec3f::Zero());
}

void PathIntegrator::arrive(const RayHit& hit, PathScratch& scratch) {
  mesh_ = hit.mesh;
  const MotionMesh& mesh = *picture_.meshes[static_cast<std::size_t>(hit.mesh)];
  collect(true, hit.distance);
  lives_on_ = false;
  if (bounces_ == 0 && picture_.catches_shadows && hit.mesh + 1 == static_cast<Index>(picture_.meshes.size())) {
    if (first_hit_.coverage == 0) catch_shadow(hit);
    return;
  }
  const SampleBlock numbers = sampler_.numbers(sample_, static_cast<std::uint32_t>(bounces_ + 1));
  SurfacePoint point = picture_.rays->surface_point(mesh, hit, ray_);
  const Bsdf& bsdf = bsdf_at(hit, point, scratch.colored);
  if (bounces_ == 0) record_first_hit(hit, point, bsdf);
  find_media(bsdf, point);
  throughput_ = throughput_.cwiseProduct(transmittance(before_, hit.distance));
  if (!point.inside && bsdf.emission().maxCoeff() > 0)
    radiance_ += part_of(picture_.lights->emission_weight(ray_, hit, origin_) * bsdf.emission());
  if (bounces_ == picture_.max_bounces) return;
  ++bounces_;
  const ShadingFrame frame(point.shading_normal);
  const BsdfView view = bsdf.seen_from(frame.to_local(-ray_.direction), point.inside);
  if (!(view.o.z() > 0)) return;  // a triangle without area has no normal
  const bool every_light = bounces_ == 1 && picture_.lights->count() <= kFewLights;
  origin_.receiver = {point.lifted, point.shading_normal, bsdf.transmits(), every_light, ray_.time};
  const Event event{bsdf, point, frame, view};
  if (bsdf.has_smooth_part()) add_direct(event, numbers, scratch);
  lives_on_ = scatter(event, numbers, scratch);
  if (lives_on_ && picture_.has_textures)
    cone_ = cone_.scattered(hit.distance, origin_.pdf, static_cast<float>(picture_.samples));
}

}  // namespace softreel
