/// Limited memory of a descent (L-BFGS): J. Nocedal, "Updating quasi-Newton matrices with limited storage", 1980.
#pragma once

#include <deque>
#include <functional>

#include <Eigen/Core>

namespace softreel::bench {

/// Turns steepest descent, preconditioned by a fixed matrix, into directions that know the last moves.
class DescentMemory {
 public:
  using Vectors = Eigen::MatrixX3d;
  using Precondition = std::function<Vectors(const Vectors&)>;

  /// length: moves that are remembered; 0: the direction is the preconditioned one.
  explicit DescentMemory(std::size_t length) : length_(length) {}

  void forget() { moves_.clear(); }
  /// move: from one place to the next; change: of the gradient on the way. Left out where it does not curve upwards.
  void remember(const Vectors& move, const Vectors& change);
  /// Minus the approximate inverse Hessian times the gradient, which is -descent.
  Vectors direction(const Vectors& descent, const Precondition& precondition) const;

 private:
  struct Move {
    Vectors move, change;
    double inverse_curvature = 0;
  };
  std::size_t length_;
  std::deque<Move> moves_;  ///< the last one at the back
};

}  // namespace softreel::bench
