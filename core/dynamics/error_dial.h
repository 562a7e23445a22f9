/// The error dial: from a wanted error of the motion to mesh size, step and tolerance, by short runs on coarse meshes.
///
/// Two-level comparison (Richardson 1911; Roache 1994, the grid convergence index): where the error is C h^p, two runs
/// with h and h / r differ by (1 - r^-p) times the error of the first. p is fitted to three runs where there are three,
/// and kept within what linear tetrahedra under pins and the time steps can have.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// What a run is cut into.
struct Discretization {
  std::int64_t tets = 0;
  int substeps = 1;      ///< per frame
  double tolerance = 0;  ///< of the solver: SolverParams::tolerance or force_tolerance
};

/// The same points of a surface at the same frames: frames x points, m.
using Motion = std::vector<std::vector<Vec3>>;

/// Root of the mean squared distance over the points, in the frame where it is largest, m. The motions are of equal
/// shape and not empty.
double motion_distance(const Motion& a, const Motion& b);

/// What is wanted, and what is not for the dial to choose: 0 where it chooses.
struct DialRequest {
  double error = 0;     ///< wanted, over `size`
  double size = 1;      ///< of the body, m
  bool dynamic = true;  ///< false: no steps of time
  std::int64_t given_tets = 0;
  int given_substeps = 0;
  double given_tolerance = 0;
  std::int64_t most_tets = 1000000;
  int most_substeps = 1024;
};

/// Over the body's size.
struct ErrorParts {
  double mesh = 0, time = 0, algebra = 0;
  /// As if all pointed the same way: the parts are not known to cancel.
  double total() const { return mesh + time + algebra; }
};

struct DialChoice {
  Discretization chosen;
  ErrorParts believed;                    ///< of `chosen`
  double mesh_order = 0, step_order = 0;  ///< in the edge length and in the step; 0 where nothing was compared
  int pilots = 0;                         ///< runs that were compared
  bool reached = true;                    ///< the believed error is at most the wanted one, but for rounding
};

/// A short run; none if it could not be made so coarse (a part too thin for the mesh, a step that cannot be solved).
using PilotRun = std::function<std::optional<Motion>(const Discretization&)>;

/// Turns the dial. First the step is halved on the coarsest mesh until the rest of its error is a fifth of the wanted
/// one; then meshes of four times as many tetrahedra follow each other until one more would be as dear as the run
/// itself; last the tolerance is set to a share of a twentieth. None if no pilot could be run within the limits.
std::optional<DialChoice> turn_dial(const DialRequest& request, const PilotRun& run);

}  // namespace softreel
