/// Tunnels of closed surfaces, by which a perforated wall is told from a whole one.
#pragma once

#include <optional>
#include <span>

#include "core/base/types.h"

namespace softreel {

/// Handles of all pieces of a surface together (none of a sphere, one of a torus), by Euler's formula, vertices - edges
/// + triangles = 2 (pieces - handles), where triangles that do not meet in edges are apart. Nothing where an edge has
/// other than two triangles; their windings do not matter. Cost: a sort of the edges. triangles: welded, collapsed ones
/// count as not there.
std::optional<Index> count_tunnels(std::span<const Triangle> triangles);

/// The same of a closed manifold (each edge has two triangles, each vertex one fan), without a sort.
Index count_manifold_tunnels(std::span<const Triangle> triangles);

}  // namespace softreel
