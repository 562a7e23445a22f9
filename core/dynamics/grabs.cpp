/// What pins and pulls hold from the frame at which they start on.
#include <algorithm>

#include "core/dynamics/simulator_parts.h"

namespace softreel {

bool Simulator::Parts::has_grabs() const {
  const auto grabs = [](const Pull& pull) { return pull.grab; };
  return pins.grab() || std::any_of(model.pulls.begin(), model.pulls.end(), grabs);
}

Grabs Simulator::Parts::grabs_at(double frame) const {
  Grabs grabs = state.grabs;
  if (!has_grabs()) return grabs;
  grabs.pins.resize(model.pins.size());
  grabs.pulls.resize(model.pulls.size());
  pins.update(grabs.pins, frame, state.positions);
  update_grabs(model.pulls, model.surface_points, model.embedding, model.mesh, state.positions, frame, grabs.pulls);
  return grabs;
}

void Simulator::start_grabs(double frame) {
  parts_->state.grabs = parts_->grabs_at(frame);
}

}  // namespace softreel
