/// The only place, with rays_embree.h, that knows Embree.
#include <algorithm>
#include <cstring>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "render/pathtrace/rays/ray_scene.h"
#include "render/pathtrace/rays/rays_embree.h"
#include "render/pathtrace/rays/tree_fit.h"

namespace softreel {
namespace {

/// One instruction set on all machines: the same trees and the same intersections, bit for bit. Leaves of moving
/// triangles hold their corners, where Embree's own choice of indices makes rays that scattered slower by a third.
std::string device_config(int threads) {
  return fmt::format("isa=avx2,threads={},tri_accel_mb=bvh8.triangle4vmb", threads);
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

/// Meshes one after another, as one: of it Embree refits a tree. Of several geometries it would build the top of the
/// tree in the order in which its threads come to them, so that equal distances might be told apart differently.
struct JoinedMesh {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<Index> first_triangles;  ///< per mesh
};

/// The shape that trees are made of: at rest, where the mesh knows it.
const std::vector<Vec3f>& tree_positions(const MotionMesh& mesh) {
  return mesh.rest_positions ? *mesh.rest_positions : mesh.times.front().positions;
}

JoinedMesh joined_at_rest(const std::vector<const MotionMesh*>& meshes) {
  JoinedMesh joined;
  for (const MotionMesh* mesh : meshes) {
    const std::vector<Vec3f>& positions = tree_positions(*mesh);
    const auto first = static_cast<Index>(joined.positions.size());
    joined.first_triangles.push_back(static_cast<Index>(joined.triangles.size()));
    joined.positions.insert(joined.positions.end(), positions.begin(), positions.end());
    for (const Triangle& t : mesh->triangles) joined.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return joined;
}

/// Whether trees of the shapes at rest can stand for these meshes. Embree 3 refits no tree of geometry that moves while
/// the shutter is open: it builds it anew whatever is asked for.
bool can_fit(const std::vector<const MotionMesh*>& meshes) {
  const auto is_still = [](const MotionMesh* mesh) { return mesh->times.size() == 1; };
  const auto knows_rest = [](const MotionMesh* mesh) { return mesh->rest_positions != nullptr; };
  return std::all_of(meshes.begin(), meshes.end(), is_still) && std::any_of(meshes.begin(), meshes.end(), knows_rest);
}

/// One tree that is built from a shape and fitted to others of the same triangles.
class FittedTree {
 public:
  FittedTree(RTCDevice device, const JoinedMesh& mesh)
      : device_(device), scene_(rtcNewScene(device)), geometry_(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);  // the one that lets a geometry choose
    rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
    copy_positions(geometry_, 0, mesh.positions);
    copy_triangles(geometry_, mesh.triangles);
    rtcCommitGeometry(geometry_);
    rtcAttachGeometryByID(scene_, geometry_, 0);
    require_no_error(device_, "copying a mesh");
    rtcCommitScene(scene_);
    require_no_error(device_, "building a tree of the shape at rest");
  }
  ~FittedTree() {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
  }
  FittedTree(const FittedTree&) = delete;
  FittedTree& operator=(const FittedTree&) = delete;

  RTCScene scene() const { return scene_; }

  /// To the meshes' positions, one mesh after another.
  void fit(const std::vector<const MotionMesh*>& meshes) {
    auto* to = static_cast<Vec3f*>(rtcGetGeometryBufferData(geometry_, RTC_BUFFER_TYPE_VERTEX, 0));
    for (const MotionMesh* mesh : meshes) {
      const std::vector<Vec3f>& positions = mesh->times.front().positions;
      to = std::copy(positions.begin(), positions.end(), to);
    }
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
    require_no_error(device_, "fitting a tree");
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
  RTCGeometry geometry_;
};

/// Trees of the shapes at rest, for all frames that fit them.
class RestTrees {
 public:
  RestTrees(RTCDevice device, const std::vector<const MotionMesh*>& meshes)
      : RestTrees(device, meshes, joined_at_rest(meshes)) {}

  /// Whether trees made of these meshes would be the same.
  bool are_of(const std::vector<const MotionMesh*>& meshes) const {
    return std::equal(meshes.begin(), meshes.end(), sources_.begin(), sources_.end(),
                      [](const MotionMesh* mesh, const Source& source) { return source.is(*mesh); });
  }
  bool suit(const std::vector<const MotionMesh*>& meshes, double paths) {
    moved_.clear();
    for (const MotionMesh* mesh : meshes)
      if (mesh->rest_positions)
        moved_.insert(moved_.end(), mesh->times.front().positions.begin(), mesh->times.front().positions.end());
    return is_worth_fitting(fit_->looseness(moved_), triangles_, paths);
  }
  void fit(const std::vector<const MotionMesh*>& meshes) {
    all_.fit(meshes);
    for (std::size_t m = 0; m < meshes.size(); ++m)
      if (bodies_[m]) bodies_[m]->fit({meshes[m]});
  }

  RTCScene scene() const { return all_.scene(); }
  /// Of a mesh alone; null where light does not scatter inside.
  RTCScene body(std::size_t mesh) const { return bodies_[mesh] ? bodies_[mesh]->scene() : nullptr; }
  /// What the ray met, from its place in all meshes.
  void find_triangle(unsigned joined_triangle, RayHit& hit) const {
    const auto triangle = static_cast<Index>(joined_triangle);
    // The last mesh that begins there or before: those of no triangles begin where the next one does.
    const auto first = std::upper_bound(first_triangles_.begin(), first_triangles_.end(), triangle) - 1;
    hit.mesh = static_cast<Index>(first - first_triangles_.begin());
    hit.triangle = triangle - *first;
  }

 private:
  struct Source {
    std::shared_ptr<const std::vector<Vec3f>> rest;  ///< held, so that its address is nobody else's
    std::vector<Vec3f> positions;                    ///< of a mesh that knows no rest
    std::vector<Triangle> triangles;
    bool scatters = false;

    bool is(const MotionMesh& mesh) const {
      return mesh.rest_positions == rest && (rest || mesh.times.front().positions == positions) &&
             mesh.triangles == triangles && (mesh.appearance.subsurface > 0) == scatters;
    }
  };

  RestTrees(RTCDevice device, const std::vector<const MotionMesh*>& meshes, JoinedMesh&& joined)
      : first_triangles_(std::move(joined.first_triangles)), triangles_(joined.triangles.size()), all_(device, joined) {
    std::vector<const MotionMesh*> deformable;
    for (const MotionMesh* mesh : meshes) {
      const bool scatters = mesh->appearance.subsurface > 0;
      bodies_.push_back(scatters ? std::make_unique<FittedTree>(device, joined_at_rest({mesh})) : nullptr);
      sources_.push_back({mesh->rest_positions, mesh->rest_positions ? std::vector<Vec3f>{} : tree_positions(*mesh),
                          mesh->triangles, scatters});
      if (mesh->rest_positions) deformable.push_back(mesh);
    }
    const JoinedMesh at_rest = joined_at_rest(deformable);
    fit_.emplace(at_rest.positions, at_rest.triangles);
  }

  std::vector<Index> first_triangles_;  ///< per mesh
  std::size_t triangles_;
  FittedTree all_;
  std::vector<std::unique_ptr<FittedTree>> bodies_;  ///< per mesh, of it alone
  std::vector<Source> sources_;
  std::optional<TreeFit> fit_;  ///< of what knows its rest
  std::vector<Vec3f> moved_;    ///< its positions, kept for their memory
};

class EmbreeScene : public RayScene {
 public:
  explicit EmbreeScene(int threads) : device_(rtcNewDevice(device_config(threads).c_str())) {
    require_no_error(device_, "starting");
    CHECK(device_ != nullptr);
  }
  ~EmbreeScene() override {
    release_scenes();
    rest_trees_.reset();
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  void build(const std::vector<const MotionMesh*>& meshes, double paths) override;
  bool intersect(const Ray& ray, RayHit& hit) const override;
  bool intersect_body(Index mesh, const Ray& ray, RayHit& hit, bool& front) const override;
  bool occluded(const Ray& ray) const override;
  void intersect_packet(std::span<const Ray> rays, std::span<RayHit> hits) const override;

 private:
  /// The triangle's mesh and number, of Embree's.
  void name_triangle(unsigned geometry, unsigned primitive, RayHit& hit) const;
  bool fit_rest_trees(const std::vector<const MotionMesh*>& meshes, double paths);
  void build_own_trees(const std::vector<const MotionMesh*>& meshes);
  void attach(const MotionMesh& mesh, unsigned id);
  RTCScene new_scene() const;
  void release_scenes();

  RTCDevice device_;
  std::unique_ptr<RestTrees> rest_trees_;
  const RestTrees* fitted_ = nullptr;  ///< rest_trees_, if rays are shot at them; null: at scene_
  RTCScene scene_ = nullptr;           ///< with a reference of its own, as those of bodies_
  std::vector<RTCScene> bodies_;       ///< per mesh, of it alone; null where light does not scatter inside
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
  fitted_ = nullptr;
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

void EmbreeScene::build(const std::vector<const MotionMesh*>& meshes, double paths) {
  release_scenes();
  if (!can_fit(meshes) || !fit_rest_trees(meshes, paths)) build_own_trees(meshes);
}

/// False if the frame is too far from rest.
bool EmbreeScene::fit_rest_trees(const std::vector<const MotionMesh*>& meshes, double paths) {
  if (!rest_trees_ || !rest_trees_->are_of(meshes)) {
    rest_trees_.reset();
    rest_trees_ = std::make_unique<RestTrees>(device_, meshes);
  }
  if (!rest_trees_->suit(meshes, paths)) return false;
  rest_trees_->fit(meshes);
  fitted_ = rest_trees_.get();
  const auto hold = [](RTCScene scene) {
    if (scene != nullptr) rtcRetainScene(scene);
    return scene;
  };
  scene_ = hold(fitted_->scene());
  for (std::size_t m = 0; m < meshes.size(); ++m) bodies_.push_back(hold(fitted_->body(m)));
  return true;
}

void EmbreeScene::build_own_trees(const std::vector<const MotionMesh*>& meshes) {
  scene_ = new_scene();
  bodies_.assign(meshes.size(), nullptr);
  for (std::size_t m = 0; m < meshes.size(); ++m) attach(*meshes[m], static_cast<unsigned>(m));
  require_no_error(device_, "copying a mesh");
  rtcCommitScene(scene_);
  for (const RTCScene body : bodies_)
    if (body != nullptr) rtcCommitScene(body);
  require_no_error(device_, "building trees");
}

void EmbreeScene::name_triangle(unsigned geometry, unsigned primitive, RayHit& hit) const {
  if (fitted_ != nullptr) {
    fitted_->find_triangle(primitive, hit);
  } else {
    hit.mesh = static_cast<Index>(geometry);
    hit.triangle = static_cast<Index>(primitive);
  }
}

bool EmbreeScene::intersect(const Ray& ray, RayHit& hit) const {
  RTCIntersectContext context = new_context();
  RTCRayHit query;
  set_ray(ray, query.ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit.distance = query.ray.tfar;
  hit.u = query.hit.u;
  hit.v = query.hit.v;
  name_triangle(query.hit.geomID, query.hit.primID, hit);
  return true;
}

bool EmbreeScene::intersect_body(Index mesh, const Ray& ray, RayHit& hit, bool& front) const {
  RTCIntersectContext context = new_context();
  RTCRayHit query;
  set_ray(ray, query.ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(bodies_[static_cast<std::size_t>(mesh)], &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = {query.ray.tfar, query.hit.u, query.hit.v, mesh, static_cast<Index>(query.hit.primID)};
  front = Vec3f(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).dot(ray.direction) < 0;
  return true;
}

bool EmbreeScene::occluded(const Ray& ray) const {
  RTCIntersectContext context = new_context();
  RTCRay query;
  set_ray(ray, query);
  rtcOccluded1(scene_, &context, &query);
  return query.tfar < 0;
}

void EmbreeScene::intersect_packet(std::span<const Ray> rays, std::span<RayHit> hits) const {
  RTCIntersectContext context = new_context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  const Lanes lanes(rays.size());
  RTCRayHit8 query;
  set_rays(rays, query.ray);
  std::fill_n(query.hit.geomID, kRayPacket, RTC_INVALID_GEOMETRY_ID);
  rtcIntersect8(lanes.valid.data(), scene_, &context, &query);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    hits[k] = {};
    if (query.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
    hits[k] = {query.ray.tfar[k], query.hit.u[k], query.hit.v[k], -1, -1};
    name_triangle(query.hit.geomID[k], query.hit.primID[k], hits[k]);
  }
}

}  // namespace

std::unique_ptr<RayScene> softreel_make_embree_scene(int threads) {
  return std::make_unique<EmbreeScene>(threads);
}

}  // namespace softreel
