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

// The rivals hold the same nodes as softreel (core's NodePins), lump the same masses, and know gravity, pulls and the
// mass part of Rayleigh damping by the same formulas. They run on one thread, have no recovery and start at rest. A
// pull with max_force, or pins that contradict each other, make `step` or the maker throw std::runtime_error. All of
// them are steps of implicit Euler, and lose the energy that it loses.

/// How the linear system of softreel's step is solved by a rival: the same equations, other algebra.
enum class DirectSolver { EigenLdlt, Cholmod, EigenCgIncompleteCholesky, EigenCgDiagonal };
/// Where its conjugate gradients start: as softreel's solver does, or from the step's first velocity.
enum class FirstGuess { Extrapolated, None };

class DirectStepper : public Stepper {
 public:
  virtual long iterations() const = 0;  ///< of all steps so far; 0 for factorizations
};

/// Implicit Euler with one linearisation at the step's start, whose system is assembled by softreel and solved anew
/// each step. Null where the library is missing.
///
/// Takes rotation, dilatation and, for conjugate gradients, `tolerance` from params; throws std::runtime_error for
/// another integrator or linearisation. Full Rayleigh damping, pulls with max_force too. Tuned as users would: the
/// pinned nodes are taken out, the order of elimination (AMD; CHOLMOD: its own choice) is found once and kept while the
/// same nodes are held, values are copied in place; conjugate gradients start from those multiples of the last step's
/// acceleration and of its last change that are nearest to the answer in the energy norm, which softreel's solver
/// searches first too. CHOLMOD is supernodal, with the BLAS that the system links it to; that BLAS is told to use one
/// thread, but CHOLMOD's own OpenMP loops are not: measure process_seconds().
std::unique_ptr<DirectStepper> make_direct(BodyModel model, const SolverParams& params, DirectSolver solver,
                                           FirstGuess guess = FirstGuess::Extrapolated);

/// Extended position-based dynamics on tetrahedra (Macklin, Mueller, Chentanez 2016): the corotated linear energy's two
/// constraints a tetrahedron, with compliance, in small steps (Macklin et al. 2019).
///
/// The material is that of Dilatation::Linear at any strain, so it converges to softreel's own answers, of second order
/// in statics and of first in motion, as the substep goes to zero. It does so by substeps only: repeated within a
/// substep the sweeps do not end at implicit Euler's step, for the direction of |F - R| turns under the multiplier (of
/// a bar's static tip 2.8 % is left at h = 1/48 s after any number of iterations). Hence, as the 2019 paper advises,
/// tuned by spending all on substeps: 1 iteration, and 10 to 50 substeps a frame for bodies of 1e5 Pa. Gauss-Seidel
/// nearly in the order of the elements, in groups of 16 without a common node, whose rotations core's vector kernel
/// finds at once from the last ones; both constraints are solved together (Macklin and Mueller 2021).
/// Damping: the mass part exactly; damping_stiffness by eq. (26) of 2016, along the constraints only, which is less
/// than Rayleigh's and, with one iteration, slows the way to statics: compare motion with damping_stiffness = 0.
struct XpbdParams {
  int substeps = 1;    ///< of a step, 1 or more; pins move linearly through them
  int iterations = 1;  ///< of a substep, 1 or more
};
std::unique_ptr<Stepper> make_xpbd(BodyModel model, const XpbdParams& params);

/// Projective dynamics (Bouaziz et al. 2014): local polar projections, one prefactored global matrix.
///
/// Strain is projected on the rotation, with weight 2 mu V, volume on tr(R^T F) = 3, which is det F = 1 to first order,
/// with 3 lambda V: together exactly the material of Dilatation::Linear, so that the iteration converges to softreel's
/// iterated step of implicit Euler, Rayleigh damping included. Tuned as users would: starts from inertia alone, one
/// scalar matrix for x, y and z, factored by CHOLMOD where it is there, else by Eigen's LDLT, and again only if the
/// held nodes, a pull's stiffness or the step change; 10 iterations are usual. Rotations by core's vector kernel.
///
/// With `memory` its iterations are the descent with limited memory and line search that T. Liu, S. Bouaziz and
/// L. Kavan made of them (2017; they remember 5), which needs many fewer where nu is high.
struct ProjectiveParams {
  int iterations = 10;  ///< of local and global steps, 1 or more
  int memory = 0;       ///< moves that the next one knows of
};
std::unique_ptr<Stepper> make_projective_dynamics(BodyModel model, const ProjectiveParams& params);

}  // namespace softreel::bench
