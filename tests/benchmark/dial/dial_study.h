/// One shot whose error dial is turned to several errors, and the truth to compare them with.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/dynamics/error_dial.h"

namespace softreel::bench {

/// A shot of tests/benchmark/dial, NAME.toml.
struct DialProblem {
  std::string name;
  std::string title;           ///< one sentence
  int across = 0;              ///< a bar: the truth is that of bars cut into so many cubes across, and half as many
  std::int64_t fine_tets = 0;  ///< else: of a mesh of so many tetrahedra, and of an eighth of them
  std::int64_t most_tets = 0;  ///< that the dial may choose
  std::vector<double> errors;  ///< wanted, from the largest
};

/// One turn of the dial.
struct DialTurn {
  double asked = 0;  ///< over the diagonal of the body's box, as all errors here
  DialChoice choice;
  double truth = 0;          ///< distance of the chosen run from the truth
  double seconds = 0;        ///< processor time of the chosen run
  double pilot_seconds = 0;  ///< of the pilots
  double ratio() const { return choice.believed.total() / truth; }
};

/// Whether the belief is within a factor of two of what is true.
enum class Honesty {
  Within,    ///< wherever within its doubt the truth is
  Outside,   ///< wherever it is
  Undecided  ///< the truth is not known well enough to say
};
/// doubt: of the truth, over the diagonal.
Honesty judge(const DialTurn& turn, double doubt);
const char* name_of(Honesty honesty);

/// Order in the edge length by which the truth of a bar is led on. Bending and clamped edges would have more, but the
/// pins are a shell of the surface one tetrahedron thick, within which the bar is free: of first order. Measured of the
/// dropped bar from 8, 12 and 16 cubes across 1.21, from 12, 16 and 24 1.24, from 12, 24 and 32 1.14.
inline constexpr double kBarOrder = 1.2;

struct DialStudy {
  std::vector<DialTurn> turns;
  double truth_doubt = 0;  ///< how far the truth is from the finest motion that it was extrapolated from
};

/// Turns the dial on each error and finds the truth, which is led on from two meshes, one with edges half as long as
/// the other's (Richardson): a bar's are cut where its pins end (plane_bar.h), so that their errors are smooth and of
/// order 1.2; another body's are softreel's own, of first order. Steps are an eighth of a frame, corrected by what
/// steps of a 32nd change on a coarse mesh. Throws Error if the shot cannot be read, std::runtime_error if a run fails.
DialStudy study_dial(const DialProblem& problem);

}  // namespace softreel::bench
