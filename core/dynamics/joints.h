/// Where glue joins the bodies of one model: what its bonds add to pieces and to the pattern of the matrix.
#pragma once

#include <span>
#include <vector>

#include "core/base/types.h"
#include "core/constraints/glue.h"
#include "core/dynamics/pieces.h"
#include "core/sparse/block_matrix.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Two elements that a bond joins, of different bodies.
struct Joint {
  Index element = 0, other = 0;
  friend auto operator<=>(const Joint&, const Joint&) = default;
};

/// Of all bonds, sorted, each once.
std::vector<Joint> find_joints(const std::vector<Glue>& glues, const std::vector<GlueBond>& bonds);

/// The bonds of one glue; bonds: ascending by glue.
std::span<const GlueBond> bonds_of(const std::vector<GlueBond>& bonds, std::int64_t glue);

/// Those of them that still hold at `frame`: glue that has come to another of its ranges binds anew.
std::span<const GlueBond> bonds_that_hold(const std::vector<GlueBond>& bonds, const Glue& glue, std::int64_t number,
                                          double frame);

/// Pieces that joints connect become one; numbered as those of find_pieces. Every node belongs to a piece.
Pieces join_pieces(const Pieces& pieces, const std::vector<Tet>& tets, const std::vector<Joint>& joints);

/// The pattern with a block for each node of a joint's element and each of its other one.
BlockPattern join_pattern(const BlockPattern& pattern, const std::vector<Tet>& tets, const std::vector<Joint>& joints);

}  // namespace softreel
