/// Values over frames: keys with constant, linear or smooth interpolation.
#pragma once

#include <optional>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// How a value moves from its key to the next one.
enum class Ease {
  Constant,  ///< stays until the next key
  Linear,
  Smooth  ///< 3 t^2 - 2 t^3: starts and ends at rest
};

template <typename T>
struct Key {
  double frame = 0;
  T value{};
  Ease ease = Ease::Smooth;
};

/// Keys sorted by strictly rising frame. Before the first key and after the last, that key's value holds.
template <typename T>
struct Track {
  std::vector<Key<T>> keys;

  /// Value at a frame, which may lie between two frames (sub-steps). The track must have a key.
  T at(double frame) const;
};

/// Share of the way from one key to the next after a share t in [0, 1] of its time.
double eased(Ease ease, double t);

template <typename T>
T Track<T>::at(double frame) const {
  std::size_t next = 0;
  while (next < keys.size() && keys[next].frame <= frame) ++next;
  if (next == 0) return keys.front().value;
  if (next == keys.size()) return keys.back().value;
  const Key<T>&a = keys[next - 1], &b = keys[next];
  const double s = eased(a.ease, (frame - a.frame) / (b.frame - a.frame));
  return s == 0 ? a.value : T(a.value + s * (b.value - a.value));
}

/// The last frame in (after, until] at which the value jumps: from a key that stays until the next one to that one.
template <typename T>
std::optional<double> last_jump(const Track<T>& track, double after, double until) {
  for (std::size_t k = track.keys.size(); k-- > 1;) {
    const Key<T>&from = track.keys[k - 1], &to = track.keys[k];
    if (to.frame <= after) break;
    if (to.frame <= until && from.ease == Ease::Constant && from.value != to.value) return to.frame;
  }
  return std::nullopt;
}

/// What a key of a pin or pull says; rotations are angles, so that a full turn is a motion of its own.
struct Transform {
  Vec3 translate = Vec3::Zero();  ///< m
  Vec3 rotate = Vec3::Zero();     ///< rad about the fixed axes: x first, then y, then z
  Vec3 scale = Vec3::Ones();
  Vec3 pivot = Vec3::Zero();  ///< m, centre of rotation and scale

  bool operator==(const Transform&) const = default;

  Transform operator+(const Transform& o) const;
  Transform operator-(const Transform& o) const;
  friend Transform operator*(double s, const Transform& t);

  /// pivot + R S (p - pivot) + translate; exactly p if nothing moves.
  Vec3 apply(const Vec3& p) const;
};

/// Frames during which something holds, ends included.
struct FrameRange {
  double first = 0, last = 0;
};

/// Number of the first range that `frame` lies in, 0 where there is no range at all, which means always; else -1. A
/// range of whole frames goes on until the next one begins if that is a frame later: steps lie between frames.
Index active_range(const std::vector<FrameRange>& ranges, double frame);

/// True if active_range finds one.
bool is_active(const std::vector<FrameRange>& ranges, double frame);

}  // namespace softreel
