/// How far motions on ever finer meshes are from the one they tend to, from the motions themselves.
///
/// Richardson's extrapolation (1911) by least squares over all meshes (Eca and Hoekstra 2014): u_i = u + C h_i^p for
/// the edge length h_i, vector by vector. Linear tetrahedra have p = 2 inside and p = 1 where pins hold whole
/// tetrahedra, whose edge moves with the mesh, and not evenly: errors of p = 1 scatter by a factor. No order can be
/// read from a few such meshes, so all between 1 and 2 count, each as far as the motions bear it out, and the lower
/// ones more from the start.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// The same points of a surface at the same frames: frames x points, m.
using SampledMotion = std::vector<std::vector<Vec3>>;

/// Root of the mean squared distance over the points, in the frame where it is largest, m. The motions are of equal
/// shape and not empty.
double motion_distance(const SampledMotion& a, const SampledMotion& b);

/// a + factor b, point by point.
SampledMotion plus(SampledMotion a, double factor, const SampledMotion& b);

/// motion_distance from nothing but zeros.
double motion_size(const SampledMotion& a);

class MeshErrors {
 public:
  /// Fewest meshes that errors can be told from: one more than the unknowns of an order.
  static constexpr std::size_t kFewest = 3;

  /// The motion on a mesh of `tets` tetrahedra, more than all before; all of equal shape.
  void add(double tets, SampledMotion motion);
  std::size_t count() const { return tets_.size(); }
  double tets(std::size_t i) const { return tets_[i]; }

  /// Must follow the last `add`, with kFewest meshes or more.
  void fit();
  /// m; of mesh i itself: its scatter is in it.
  double measured(std::size_t i) const { return measured_[i]; }
  /// m; of a mesh of so many tetrahedra by the curve.
  double expected(double tets) const;
  /// The same vector by vector: which way the surface is off, frames x points, m; about that long.
  SampledMotion expected_motion(double tets) const;
  /// Of how many tetrahedra the curve expects this error (m).
  double tets_for(double error) const;
  /// The mean of the orders that count.
  double order() const { return order_; }

 private:
  struct OrderFit {
    double slope = 0;               ///< |C|, m, at h = 1 for one tetrahedron
    std::vector<double> distances;  ///< of each mesh from the limit, m
    double scatter = 0;             ///< sum of squares of what is left over h^2
  };
  OrderFit fit_order(double order) const;
  /// The weights that make limit and slope of the motions' line over h^order.
  struct Line {
    std::vector<double> x, weights;    ///< per mesh: h^order; what its motion counts
    std::vector<double> limit, slope;  ///< as sums over the motions
  };
  Line line_of(double order) const;

  std::vector<double> tets_;
  std::vector<SampledMotion> motions_;
  std::vector<double> measured_;
  std::vector<double> orders_, shares_;  ///< that count, and how much
  double log_slope_ = 0, order_ = 0;
};

}  // namespace softreel
