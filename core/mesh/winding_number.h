/// Generalised winding numbers: how often a surface, open or dirty as it may be, goes round a point.
///
/// Barill, Dickson, Schmidt, Levin, Jacobson, Fast Winding Numbers for Soups and Clouds, 2018: far clusters of
/// triangles act as dipoles, near ones by their exact solid angles (van Oosterom and Strackee 1983).
#pragma once

#include <vector>

#include "core/base/types.h"
#include "core/mesh/triangle_clusters.h"

namespace softreel {

class WindingNumber {
 public:
  WindingNumber(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

  /// 1 inside a closed surface seen counter-clockwise from outside, 0 outside, -1 inside one that is inside out. Error
  /// about 0.01. Thread-safe; cost: logarithmic in the number of triangles.
  double operator()(const Vec3& p) const;

  /// The same but for round-off, and as far from 0 or not as 1/2 is; several times as quick where clusters are near, as
  /// those of a few large triangles always are.
  double quick(const Vec3& p) const;

 private:
  /// Dipole of a cluster, a node of the tree: area-weighted normal at the area-weighted centroid, valid outside
  /// `radius`.
  struct Dipole {
    Vec3 center, area;
    double squared_reach;     // (accuracy times radius) squared
    Index begin, end, right;  // as in the node
  };

  /// Calls add_near(dipole) for the leaves near a point; returns the sum of the solid angles of what is far.
  template <typename AddNear>
  double visit(const Vec3& p, const AddNear& add_near) const;

  TriangleClusters clusters_;  // its triangles; the dipoles have its nodes
  std::vector<Dipole> dipoles_;
};

/// Whether every edge is used as often in one direction as in the other. Then winding numbers are integers, and they
/// change nowhere but at the surface: it is closed.
bool has_integer_windings(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

}  // namespace softreel
