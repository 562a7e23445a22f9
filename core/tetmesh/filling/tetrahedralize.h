/// From a surface to tetrahedra: sign and distance, lattice, cut, pieces, guarantees; one call for one body.
#pragma once

#include <string>
#include <vector>

#include "core/base/log.h"
#include "core/base/parallel.h"
#include "core/base/timer.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// How tetrahedra lie to the surface.
enum class TetMode {
  Conforming,  ///< their boundary follows it
  Embedded     ///< whole lattice tetrahedra that cover it, weighted by their fill (embedded_lattice.h)
};

/// How fine the tetrahedra are; exactly one of the sizes is set, the others are 0.
struct TetrahedralizeParams {
  double edge = 0;        ///< long edge of the lattice, m
  std::int64_t tets = 0;  ///< wanted number of tetrahedra, met within 5 %
  double error = 0;       ///< wanted two-way distance to the surface, m; always graded, see error_budget.h; no lattice
  bool graded = false;    ///< with edge or tets: that edge at the surface only, or so many where they serve it best
  double thickness = 0;   ///< of the open parts of the surface, m; 0: they count as closed where they nearly are
  TetMode mode = TetMode::Conforming;
  bool optimize = false;  ///< makes the worst angles better by moves and flips, see improvement/angle_improvement.h
};

/// Fills a closed surface with tetrahedra by isosurface stuffing of a BCC lattice (Labelle and Shewchuk 2007).
///
/// Dihedral angles lie within 10.2 and 164.8 degrees (graded sizes: 1.66 and 174.72); the boundary is a manifold; every
/// piece is connected through faces. `name` (the body's) stands in messages. Throws input_error if no volume can be
/// made, or if a part is too thin for the lattice; repairs are said in `log`, one line each. Stage times:
/// "tetrahedralize/...".
///
/// Embedded mode covers the surface instead: dihedral angles of 60 and 90 degrees; nothing is too thin for it; the mesh
/// has the fill of each element and the carrier of each vertex of `surface`; its boundary is a manifold but where limbs
/// that lie side by side in one lattice tetrahedron join. Not with an error.
TetMesh tetrahedralize(const SurfaceMesh& surface, const TetrahedralizeParams& params, const std::string& name,
                       const Threads& threads, const Log& log, StageTimes& times);

}  // namespace softreel
