/// Which leaves of an octree are halved where the boundary and the surface are apart, and how many tetrahedra that
/// adds.
#pragma once

#include <vector>

#include "core/tetmesh/boundary/boundary_fit.h"
#include "core/tetmesh/graded/graded_octree.h"
#include "core/tetmesh/surface/signed_distance.h"

namespace softreel {

/// Distance between the two ends of a gap, m.
double width_of(const BoundaryGap& gap);

/// The largest of them; 0 if there is none.
double widest(const std::vector<BoundaryGap>& gaps);

/// The largest of those at which leaves may be halved; nodes: of the boundary that has the gaps.
double widest_reachable(const GradedOctree& octree, const std::vector<BoundaryGap>& gaps,
                        const std::vector<Vec3>& nodes);

/// Halves the largest leaves at each gap, and those within `margin` of their width. False if there is none that may be
/// halved.
bool refine_gaps(GradedOctree& octree, const std::vector<BoundaryGap>& gaps, const std::vector<Vec3>& nodes,
                 double margin);

/// What refining the widest gaps did.
struct WidestRefined {
  std::size_t halved = 0;  ///< leaves
  double added_tets = 0;   ///< expected
  double narrowest = 0;    ///< the last gap at which a leaf was halved, m
};

/// What refine_widest is to do.
struct WidestWanted {
  double most_added = 0;      ///< tetrahedra, about
  double twice_from = 1e300;  ///< leaves at gaps wider than this are halved twice at once, m
};

/// The same without a margin, the widest gaps first, until as many tetrahedra as wanted are expected to come of it.
/// known: distances of the octree's nodes as it stands; gaps: in descending order of width. At least one leaf is halved
/// if one may be.
WidestRefined refine_widest(GradedOctree& octree, const std::vector<BoundaryGap>& gaps, const std::vector<Vec3>& nodes,
                            const SurfaceDistance& known, const WidestWanted& wanted);

}  // namespace softreel
