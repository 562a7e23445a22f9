/// Ways to move a body through time, behind one interface: softreel's own schemes and what animators use today.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/dynamics/simulator.h"

namespace softreel::bench {

/// One body under its pins, pulls and gravity. Keeps what it precomputed.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// One step of `seconds`; constraints are those at `frame`, its end. Throws std::runtime_error, with the reason,
  /// where the method cannot go on (a factorization that fails, a number that is none).
  virtual void step(double frame, double seconds) = 0;
  virtual std::span<const Vec3> positions() const = 0;   ///< per node, m
  virtual std::span<const Vec3> velocities() const = 0;  ///< per node, m/s
};

/// softreel's simulator with these parameters.
std::unique_ptr<Stepper> make_softreel(BodyModel model, const SolverParams& params, const Threads& threads);

/// How the linear system of softreel's step is solved by a rival: the same equations, other algebra.
enum class DirectSolver { EigenLdlt, Cholmod, EigenCgIncompleteCholesky };
/// Implicit Euler with one linearisation at the step's start, whose system is assembled by softreel and solved anew
/// each step. Null where the library is missing.
std::unique_ptr<Stepper> make_direct(BodyModel model, const SolverParams& params, DirectSolver solver);

/// Extended position-based dynamics on tetrahedra (Macklin, Mueller, Chentanez 2016): the corotated linear energy's two
/// constraints a tetrahedron, with compliance, in small steps (Macklin et al. 2019).
struct XpbdParams {
  int substeps = 1;    ///< of a step
  int iterations = 1;  ///< of a substep
};
std::unique_ptr<Stepper> make_xpbd(BodyModel model, const XpbdParams& params);

/// Projective dynamics (Bouaziz et al. 2014): local polar projections, one prefactored global matrix.
struct ProjectiveParams {
  int iterations = 10;  ///< of local and global steps
};
std::unique_ptr<Stepper> make_projective_dynamics(BodyModel model, const ProjectiveParams& params);

}  // namespace softreel::bench
