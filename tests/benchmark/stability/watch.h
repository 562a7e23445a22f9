/// Steps a body and keeps what went wrong: failures, numbers that are none, energy from nowhere, lost momentum,
/// flutter.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "core/dynamics/simulator.h"

namespace softreel::bench {

/// What a run is judged by.
struct Verdict {
  int steps = 0;             ///< that were solved
  std::string failure;       ///< of the first step that was not, or the first number that was none; empty: it survived
  bool finite = true;        ///< every position, velocity and rotation, after every step
  int gains = 0;             ///< steps that gained more than kNoise of the energy before, without work of pins
  double worst_gain = 0;     ///< of energy in such a step, over the greatest energy of the steps before
  double linear_drift = 0;   ///< greatest, over the momentum that the body's greatest kinetic energy allows
  double angular_drift = 0;  ///< the same times half the body's diagonal
  bool survived() const { return failure.empty(); }
  bool unsolved() const { return finite && !survived(); }  ///< a step was refused, and the state is still one
};

/// True if no position, velocity or rotation has a number that is none.
bool is_finite(const SimulationState& state);

/// What rounding and the tolerance of an iteration may add to the energy.
inline constexpr double kNoise = 1e-6;

/// Elements that a state leaves wrong.
struct Leftovers {
  Index inverted = 0;  ///< det F < 0
  Index wound = 0;     ///< in rings wound twice round an edge
};

class Watch {
 public:
  /// Everything is kept by reference. Energy and momentum are looked at after every `stride`th step.
  Watch(Simulator& simulator, int stride = 1);

  /// What pins do at a step is work: its energy is not judged. Steps under recovery are not either if
  /// `judge_recovery` is false. Returns false once the run has failed.
  bool step(double frame, double seconds, bool pins_work = false, bool judge_recovery = true);

  /// Takes the present state as a new start for energy and momentum.
  void restart();

  const Verdict& verdict() const { return verdict_; }
  const StepReport& last() const { return last_; }
  /// Kinetic and elastic energy and that of pulls when energy was last looked at, J.
  double motion_energy() const { return motion_energy_; }

 private:
  struct Energies {
    double total = 0;  ///< J
    double scale = 0;  ///< J, without that of gravity, whose zero is anywhere
    StateMeasures measures;
  };
  Energies look(double frame) const;
  void judge(double frame, bool energy_counts);

  Simulator& simulator_;
  int stride_;
  double mass_ = 0, radius_ = 0;  ///< kg, m
  Verdict verdict_;
  StepReport last_;
  double energy_ = 0, motion_energy_ = 0, greatest_energy_ = 0, greatest_kinetic_ = 0;
  Vec3 linear_ = Vec3::Zero(), angular_ = Vec3::Zero();  ///< at the start
};

/// Greatest over the elements of the mean angle by which they turn in a step, in degrees, over `steps` steps from now
/// with the constraints of `frame`; 0 for a body at rest, which is not stepped. An element's turn is that of the
/// rotation nearest to its deformation gradient, found from positions, alike for all rotation methods.
double measure_flutter(Watch& watch, Simulator& simulator, double frame, double seconds, int steps);

Leftovers find_leftovers(const Simulator& simulator);

/// A Simulator with what it refers to.
struct Rig {
  Rig(BodyModel model, const SolverParams& params)
      : threads(1), simulator(std::move(model), params, threads, log, times) {}
  Threads threads;
  Log log;
  StageTimes times;
  Simulator simulator;
};

}  // namespace softreel::bench
