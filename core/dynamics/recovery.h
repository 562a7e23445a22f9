/// Recovery: untangles a body whose elements stay inverted or wound twice round an edge (design 4.4).
///
/// No rotation chosen element by element leaves such a state, a true minimum of the energy. So elements in trouble for
/// some steps, with their neighbourhood, share one rotation per connected patch for a while: a patch with one rotation
/// is a linear body, which has no minimum but its rest shape. What is much stiffer joins only where the trouble lasts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/types.h"
#include "core/dynamics/pieces.h"
#include "core/elasticity/elastic_body.h"

namespace softreel {

/// When recovery acts, in steps and in rings of elements that share a node. The numbers are those of a prototype, whose
/// steps were of kPaceSeconds: shorter ones count as their share of one, as what lasts for some milliseconds is no
/// tangle.
inline constexpr double kPaceSeconds = 1.0 / 96;
inline constexpr int kStepsToTrouble = 6;   ///< an element inverted or wound for so long is in trouble
inline constexpr int kStepsToShare = 8;     ///< that it and its neighbourhood then share a rotation
inline constexpr int kStepsPerRing = 12;    ///< of lasting trouble, after which the neighbourhood grows by a ring
inline constexpr int kStepsToWatch = 8;     ///< that the rings of an element are looked at after it was flat
inline constexpr int kStepsToGiveUp = 150;  ///< of sharing that an element of a held piece may ask for: 12 rings

/// A patch whose mean deformation gradient stretches some direction by more is left alone: pins or pulls draw it out,
/// as no tangle does to itself. There its cross-sections turn freely (nothing crosses the pull resists), and one
/// rotation for all of them would take these turns for swelling: a drawn-out leg blew up to several times its width.
inline constexpr double kDrawnOut = 1.8;

/// What recovery knows of one element; all zero for one that was well for long.
struct ElementTrouble {
  float bad_steps = 0;     ///< in a row: inverted or wound
  float shared_steps = 0;  ///< with a shared rotation; forgotten one by one while it is well
  float sharing = 0;       ///< steps left to share
  float watched = 0;       ///< steps left to look at its rings
  bool operator==(const ElementTrouble&) const = default;
};

/// Per element; empty if all are zero.
using ElementTroubles = std::vector<ElementTrouble>;

/// What recovery did in one step.
struct RecoveryReport {
  Index elements = 0;  ///< that shared a rotation
  Index patches = 0;   ///< connected groups of these
  Index given_up = 0;  ///< that became hopeless: still in trouble after kStepsToGiveUp, as pins or pulls hold it so
};

/// Where recovery must not, or need not, act.
struct HeldBody {
  std::span<const std::uint8_t> nodes;   ///< 1 per node whose place is prescribed
  std::span<const std::uint8_t> pieces;  ///< 1 per piece that a pin or pull holds
  const Pieces& all_pieces;
};

/// Counts one step of `seconds` at `positions`. Elements of which every node is held are never in trouble: nothing can
/// mend them. flat: find_rotations_and_flat's; nothing is looked at while it is 0 and `troubles` is empty. Sets
/// given_up.
void count_troubles(const ElasticBody& body, std::span<const Vec3> positions, std::int64_t flat, const HeldBody& held,
                    double seconds, ElementTroubles& troubles, RecoveryReport& report);

/// Gives the elements with steps left to share the rotation nearest to the sum of V F over their patch; those of a
/// patch that is drawn out (kDrawnOut) lose these steps, which do not count as tried, and keep their own. rotations:
/// those of the elements alone in, results out; seconds: of the step; guesses: rotations of the step before, for ties.
/// Sets elements and patches.
void share_rotations(const ElasticBody& body, std::span<const Vec3> positions, double seconds,
                     ElementTroubles& troubles, std::span<const Quaternion> guesses, std::span<Quaternion> rotations,
                     RecoveryReport& report);

}  // namespace softreel
