/// Shapes, and the damage that is done to them: what broken_surfaces.h is made of. What is random is seeded.
#pragma once

#include <functional>

#include "core/mesh/surface_mesh.h"

namespace softreel::test {

SurfaceMesh ball(double radius = 1, const Vec3& center = Vec3::Zero());
SurfaceMesh block(const Vec3& half, const Vec3& center);

/// A wavy sheet of 1 x 1 m.
SurfaceMesh sheet();

/// A strip with half a turn, 0.6 m wide on a circle of 1 m.
SurfaceMesh moebius();

/// A tube of radius `radius` round the lemniscate (sin a, sin a cos a) in the plane y = 0, which crosses itself at
/// right angles in the origin.
SurfaceMesh crossed_tube(double radius);

/// Two cubes that share the wall between them.
SurfaceMesh walled();

/// Two pyramids that meet in one vertex.
SurfaceMesh hourglass();

SurfaceMesh with(SurfaceMesh mesh, const SurfaceMesh& other);
SurfaceMesh moved(SurfaceMesh mesh, double factor, const Vec3& shift);

/// Without the triangles for which `gone` holds of their centroids.
SurfaceMesh without(SurfaceMesh mesh, const std::function<bool(const Vec3&)>& gone);

/// Without one triangle in 20.
SurfaceMesh with_many_holes(SurfaceMesh mesh);

SurfaceMesh flipped(SurfaceMesh mesh);

/// With the triangles turned that lie at x > 0.
SurfaceMesh half_flipped(SurfaceMesh mesh);

/// With some triangles turned, one in `n`.
SurfaceMesh some_flipped(SurfaceMesh mesh, unsigned n);

/// With more triangles, made from one in four.
SurfaceMesh with_some(SurfaceMesh mesh, Triangle (*made_from)(const Triangle&));

/// Every triangle with corners of its own, each rounded by up to `noise`.
SurfaceMesh soup(const SurfaceMesh& mesh, double noise);

/// Every fourth triangle is cut in two at the middle of a side; its neighbour across the side is not.
SurfaceMesh with_t_junctions(SurfaceMesh mesh);

/// The same, with the gaps closed by triangles without area.
SurfaceMesh with_slivers(const SurfaceMesh& mesh);

}  // namespace softreel::test
