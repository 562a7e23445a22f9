#include "render/pathtrace/pixel_channels.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <string>

namespace softreel {
namespace {

/// "ground", or the first of "ground_2", ... that no body or material has: mattes of the same name are one.
std::string ground_name(const Scene& scene, std::string MotionMesh::*name) {
  std::string ground = "ground";
  const auto is_taken = [&](const MotionMesh& mesh) { return mesh.*name == ground; };
  for (int k = 2; std::any_of(scene.meshes.begin(), scene.meshes.end(), is_taken); ++k)
    ground = "ground_" + std::to_string(k);
  return ground;
}

/// Where a point, or a direction from anywhere if `direction`, is in the picture: pixels from the top left corner. None
/// if it is not ahead.
std::optional<Vec2f> projected(const CameraFrame& camera, int width, int height, const Vec3f& point, bool direction) {
  const Vec3f ray = direction ? point : Vec3f(point - camera.position);
  const float ahead = ray.dot(camera.forward);
  if (!(ahead > 0)) return std::nullopt;
  const float x = ray.dot(camera.right) / (ahead * camera.half_width);
  const float y = ray.dot(camera.up) / (ahead * camera.half_height);
  return Vec2f(0.5f * (1 + x) * static_cast<float>(width), 0.5f * (1 - y) * static_cast<float>(height));
}

Vec3f point_of(const std::vector<Vec3f>& positions, const Triangle& triangle, float u, float v) {
  const auto at = [&](std::size_t k) -> const Vec3f& { return positions[static_cast<std::size_t>(triangle[k])]; };
  return (1 - u - v) * at(0) + u * at(1) + v * at(2);
}

std::vector<float> ids_of(const std::vector<std::string>& names) {
  std::vector<float> ids;
  for (const std::string& name : names) ids.push_back(std::bit_cast<float>(cryptomatte_id(name)));
  return ids;
}

}  // namespace

ChannelLayout::ChannelLayout(const Scene& scene, const Picture& picture, ChannelSet channels, int width, int height)
    : scene_(scene),
      channels_(channels),
      width_(width),
      height_(height),
      camera_(camera_frame(scene.camera, width, height)),
      next_camera_(scene.next_camera ? camera_frame(*scene.next_camera, width, height) : camera_) {
  const std::string ground = ground_name(scene, &MotionMesh::name);
  const std::string ground_material = ground_name(scene, &MotionMesh::material);
  for (std::size_t m = 0; m < picture.meshes.size(); ++m) {
    const bool is_ground = m >= scene.meshes.size();
    objects_.push_back(is_ground ? ground : picture.meshes[m]->name);
    materials_.push_back(is_ground ? ground_material : picture.meshes[m]->material);
  }
  object_ids_ = ids_of(objects_);
  material_ids_ = ids_of(materials_);
}

void ChannelLayout::add_planes(Image& image) const {
  const std::size_t pixels = image.channels.front().pixels.size();
  const auto add = [&](PictureChannel channel, std::initializer_list<const char*> names) {
    if (!channels_.has(channel)) return;
    for (const char* name : names) image.channels.push_back({name, std::vector<float>(pixels)});
  };
  add(PictureChannel::Albedo, {"albedo.R", "albedo.G", "albedo.B"});
  add(PictureChannel::Normal, {"normal.X", "normal.Y", "normal.Z"});
  add(PictureChannel::Depth, {"depth.Z"});
  add(PictureChannel::Position, {"position.X", "position.Y", "position.Z"});
  add(PictureChannel::Motion, {"motion.X", "motion.Y"});
  add(PictureChannel::Strain, {"strain.V"});
  add(PictureChannel::Samples, {"samples.N"});
  if (channels_.has(PictureChannel::ObjectId)) add_cryptomatte(image, {"CryptoObject", objects_});
  if (channels_.has(PictureChannel::MaterialId)) add_cryptomatte(image, {"CryptoMaterial", materials_});
}

Vec2f ChannelLayout::motion(const Ray& camera_ray, const FirstHit& hit, bool& is_seen) const {
  std::optional<Vec2f> here, there;
  if (hit.mesh < 0 && !hit.caught) {
    here = projected(camera_, width_, height_, camera_ray.direction, true);
    there = projected(next_camera_, width_, height_, camera_ray.direction, true);
  } else {
    Vec3f now = hit.position, next = hit.position;
    const bool is_body = hit.mesh >= 0 && static_cast<std::size_t>(hit.mesh) < scene_.meshes.size();
    if (is_body) {  // else the ground, which stands still
      const MotionMesh& mesh = scene_.meshes[static_cast<std::size_t>(hit.mesh)];
      const Triangle& triangle = mesh.triangles[static_cast<std::size_t>(hit.triangle)];
      // The shutter closes at the frame: from there to the next one, whenever the ray was shot.
      now = next = point_of(mesh.times.back().positions, triangle, hit.u, hit.v);
      if (!mesh.next_positions.empty()) next = point_of(mesh.next_positions, triangle, hit.u, hit.v);
    }
    here = projected(camera_, width_, height_, now, false);
    there = projected(next_camera_, width_, height_, next, false);
  }
  is_seen = here.has_value() && there.has_value();
  return is_seen ? Vec2f(*there - *here) : Vec2f(Vec2f::Zero());
}

void PixelChannels::add(const Ray& camera_ray, const FirstHit& hit) {
  const ChannelLayout& layout = layout_;
  const ChannelSet& channels = layout.channels_;
  const bool found = hit.mesh >= 0;
  albedo_.add(hit.albedo);
  normal_.add(hit.normal);
  if (found) depth_.add(Vec3f(hit.distance, 0, 0));
  if (found) position_.add(hit.position);
  if (channels.has(PictureChannel::Motion)) {
    bool is_seen = false;
    const Vec2f motion = layout.motion(camera_ray, hit, is_seen);
    if (is_seen) motion_.add(Vec3f(motion.x(), motion.y(), 0));
  }
  if (!found) return;
  const auto m = static_cast<std::size_t>(hit.mesh);
  if (channels.has(PictureChannel::Strain) && m < layout.scene_.meshes.size()) {
    const MotionMesh& mesh = layout.scene_.meshes[m];
    if (!mesh.strain.empty()) {
      const Triangle& triangle = mesh.triangles[static_cast<std::size_t>(hit.triangle)];
      const auto at = [&](std::size_t k) { return mesh.strain[static_cast<std::size_t>(triangle[k])]; };
      strain_.add(Vec3f((1 - hit.u - hit.v) * at(0) + hit.u * at(1) + hit.v * at(2), 0, 0));
    }
  }
  if (!channels.has(PictureChannel::ObjectId) && !channels.has(PictureChannel::MaterialId)) return;
  count_hit(m);
}

void PixelChannels::count_hit(std::size_t mesh) {
  const auto is_before = [](const MeshHits& hits, std::size_t m) { return hits.mesh < m; };
  const auto place = std::lower_bound(hits_.begin(), hits_.end(), mesh, is_before);
  if (place != hits_.end() && place->mesh == mesh)
    ++place->count;
  else
    hits_.insert(place, {mesh, 1});
}

/// ids: per mesh; meshes of the same name are one object.
std::vector<IdCoverage> PixelChannels::covering(const std::vector<float>& ids, int samples) const {
  std::vector<IdCoverage> all;
  for (const MeshHits& hits : hits_) {
    const float id = ids[hits.mesh];
    const auto is_same = [id](const IdCoverage& known) {
      return std::bit_cast<std::uint32_t>(known.id) == std::bit_cast<std::uint32_t>(id);
    };
    const auto known = std::find_if(all.begin(), all.end(), is_same);
    IdCoverage& covered = known != all.end() ? *known : all.emplace_back(IdCoverage{id, 0});
    covered.coverage += static_cast<float>(hits.count) / static_cast<float>(samples);
  }
  return all;
}

bool ChannelLayout::gathers() const {
  ChannelSet counted;
  counted.add(PictureChannel::Samples);
  return (channels_.bits & ~counted.bits) != 0;
}

void ChannelLayout::store(Image& image, std::size_t first_plane, std::size_t pixel, int samples,
                          const PixelChannels* gathered) const {
  std::size_t plane = first_plane;
  const auto put = [&](PictureChannel channel, const Vec3f& value, int count) {
    if (!channels_.has(channel)) return;
    for (int c = 0; c < count; ++c) image.channels[plane++].pixels[pixel] = value[c];
  };
  const auto put_mean = [&](PictureChannel channel, PixelChannels::Mean PixelChannels::*mean, int count) {
    if (gathered != nullptr) put(channel, (gathered->*mean).value(), count);
  };
  put_mean(PictureChannel::Albedo, &PixelChannels::albedo_, 3);
  put_mean(PictureChannel::Normal, &PixelChannels::normal_, 3);
  put_mean(PictureChannel::Depth, &PixelChannels::depth_, 1);
  put_mean(PictureChannel::Position, &PixelChannels::position_, 3);
  put_mean(PictureChannel::Motion, &PixelChannels::motion_, 2);
  put_mean(PictureChannel::Strain, &PixelChannels::strain_, 1);
  put(PictureChannel::Samples, Vec3f::Constant(static_cast<float>(samples)), 1);
  const auto put_ids = [&](PictureChannel channel, const std::vector<float>& ids) {
    if (gathered == nullptr || !channels_.has(channel)) return;
    std::vector<IdCoverage> covering = gathered->covering(ids, samples);
    store_cryptomatte(image, plane, pixel, covering);
    plane += 2 * kCryptomatteRanks;
  };
  put_ids(PictureChannel::ObjectId, object_ids_);
  put_ids(PictureChannel::MaterialId, material_ids_);
}

}  // namespace softreel
