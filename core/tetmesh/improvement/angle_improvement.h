/// Makes the worst dihedral angles of tetrahedra better, by moving nodes and by flips, and none worse.
#pragma once

#include <string>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// What is worked on, and for how long.
struct AngleImprovementParams {
  double min_dihedral = 25;   ///< degrees; elements whose angles are between the two are not worked on
  double max_dihedral = 140;  ///< degrees
  int passes = 8;             ///< over all elements that are worse, worst first; fewer if nothing changes any more
};

/// What was done.
struct AngleImprovement {
  TetQuality before, after;
  Index moved_nodes = 0, slid_nodes = 0;       ///< inside; on the boundary
  Index removed_edges = 0, removed_faces = 0;  ///< flips 3-2, 4-4, 5-6 ...; flips 2-3
};

/// Every change makes the worst of the elements that it touches better, and none makes an angle beyond those of the
/// mesh as it was: neither the smallest nor the largest angle of the mesh gets worse.
///
/// The boundary keeps its faces. Its nodes stay without a surface; with one they slide along it if neither the faces
/// round them get further from the surface nor the surface there from the faces (in samples). Nodes keep their numbers.
/// Number and order of the elements change. Serial but for the distances; equal bits at any number of threads. Cost: a
/// millisecond or less per element that is worse than the target, and the measuring. mesh: positive volumes; throws
/// input_error if it has fills, which belong to whole lattice cells. surface: may be null.
AngleImprovement improve_angles(TetMesh& mesh, const SurfaceMesh* surface, const AngleImprovementParams& params,
                                const Threads& threads);

/// "dihedral angles 12.3 to 153.0 degrees (first percentile 20.9) became ...; N nodes moved, M flips".
std::string describe(const AngleImprovement& improvement);

}  // namespace softreel
