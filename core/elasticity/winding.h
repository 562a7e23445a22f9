/// Rings of tetrahedra that are wound twice round an edge: tangles without an inverted element.
///
/// About an interior edge the signed dihedral angles of its tetrahedra add up to whole turns, one at rest. That number
/// only changes where a tetrahedron inverts; two or more are a true minimum of the energy, which no choice of one
/// rotation per element leaves (design 4.4). A tangle about a vertex, its sphere of tetrahedra covered twice, has such
/// an edge: a twofold cover of a sphere branches somewhere.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/types.h"
#include "core/elasticity/elastic_body.h"

namespace softreel {

/// Sum of the signed dihedral angles at the edge between the nodes a and b of all tetrahedra that have it, in turns;
/// negative for an inverted tetrahedron. 0 for an edge without length.
double edge_turns(const ElasticBody& body, Index a, Index b, std::span<const Vec3> positions);

/// Elements of the interior edges of the `suspects` about which `positions` wind more often than the rest shape.
/// Ascending, each once. Some 100 ns for each edge of a suspect.
std::vector<Index> find_wound_elements(const ElasticBody& body, std::span<const Vec3> positions,
                                       std::span<const Index> suspects);

}  // namespace softreel
