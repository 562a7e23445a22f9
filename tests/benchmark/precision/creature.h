/// The creature of the assets, pulled by its head, on meshes of any size.
#pragma once

#include <cstdint>

#include "core/mesh/surface_mesh.h"
#include "tests/benchmark/precision/motion.h"

namespace softreel::bench {

/// assets/creature.ply, one metre high, standing on y = 0. Throws Error if it cannot be read.
SurfaceMesh load_creature();

/// The creature of foam rubber with about `tets` tetrahedra: soles pinned, the top of its head pressed down and pulled
/// up by springs, as in presets/first_pull.toml, under a weak gravity; damped by mass alone.
BodyModel make_creature(const SurfaceMesh& surface, std::int64_t tets);

/// Its surface's vertices, in the order of the file, when the nodes of the model's mesh are at `positions`.
std::vector<Vec3> surface_of(const BodyModel& model, std::span<const Vec3> positions);

/// Motion in short steps and equilibrium, both led on from two fine meshes by first order, are the truth. Value:
/// how far the surface moves upward in the mean, m; error: root mean square distance of the surface's vertices, over
/// the height.
std::vector<ProblemResult> measure_creature(bool quick);

}  // namespace softreel::bench
