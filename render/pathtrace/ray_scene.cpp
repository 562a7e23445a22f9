#include "render/pathtrace/ray_scene.h"

#include <cstring>
#include <string>

#include "core/base/check.h"
#include "core/base/error.h"

#if SOFTREEL_WITH_EMBREE
#include <embree3/rtcore.h>
#include <fmt/format.h>
#endif

namespace softreel {

#if SOFTREEL_WITH_EMBREE

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

}  // namespace

struct RayScene::Parts {
  explicit Parts(int threads) : device(rtcNewDevice(device_config(threads).c_str())) {
    require_no_error(device, "starting");
    CHECK(device != nullptr);
  }
  ~Parts() {
    if (scene != nullptr) rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  void attach(const MotionMesh& mesh, unsigned id) const;

  RTCDevice device;
  RTCScene scene = nullptr;
};

void RayScene::Parts::attach(const MotionMesh& mesh, unsigned id) const {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
  rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(mesh.times.size()));
  for (std::size_t step = 0; step < mesh.times.size(); ++step)
    copy_positions(geometry, static_cast<unsigned>(step), mesh.times[step].positions);
  copy_triangles(geometry, mesh.triangles);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

RayScene::RayScene(int threads) : parts_(std::make_unique<Parts>(threads)) {}
RayScene::~RayScene() = default;

void RayScene::build(const Threads& threads, const std::vector<const MotionMesh*>& meshes) {
  if (parts_->scene != nullptr) rtcReleaseScene(parts_->scene);
  parts_->scene = rtcNewScene(parts_->device);
  rtcSetSceneBuildQuality(parts_->scene, RTC_BUILD_QUALITY_MEDIUM);
  for (std::size_t m = 0; m < meshes.size(); ++m) parts_->attach(*meshes[m], static_cast<unsigned>(m));
  require_no_error(parts_->device, "copying a mesh");
  threads.run([&] { rtcCommitScene(parts_->scene); });
  require_no_error(parts_->device, "building trees");
}

bool RayScene::intersect(const Ray& ray, RayHit& hit, bool coherent) const {
  RTCIntersectContext context = context_of(coherent);
  RTCRayHit query;
  query.ray = embree_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(parts_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit.distance = query.ray.tfar;
  hit.u = query.hit.u;
  hit.v = query.hit.v;
  hit.mesh = static_cast<Index>(query.hit.geomID);
  hit.triangle = static_cast<Index>(query.hit.primID);
  return true;
}

bool RayScene::occluded(const Ray& ray, bool coherent) const {
  RTCIntersectContext context = context_of(coherent);
  RTCRay query = embree_ray(ray);
  rtcOccluded1(parts_->scene, &context, &query);
  return query.tfar < 0;
}

#else

struct RayScene::Parts {};

RayScene::RayScene(int) {
  throw input_error(
      "This build of softreel has no path tracer: it was configured with SOFTREEL_WITH_EMBREE=OFF or without Embree "
      "3.\n"
      "  Accepted: a build with SOFTREEL_WITH_EMBREE=ON. Install libembree-dev and configure again, or use the "
      "preview.");
}
RayScene::~RayScene() = default;
void RayScene::build(const Threads&, const std::vector<const MotionMesh*>&) {}
bool RayScene::intersect(const Ray&, RayHit&, bool) const {
  return false;
}
bool RayScene::occluded(const Ray&, bool) const {
  return false;
}

#endif

}  // namespace softreel
