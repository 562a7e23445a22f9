/// What a linear or nonlinear solve did: a value, not an exception; only a stage turns it into a stop.
#pragma once

namespace softreel {

enum class SolveStatus {
  Converged,      ///< the tolerance was met
  RoundOff,       ///< no further progress is possible in double precision: the answer is as exact as it gets
  MaxIterations,  ///< the iteration limit was met first
  Breakdown       ///< not a number, or no descent
};

struct SolveReport {
  SolveStatus status = SolveStatus::Converged;
  int iterations = 0;
  double residual = 0;        ///< relative: |r| over |b|
  bool double_cycle = false;  ///< the float cycle stagnated and was rebuilt in double

  bool ok() const { return status == SolveStatus::Converged || status == SolveStatus::RoundOff; }
};

}  // namespace softreel
