#include "render/pathtrace/picture_hash.h"

#include <cstddef>
#include <cstring>

namespace softreel {

namespace {

class Hash {
 public:
  /// Bytes of values without padding.
  void add(const void* data, std::size_t bytes) {
    const auto* from = static_cast<const unsigned char*>(data);
    for (; bytes >= 8; bytes -= 8, from += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, from, 8);
      mix(word);
    }
    std::uint64_t rest = bytes;
    std::memcpy(&rest, from, bytes);
    mix(rest + 0x51ed2701u);
  }
  std::uint64_t value() const { return state_; }

 private:
  /// One round of a multiplicative hash; the constants are the fractions of the golden ratio and of pi.
  void mix(std::uint64_t word) {
    state_ ^= word * 0x9e3779b97f4a7c15u;
    state_ = ((state_ << 29) | (state_ >> 35)) * 0x243f6a8885a308d3u;
  }
  std::uint64_t state_ = 0x13198a2e03707344u;
};

void add_camera(Hash& hash, const Camera& camera) {
  for (const Vec3f* v : {&camera.position, &camera.target, &camera.up}) hash.add(v->data(), sizeof(Vec3f));
  // Without a lens nothing is out of focus, and the key of a picture does not know where that would be.
  const float focus = camera.f_number > 0 ? camera.focus_distance : 0.0f;
  for (const float f : {camera.focal_length_mm, camera.sensor_width_mm, camera.f_number, focus}) hash.add(&f, sizeof f);
}

}  // namespace

std::uint64_t picture_hash(const Scene& scene) {
  Hash hash;
  add_camera(hash, scene.camera);
  for (const Camera& camera : scene.camera_motion) add_camera(hash, camera);
  for (const MotionMesh& mesh : scene.meshes) {
    hash.add(mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle));
    for (const MotionMesh::Time& time : mesh.times)
      hash.add(time.positions.data(), time.positions.size() * sizeof(Vec3f));
  }
  return hash.value();
}

}  // namespace softreel
