#include "core/constraints/pins.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "core/constraints/targets.h"

namespace softreel {
namespace {

/// Pins agree on a node if their targets differ by less than this share of the body's size.
constexpr double kAgreement = 1e-9;

/// Position of a surface point at rest.
Vec3 rest_point(std::size_t point, const Embedding& embedding, const TetMesh& mesh) {
  const Tet& tet = mesh.tets[static_cast<std::size_t>(embedding.elements[point])];
  Vec3 position = Vec3::Zero();
  for (std::size_t k = 0; k < 4; ++k)
    position += embedding.weights[point][k] * mesh.nodes[static_cast<std::size_t>(tet[k])];
  return position;
}

/// Sorts frames and adds a whole one between each and the next, where steps end whatever their length: at a third of
/// the way, as eases that differ agree again at the half.
void add_frames_between(std::vector<double>& frames) {
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  for (std::size_t k = frames.size(); k-- > 1;) {
    const double between = std::round(frames[k - 1] + (frames[k] - frames[k - 1]) / 3);
    if (between > frames[k - 1] && between < frames[k]) frames.push_back(between);
  }
  std::sort(frames.begin(), frames.end());
}

double box_diagonal(const std::vector<Vec3>& points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(point);
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

}  // namespace

NodePins::NodePins(std::vector<Pin> pins, const Embedding& embedding, const TetMesh& mesh)
    : pins_(std::move(pins)), rest_positions_(mesh.nodes), agreement_(kAgreement * box_diagonal(mesh.nodes)) {
  for (const Pin& pin : pins_) held_.push_back(held_by(pin, embedding, mesh));
}

NodePins::Held NodePins::held_by(const Pin& pin, const Embedding& embedding, const TetMesh& mesh) {
  struct Nearest {
    double squared_distance = 1e300;
    std::size_t point = 0;  ///< of the pin's points
  };
  std::map<Index, Nearest> nearest;
  for (std::size_t k = 0; k < pin.points.size(); ++k) {
    const auto point = static_cast<std::size_t>(pin.points[k]);
    const Vec3 place = rest_point(point, embedding, mesh);
    for (const Index node : mesh.tets[static_cast<std::size_t>(embedding.elements[point])]) {
      Nearest& best = nearest[node];
      const double d = (mesh.nodes[static_cast<std::size_t>(node)] - place).squaredNorm();
      if (d < best.squared_distance) best = {d, k};
    }
  }
  Held held;
  for (const auto& [node, best] : nearest) {
    held.nodes.push_back(node);
    held.rest.push_back(mesh.nodes[static_cast<std::size_t>(node)]);
    if (!pin.ties.empty()) held.ties.push_back(pin.ties[best.point]);
  }
  return held;
}

bool NodePins::grab() const {
  return std::any_of(pins_.begin(), pins_.end(), [](const Pin& pin) { return pin.grab; });
}

void NodePins::update(std::span<Grab> grabs, double frame, std::span<const Vec3> positions) const {
  for (std::size_t p = 0; p < grabs.size(); ++p) {
    if (!pins_[p].grab) continue;
    update_grab(grabs[p], active_range(pins_[p].active, frame), frame, [&] {
      std::vector<Vec3> grabbed;
      for (const Index node : held_[p].nodes) grabbed.push_back(positions[static_cast<std::size_t>(node)]);
      return grabbed;
    });
  }
}

PinnedNodes NodePins::nothing_held() const {
  PinnedNodes pinned;
  pinned.held.assign(rest_positions_.size(), 0);
  pinned.targets.assign(rest_positions_.size(), Vec3::Zero());
  return pinned;
}

PinnedNodes NodePins::at(double frame, std::span<const Grab> grabs) const {
  PinnedNodes pinned = nothing_held();
  std::vector<std::size_t> owner(rest_positions_.size(), 0);
  hold(frame, grabs, pinned, owner);
  return pinned;
}

void NodePins::hold(double frame, std::span<const Grab> grabs, PinnedNodes& pinned,
                    std::vector<std::size_t>& owner) const {
  const Grab nothing;
  for (std::size_t p = 0; p < pins_.size(); ++p) {
    const Pin& pin = pins_[p];
    const Held& its = held_[p];
    const Index range = active_range(pin.active, frame);
    const Grab& grab = pin.grab && p < grabs.size() ? grabs[p] : nothing;
    if (range < 0 || (pin.grab && !grab.holds())) continue;
    const std::vector<Vec3> targets = guided_points({pin.track, pin.follow, its.ties}, its.rest, frame, grab);
    for (std::size_t n = 0; n < targets.size(); ++n) {
      const auto i = static_cast<std::size_t>(its.nodes[n]);
      const Vec3& target = targets[n];
      if (pinned.held[i] == 0) {
        pinned.held[i] = 1;
        pinned.targets[i] = target;
        owner[i] = p;
        ++pinned.count;
      } else if (pinned.conflict.empty() && !((pinned.targets[i] - target).norm() <= agreement_)) {
        pinned.conflict = fmt::format(
            "{} and {} want node {} at different places at frame {}: ({:.6g}, {:.6g}, {:.6g}) and ({:.6g}, {:.6g}, "
            "{:.6g}).\n  Accepted: pins that share a tetrahedron move it alike. Select points that are farther apart, "
            "or let the pins be active at different frames.",
            pins_[owner[i]].name, pin.name, i, frame, pinned.targets[i].x(), pinned.targets[i].y(),
            pinned.targets[i].z(), target.x(), target.y(), target.z());
      }
    }
  }
}

bool NodePins::share_a_node() const {
  std::vector<std::uint8_t> held(rest_positions_.size(), 0);
  for (const Held& pin : held_)
    for (const Index node : pin.nodes)
      if (held[static_cast<std::size_t>(node)]++ != 0) return true;
  return false;
}

std::string NodePins::find_conflict() const {
  if (!share_a_node()) return {};
  std::vector<double> frames;
  for (const Pin& pin : pins_) {
    for (const Key<Transform>& key : pin.track.keys) frames.push_back(key.frame);
    for (const FrameRange& range : pin.active) {
      frames.push_back(range.first);
      frames.push_back(range.last);
    }
  }
  add_frames_between(frames);
  // In one workspace: a captured motion has a key a frame, and a mesh far more nodes than its pins hold.
  PinnedNodes pinned = nothing_held();
  std::vector<std::size_t> owner(rest_positions_.size(), 0);
  for (const double frame : frames) {
    hold(frame, {}, pinned, owner);
    if (!pinned.conflict.empty()) return pinned.conflict;
    for (const Held& pin : held_)
      for (const Index node : pin.nodes) pinned.held[static_cast<std::size_t>(node)] = 0;
  }
  return {};
}

}  // namespace softreel
