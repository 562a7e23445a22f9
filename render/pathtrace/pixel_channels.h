/// The channels of a picture beside its colour, gathered from what the camera rays hit first.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "render/image/cryptomatte.h"
#include "render/image/image.h"
#include "render/pathtrace/path_integrator.h"
#include "render/pathtrace/picture_channels.h"
#include "render/scene/camera_frame.h"
#include "render/scene/scene.h"

namespace softreel {

class PixelChannels;

/// One picture's channels. The scene is kept by reference.
class ChannelLayout {
 public:
  /// `picture`: its meshes are those of the scene, then the ground.
  ChannelLayout(const Scene& scene, const Picture& picture, ChannelSet channels, int width, int height);

  /// Whether any channel needs a PixelChannels: samples.N does not.
  bool gathers() const;
  /// Appends the planes, all 0, of the size of the image's first one:
  /// albedo.R/G/B, normal.X/Y/Z (means over all samples, 0 where nothing is hit);
  /// depth.Z, position.X/Y/Z (m; means over the samples that hit something);
  /// motion.X, motion.Y (pixels from this frame to the next, x to the right, y down: where the surface seen here will
  /// be is at the pixel plus the vector; the surroundings move with the camera's turning only); CryptoObject00.R ...,
  /// CryptoMaterial00.R ... (render/image/cryptomatte.h; the ground is "ground", or "ground_2", ... beside a body or
  /// material of that name); strain.V (mean over the samples that hit a mesh with strain); samples.N.
  void add_planes(Image& image) const;

  /// One pixel of the planes of add_planes, the first of which has the number first_plane. gathered: null unless
  /// gathers().
  void store(Image& image, std::size_t first_plane, std::size_t pixel, int samples,
             const PixelChannels* gathered) const;

 private:
  friend class PixelChannels;

  Vec2f motion(const Ray& camera_ray, const FirstHit& hit, bool& is_seen) const;

  const Scene& scene_;
  ChannelSet channels_;
  int width_, height_;
  CameraFrame camera_, next_camera_;
  std::vector<std::string> objects_, materials_;  ///< per mesh of the picture
  std::vector<float> object_ids_, material_ids_;
};

/// What one pixel gathers.
class PixelChannels {
 public:
  explicit PixelChannels(const ChannelLayout& layout) : layout_(layout) {}

  void add(const Ray& camera_ray, const FirstHit& hit);

 private:
  friend class ChannelLayout;

  struct Mean {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    void add(const Vec3f& value) {
      sum += value.cast<double>();
      ++count;
    }
    Vec3f value() const { return count > 0 ? Vec3f((sum / count).cast<float>()) : Vec3f(Vec3f::Zero()); }
  };

  /// Samples that hit a mesh.
  struct MeshHits {
    std::size_t mesh;
    int count;
  };
  void count_hit(std::size_t mesh);
  std::vector<IdCoverage> covering(const std::vector<float>& ids, int samples) const;

  std::reference_wrapper<const ChannelLayout> layout_;
  Mean albedo_, normal_, depth_, position_, motion_, strain_;
  std::vector<MeshHits> hits_;  ///< of the few meshes that were hit, in their order; empty unless ids are asked for
};

}  // namespace softreel
