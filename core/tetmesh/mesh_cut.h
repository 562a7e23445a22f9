/// A crinkle cut: the whole elements on one side of a plane, as the faces that are seen of them.
#pragma once

#include <vector>

#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Elements whose centroid lies on the side that `normal` points away from are kept.
struct CutPlane {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitX();  ///< need not be unit
};

/// Whether an element is kept.
bool is_behind(const TetMesh& mesh, Index element, const CutPlane& plane);

/// A face of a kept element that no other kept element has.
struct CutFace {
  Triangle nodes;  ///< counter-clockwise seen from outside of what is kept
  Index element;
  bool outer;  ///< of the boundary of the whole mesh; else laid bare by the cut
};

struct MeshCut {
  std::vector<CutFace> faces;  ///< ordered by element and local face
  std::int64_t kept = 0;       ///< elements
};

/// Linear time. A plane beside the mesh keeps all or none of it.
MeshCut cut_mesh(const TetMesh& mesh, const CutPlane& plane);

}  // namespace softreel
