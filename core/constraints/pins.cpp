#include "core/constraints/pins.h"

#include <algorithm>

#include <fmt/format.h>

namespace softreel {
namespace {

/// Pins agree on a node if their targets differ by less than this share of the body's size.
constexpr double kAgreement = 1e-9;

std::vector<Index> held_nodes(const Pin& pin, const Embedding& embedding, const TetMesh& mesh) {
  std::vector<Index> nodes;
  for (const Index point : pin.points) {
    const Tet& tet = mesh.tets[static_cast<std::size_t>(embedding.elements[static_cast<std::size_t>(point)])];
    nodes.insert(nodes.end(), tet.begin(), tet.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

double box_diagonal(const std::vector<Vec3>& points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(point);
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

}  // namespace

NodePins::NodePins(std::vector<Pin> pins, const Embedding& embedding, const TetMesh& mesh)
    : pins_(std::move(pins)), rest_positions_(mesh.nodes), agreement_(kAgreement * box_diagonal(mesh.nodes)) {
  for (const Pin& pin : pins_) nodes_.push_back(held_nodes(pin, embedding, mesh));
}

PinnedNodes NodePins::at(double frame) const {
  PinnedNodes pinned;
  pinned.held.assign(rest_positions_.size(), 0);
  pinned.targets.assign(rest_positions_.size(), Vec3::Zero());
  std::vector<std::size_t> owner(rest_positions_.size(), 0);
  for (std::size_t p = 0; p < pins_.size(); ++p) {
    if (!is_active(pins_[p].active, frame)) continue;
    const Transform transform = pins_[p].track.at(frame);
    for (const Index node : nodes_[p]) {
      const auto i = static_cast<std::size_t>(node);
      const Vec3 target = transform.apply(rest_positions_[i]);
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
            pins_[owner[i]].name, pins_[p].name, node, frame, pinned.targets[i].x(), pinned.targets[i].y(),
            pinned.targets[i].z(), target.x(), target.y(), target.z());
      }
    }
  }
  return pinned;
}

std::string NodePins::find_conflict() const {
  std::vector<double> frames;
  for (const Pin& pin : pins_) {
    for (const Key<Transform>& key : pin.track.keys) frames.push_back(key.frame);
    for (const FrameRange& range : pin.active) {
      frames.push_back(range.first);
      frames.push_back(range.last);
    }
  }
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  for (const double frame : frames)
    if (std::string conflict = at(frame).conflict; !conflict.empty()) return conflict;
  return {};
}

}  // namespace softreel
