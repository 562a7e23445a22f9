/// The error dial: from a wanted error of the motion to mesh size, step and tolerance, by short runs on coarse meshes.
///
/// The mesh's error comes from a ladder of meshes, each of twice as many tetrahedra (mesh_errors.h), the step's from
/// pairs of runs of which one has twice the steps (Richardson 1911; Roache 1994). Rungs are added until the run itself
/// is decided, so that a smaller error never takes fewer tetrahedra or steps: what a rung decides lies above all that
/// the rung before could have.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "core/dynamics/mesh_errors.h"

namespace softreel {

/// What a run is cut into.
struct Discretization {
  std::int64_t tets = 0;
  int substeps = 1;      ///< per frame
  double tolerance = 0;  ///< of the solver: SolverParams::tolerance or force_tolerance
};

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
  double loosest_tolerance = 1e-3;  ///< where it chooses
};

/// Over the body's size.
struct ErrorParts {
  double mesh = 0, time = 0, algebra = 0;
  /// By how much mesh and time are less together than their sum: coarse meshes are stiff and swing early, long steps
  /// late. Told from which way the pilots were off.
  double cancelled = 0;
  double total() const { return mesh + time - cancelled + algebra; }
};

/// Least wanted error for which these parts would do: each part may have its share of it only.
double attainable_error(const ErrorParts& parts);

struct DialChoice {
  Discretization chosen;
  ErrorParts believed;                    ///< of `chosen`
  double mesh_order = 0, step_order = 0;  ///< in the edge length and in the step; 0 where nothing was compared
  int pilots = 0;                         ///< runs that were compared
  std::int64_t finest_pilot = 0;          ///< tetrahedra
  /// What the pilots cost over what the run costs, both as tetrahedra times steps of a frame.
  double pilot_share = 0;
  bool reached = true;  ///< the believed error is at most the wanted one, but for rounding
};

/// A short run; none if it could not be made so coarse (a part too thin for the mesh, a step that cannot be solved).
using PilotRun = std::function<std::optional<SampledMotion>(const Discretization&)>;

/// Turns the dial. First steps are doubled on a coarse mesh until their error is a fifth of the wanted one; then the
/// ladder of meshes is climbed, in at most two steps a frame, until the mesh that is wanted is measured or at most
/// eight times as fine as the last rung; last the tolerance is tightened until it is a twentieth. So the ladder costs a
/// quarter to half of what as many steps of the run cost, and never less than its first four rungs: 22500 tetrahedra.
/// None if too few pilots could be run within the limits.
std::optional<DialChoice> turn_dial(const DialRequest& request, const PilotRun& run);

}  // namespace softreel
