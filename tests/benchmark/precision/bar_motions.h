/// Bars in motion: free vibration, a drop that the pins catch, and settling to the static tip.
#pragma once

#include "tests/benchmark/precision/bar_models.h"
#include "tests/benchmark/precision/motion.h"

namespace softreel::bench {

/// A cantilever 10 times as long as wide, undamped, whose weight (1e-4 of the usual) is switched on at rest: it swings
/// about its static shape in its first mode. Value: its frequency in Hz, from the first and the third zero of the
/// mode's velocity, one period apart, however many there are; error: against Timoshenko's, so that of the mesh is in
/// it.
MotionProblem vibration_problem(Index across);

/// The bar of the performance targets under its weight. Its clamped end falls with it from rest, is slowed down and
/// stops after 10 frames, 0.28 m lower; the bar swings on until frame 14. Damping by 0.1 / s of mass alone, which every
/// rival has too. Steps: halved_frames(halvings). Value: the tip's y displacement at the end; error: root mean square
/// distance of all nodes at 4 times from the same mesh's motion by iterated Newmark in steps a quarter of the shortest,
/// over the length.
MotionProblem drop_problem(Index across, int halvings);

/// The bar of the performance targets under its weight, damped by 16 / s of mass: at 2 s it hangs still. Value: the
/// tip's y displacement; error: against the equilibrium of the same mesh.
MotionProblem settling_problem(Index across);

}  // namespace softreel::bench
