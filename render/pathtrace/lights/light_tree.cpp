#include "render/pathtrace/lights/light_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/check.h"
#include "render/pathtrace/rays/sampling.h"

namespace softreel {

namespace {

EmitterBounds joined(const EmitterBounds& a, const EmitterBounds& b) {
  return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high), a.normals.joined(b.normals), a.power_by_pi + b.power_by_pi};
}

/// cos(max(0, a - b)) of angles in [0, pi] given by their cosines and sines.
float cos_less(float sin_a, float cos_a, float sin_b, float cos_b) {
  return cos_a > cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
}

/// sin(max(0, a - b)).
float sin_less(float sin_a, float cos_a, float sin_b, float cos_b) {
  return cos_a > cos_b ? 0.0f : sin_a * cos_b - cos_a * sin_b;
}

float sine_of(float cosine) {
  return std::sqrt(std::max(0.0f, 1 - cosine * cosine));
}

}  // namespace

DirectionCone DirectionCone::joined(const DirectionCone& other) const {
  if (angle < 0) return other;
  if (other.angle < 0) return *this;
  const Vec3f across = axis.cross(other.axis);
  const float between = std::atan2(across.norm(), axis.dot(other.axis));  // exact for directions that are nearly one
  if (std::min(between + other.angle, kPi) <= angle) return *this;
  if (std::min(between + angle, kPi) <= other.angle) return other;
  const float half = 0.5f * (angle + between + other.angle);
  // Directions that floats hardly tell apart have no plane to turn in; the margin below is far more than they differ
  // by.
  if (!(across.norm() > 1e-6f) && axis.dot(other.axis) > 0)
    return {axis, std::min(std::max(angle, between + other.angle) + 1e-3f, kPi)};
  if (half >= kPi || !(across.norm() > 1e-6f)) return {axis, kPi};
  // Towards the other axis, so that the cone just holds the far side of this one.
  const Vec3f sideways = across.normalized().cross(axis);
  const float turn = half - angle;
  // A little wider than the arithmetic says: bounds must hold what rounding moved.
  return {(std::cos(turn) * axis + std::sin(turn) * sideways).normalized(), std::min(half + 1e-3f, kPi)};
}

LightTree::Node LightTree::node_of(const EmitterBounds& bounds) {
  Node node{};
  node.center = 0.5f * (bounds.low + bounds.high);
  node.radius2 = 0.25f * (bounds.high - bounds.low).squaredNorm();
  node.axis = bounds.normals.axis;
  node.cos_spread = std::cos(bounds.normals.angle);
  node.sin_spread = std::sin(bounds.normals.angle);
  node.power = bounds.power_by_pi;
  return node;
}

LightTree::LightTree(const std::vector<EmitterBounds>& emitters) : trails_(emitters.size()) {
  if (emitters.empty()) return;
  std::vector<Index> order(emitters.size());
  std::iota(order.begin(), order.end(), 0);
  nodes_.reserve(2 * emitters.size());
  build(order, 0, order.size(), emitters, 0, 0);
}

