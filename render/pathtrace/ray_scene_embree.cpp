/// The only place that knows Embree.
#include <cstring>
#include <string>

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "render/pathtrace/ray_scene.h"

namespace softreel {
namespace {

/// One instruction set on all machines: the same trees and the same intersections, bit for bit.
std::string device_config(int threads) {
  return fmt::format("isa=avx2,threads={}", threads);
}

void require_no_error(RTCDevice device, const char* what) {
  const RTCError code = rtcGetDeviceError(device);
  if (code == RTC_ERROR_NONE) return;
  const char* reason = code == RTC_ERROR_OUT_OF_MEMORY     ? "out of memory"
                       : code == RTC_ERROR_UNSUPPORTED_CPU ? "this processor lacks AVX2"
                                                           : "internal error";
  throw work_error(
      fmt::format("Embree: {} failed with error {} ({}).\n"
                  "  Accepted: an x86-64-v3 processor and room for about 100 bytes a triangle. "
                  "Use another machine or a smaller mesh.",
                  what, static_cast<int>(code), reason));
}

/// Copies into a buffer owned by Embree, which pads it for its vector loads.
void copy_positions(RTCGeometry geometry, unsigned slot, const std::vector<Vec3f>& positions) {
  void* buffer = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, slot, RTC_FORMAT_FLOAT3, sizeof(Vec3f),
                                         positions.size());
  if (buffer != nullptr) std::memcpy(buffer, positions.data(), positions.size() * sizeof(Vec3f));
}

void copy_triangles(RTCGeometry geometry, const std::vector<Triangle>& triangles) {
  void* buffer =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), triangles.size());
  if (buffer != nullptr) std::memcpy(buffer, triangles.data(), triangles.size() * sizeof(Triangle));
}

RTCIntersectContext context_of(bool coherent) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

RTCRay embree_ray(const Ray& ray) {
  RTCRay out;
  out.org_x = ray.origin.x();
  out.org_y = ray.origin.y();
  out.org_z = ray.origin.z();
  out.tnear = 0;
  out.dir_x = ray.direction.x();
  out.dir_y = ray.direction.y();
  out.dir_z = ray.direction.z();
  out.time = ray.time;
  out.tfar = ray.max_distance;
  out.mask = 0xffffffffu;
  out.id = 0;
  out.flags = 0;
  return out;
}

class EmbreeScene : public RayScene {
 public:
  explicit EmbreeScene(int threads) : device_(rtcNewDevice(device_config(threads).c_str())) {
    require_no_error(device_, "starting");
    CHECK(device_ != nullptr);
  }
  ~EmbreeScene() override {
    release_scenes();
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  void build(const std::vector<const MotionMesh*>& meshes) override;
  bool intersect(const Ray& ray, RayHit& hit, bool coherent) const override;
  bool intersect_body(Index mesh, const Ray& ray, RayHit& hit, bool& front) const override;
  bool occluded(const Ray& ray, bool coherent) const override;

 private:
  void attach(const MotionMesh& mesh, unsigned id);
  RTCScene new_scene() const;
  void release_scenes();

  RTCDevice device_;
  RTCScene scene_ = nullptr;
  std::vector<RTCScene> bodies_;  ///< per mesh, of it alone; null where light does not scatter inside
};

RTCScene EmbreeScene::new_scene() const {
  const RTCScene scene = rtcNewScene(device_);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  return scene;
}

void EmbreeScene::release_scenes() {
  for (const RTCScene body : bodies_)
    if (body != nullptr) rtcReleaseScene(body);
  bodies_.clear();
  if (scene_ != nullptr) rtcReleaseScene(scene_);
  scene_ = nullptr;
}

void EmbreeScene::attach(const MotionMesh& mesh, unsigned id) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
  rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(mesh.times.size()));
  for (std::size_t step = 0; step < mesh.times.size(); ++step)
    copy_positions(geometry, static_cast<unsigned>(step), mesh.times[step].positions);
  copy_triangles(geometry, mesh.triangles);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_, geometry, id);
  if (mesh.appearance.subsurface > 0) {
    bodies_[id] = new_scene();
    rtcAttachGeometryByID(bodies_[id], geometry, 0);
  }
  rtcReleaseGeometry(geometry);
}

void EmbreeScene::build(const std::vector<const MotionMesh*>& meshes) {
  release_scenes();
  scene_ = new_scene();
  bodies_.assign(meshes.size(), nullptr);
  for (std::size_t m = 0; m < meshes.size(); ++m) attach(*meshes[m], static_cast<unsigned>(m));
  require_no_error(device_, "copying a mesh");
  rtcCommitScene(scene_);
  for (const RTCScene body : bodies_)
    if (body != nullptr) rtcCommitScene(body);
  require_no_error(device_, "building trees");
}

bool EmbreeScene::intersect(const Ray& ray, RayHit& hit, bool coherent) const {
  RTCIntersectContext context = context_of(coherent);
  RTCRayHit query;
  query.ray = embree_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit.distance = query.ray.tfar;
  hit.u = query.hit.u;
  hit.v = query.hit.v;
  hit.mesh = static_cast<Index>(query.hit.geomID);
  hit.triangle = static_cast<Index>(query.hit.primID);
  return true;
}

bool EmbreeScene::intersect_body(Index mesh, const Ray& ray, RayHit& hit, bool& front) const {
  RTCIntersectContext context = context_of(false);
  RTCRayHit query;
  query.ray = embree_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(bodies_[static_cast<std::size_t>(mesh)], &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = {query.ray.tfar, query.hit.u, query.hit.v, mesh, static_cast<Index>(query.hit.primID)};
  front = Vec3f(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).dot(ray.direction) < 0;
  return true;
}

bool EmbreeScene::occluded(const Ray& ray, bool coherent) const {
  RTCIntersectContext context = context_of(coherent);
  RTCRay query = embree_ray(ray);
  rtcOccluded1(scene_, &context, &query);
  return query.tfar < 0;
}

}  // namespace

std::unique_ptr<RayScene> softreel_make_embree_scene(int threads) {
  return std::make_unique<EmbreeScene>(threads);
}

}  // namespace softreel
