/// The material at a point of a surface that textures, vertex colours or heat vary.
#pragma once

#include <array>
#include <vector>

#include "render/pathtrace/materials/albedo_cache.h"
#include "render/pathtrace/materials/bsdf.h"
#include "render/pathtrace/materials/texture_lookup.h"
#include "render/pathtrace/rays/surface_point.h"

namespace softreel {

/// A mesh with a coloring, made ready for hits. Borrows the mesh. Thread-safe.
class ColoredSurface {
 public:
  /// least_roughness: of what is seen by way of a wide scattering. tables: copied from.
  ColoredSurface(const MotionMesh& mesh, float least_roughness, AlbedoCache& tables);

  /// The material where `ray` hit; point.shading_normal is turned as normal and bump maps say. width: diameter of the
  /// ray's cone there, m; blurred: seen by way of a wide scattering.
  Bsdf at(const RayHit& hit, const Ray& ray, float width, bool blurred, SurfacePoint& point) const;

 private:
  void prepare_tables(AlbedoCache& cache);
  void prepare_tangents();
  void join_tangent_corners();
  std::vector<Vec3f> tangents_of(const MotionMesh::Time& time) const;
  std::array<Vec2f, 3> coordinates_of(const Triangle& corners) const;
  void color(const RayHit& hit, Appearance& appearance) const;
  void bend(const RayHit& hit, const Ray& ray, const TextureGradients& gradients, const TextureFootprint& footprint,
            SurfacePoint& point) const;
  Vec3f mapped_normal(const RayHit& hit, const Ray& ray, bool mirrored, const Vec3f& texel, const Vec3f& outward) const;
  Bsdf material(const Appearance& appearance, bool textured, bool blurred) const;

  const MotionMesh& mesh_;
  float least_roughness_;
  std::vector<Vec2f> coordinates_;            ///< places in the pictures
  AlbedoTables plain_, plain_blurred_;        ///< of the appearance's own roughness
  std::vector<AlbedoTables> tables_;          ///< at first_roughness_ + k roughness_step_
  std::vector<AlbedoTables> blurred_tables_;  ///< the same under a blurred coat; empty where that is no other
  float first_roughness_ = 0, roughness_step_ = 1;
  /// Per triangle corner: which tangent is its. Corners with one normal and equal texture coordinates share one.
  std::vector<Triangle> tangent_corners_;
  std::size_t tangent_count_ = 0;
  /// Per time, at 2 tangent + (0 or 1: whether the texture is mirrored there): the direction in which u grows, unit, in
  /// the tangent plane of the vertex; averaged over triangles, so that it is smooth but for seams and hard
  /// edges.
  std::vector<std::vector<Vec3f>> tangents_;
};

/// `normal`, or as much of the way to it from `shading` as keeps a viewer's side and a mirrored view above the surface
/// (as Keller et al., The Iray Light Transport Simulation and Rendering System, 2017, bend it). All unit; shading and
/// geometric towards the viewer.
Vec3f valid_normal(const Vec3f& normal, const Vec3f& shading, const Vec3f& geometric, const Vec3f& to_viewer);

}  // namespace softreel
