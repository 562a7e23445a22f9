/// The paper's own way to the rotation of eq. (3), the bare Newton iteration of sec. 3: kept to be compared with.
#pragma once

#include <optional>

#include "core/base/types.h"
#include "core/elasticity/element.h"
#include "core/elasticity/rotation_energy.h"

namespace softreel {

/// The state vector (q, lambda) of the iteration after eq. (8). As in RotationEnergy, q = (w, x, y, z) describes Q^T.
struct PaperState {
  Vec4 q;
  double multiplier = 0;
};

/// One iteration after eq. (8): the state less the inverse of the Hessian, eqs. (7) and (8), times the gradient, eqs.
/// (5) and (6). Nothing if the Hessian is singular to working precision or the result is not finite.
std::optional<PaperState> step_paper_newton(const RotationEnergy& energy, const PaperState& state) noexcept;

/// Most iterations of find_paper_rotation, and the change of q that ends them. The paper names neither. The iteration
/// is quadratic near the solution: after such a change it is there to round-off, three or four from the last time step.
inline constexpr int kPaperIterations = 20;
inline constexpr double kPaperTolerance = 1e-9;

/// Rotation Q by the paper's Newton on (q, lambda) from the previous step's rotation, without its value checked.
///
/// It ends at any stationary point of eq. (4), also at a maximum or saddle (find_element_rotation does not), and where
/// it has not converged its last state is taken. Beyond the paper: lambda starts as the one that belongs to the guess,
/// which needs no second array; q, whose length only eq. (6) holds at 1, is normalised at the end; and where
/// step_paper_newton gives nothing the guess is kept. So the result is a proper rotation for any input.
/// rest, deformed: 4 nodes, m, same order. guess: unit quaternion. Pure, thread-safe, allocates nothing.
Quaternion find_paper_rotation(const TetNodes& rest, const TetNodes& deformed, const Quaternion& guess) noexcept;

}  // namespace softreel