/// Halves the emitters at the median along the longest axis of their middles: no tree is deeper than kMostDepth.
Index LightTree::build(std::vector<Index>& order, std::size_t begin, std::size_t end,
                       const std::vector<EmitterBounds>& emitters, std::uint64_t trail, int depth) {
  const auto at = [&](std::size_t k) -> const EmitterBounds& { return emitters[static_cast<std::size_t>(order[k])]; };
  EmitterBounds all = at(begin);
  Vec3f low = all.low + all.high, high = low;  // of twice the middles
  for (std::size_t k = begin + 1; k < end; ++k) {
    all = joined(all, at(k));
    low = low.cwiseMin(at(k).low + at(k).high);
    high = high.cwiseMax(at(k).low + at(k).high);
  }
  const auto index = static_cast<Index>(nodes_.size());
  nodes_.push_back(node_of(all));
  if (end - begin == 1) {
    nodes_.back().emitter = order[begin];
    trails_[static_cast<std::size_t>(order[begin])] = trail;
    return index;
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const auto middle = static_cast<std::ptrdiff_t>(begin + (end - begin) / 2);
  std::nth_element(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + middle,
                   order.begin() + static_cast<std::ptrdiff_t>(end), [&](Index a, Index b) {
                     const EmitterBounds &one = emitters[static_cast<std::size_t>(a)],
                                         &two = emitters[static_cast<std::size_t>(b)];
                     const float x = one.low[axis] + one.high[axis], y = two.low[axis] + two.high[axis];
                     return x != y ? x < y : a < b;
                   });
  const auto split = static_cast<std::size_t>(middle);
  build(order, begin, split, emitters, trail, depth + 1);
  const Index second = build(order, split, end, emitters, trail | std::uint64_t{1} << depth, depth + 1);
  nodes_[static_cast<std::size_t>(index)].second = second;
  return index;
}

float LightTree::importance(const Node& node, const TreeReceiver& receiver) {
  const Vec3f to_receiver = receiver.position - node.center;
  const float squared = to_receiver.squaredNorm();
  // Inside the sphere around the emitters nothing can be ruled out.
  if (squared <= node.radius2 * 1.0001f) return node.power / std::max(node.radius2, 1e-30f);
  const Vec3f from = to_receiver / std::sqrt(squared);
  const float sin_extent = std::sqrt(node.radius2 / squared), cos_extent = std::sqrt(1 - node.radius2 / squared);
  const float cos_out = node.axis.dot(from), sin_out = sine_of(cos_out);
  const float cos_x = cos_less(sin_out, cos_out, node.sin_spread, node.cos_spread);
  const float sin_x = sin_less(sin_out, cos_out, node.sin_spread, node.cos_spread);
  const float emitted = cos_less(sin_x, cos_x, sin_extent, cos_extent);
  if (emitted <= 0) return 0;
  float value = node.power * emitted / squared;
  const float cos_in = -receiver.normal.dot(from);
  const float facing = receiver.both_sides ? std::abs(cos_in) : cos_in;
  const float received = cos_less(sine_of(facing), facing, sin_extent, cos_extent);
  return received > 0 ? value * received : 0.0f;
}

/// With a margin far above the rounding here and in the emitters' own intersections.
bool LightTree::may_meet(const Node& node, const Vec3f& origin, const Vec3f& direction, float length) {
  const Vec3f to = node.center - origin;
  const float along = to.dot(direction);
  const float margin = 1e-5f * (to.cwiseAbs().sum() + origin.cwiseAbs().maxCoeff());
  const float reach = 1.001f * std::sqrt(node.radius2) + margin;
  return along >= -reach && along - reach <= length && (to - along * direction).squaredNorm() <= reach * reach;
}

float LightTree::importance(const TreeReceiver& receiver) const {
  return empty() ? 0.0f : importance(nodes_.front(), receiver);
}

bool LightTree::choose(const TreeReceiver& receiver, float& u, Index& emitter, float& probability) const {
  if (empty() || importance(nodes_.front(), receiver) <= 0) return false;
  probability = 1;
  std::size_t at = 0;
  while (nodes_[at].second != 0) {
    const std::size_t first = at + 1, second = static_cast<std::size_t>(nodes_[at].second);
    const float a = importance(nodes_[first], receiver), b = importance(nodes_[second], receiver);
    if (!(a + b > 0)) return false;
    const float share = a / (a + b);
    const bool takes_first = u < share;
    const float part = takes_first ? share : 1 - share;
    u = std::clamp((takes_first ? u : u - share) / part, 0.0f, 0x1.fffffep-1f);
    probability *= part;
    at = takes_first ? first : second;
  }
  emitter = nodes_[at].emitter;
  return probability > 0;
}

float LightTree::probability(const TreeReceiver& receiver, Index emitter) const {
  CHECK(static_cast<std::size_t>(emitter) < trails_.size());
  if (importance(nodes_.front(), receiver) <= 0) return 0;
  std::uint64_t trail = trails_[static_cast<std::size_t>(emitter)];
  float probability = 1;
  for (std::size_t at = 0; nodes_[at].second != 0; trail >>= 1) {
    const std::size_t first = at + 1, second = static_cast<std::size_t>(nodes_[at].second);
    const float a = importance(nodes_[first], receiver), b = importance(nodes_[second], receiver);
    if (!(a + b > 0)) return 0;
    const bool takes_second = (trail & 1) != 0;
    const float share = a / (a + b);
    probability *= takes_second ? 1 - share : share;
    at = takes_second ? second : first;
  }
  return probability;
}

}  // namespace softreel
