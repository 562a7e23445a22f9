#include "tool/bodies/body_frame_bytes.h"

#include "core/base/check.h"
#include "tool/cache/bytes.h"
#include "tool/cache/stage_names.h"

namespace softreel {
namespace {

void pack(const Grabs& grabs, ByteWriter& out) {
  for (const std::vector<Grab>* list : {&grabs.pins, &grabs.pulls}) {
    out.put(static_cast<std::uint64_t>(list->size()));
    for (const Grab& grab : *list) {
      out.put(grab.range);
      out.put(grab.frame);
      out.put_array(grab.positions);
    }
  }
}

Grabs unpack_grabs(ByteReader& in) {
  Grabs grabs;
  for (std::vector<Grab>* list : {&grabs.pins, &grabs.pulls}) {
    list->resize(in.get<std::uint64_t>());
    for (Grab& grab : *list) {
      grab.range = in.get<Index>();
      grab.frame = in.get<double>();
      grab.positions = in.get_array<Vec3>();
    }
  }
  return grabs;
}

}  // namespace

Bytes pack(const BodyFrame& frame) {
  ByteWriter out;
  out.put_array(frame.state.positions);
  out.put_array(frame.state.velocities);
  out.put_array(frame.state.rotations);
  out.put_array(frame.state.previous_positions);
  out.put_array(frame.state.previous_velocities);
  out.put_array(frame.state.accelerations);
  out.put_array(frame.state.previous_accelerations);
  out.put(frame.state.previous_error);
  out.put(frame.state.previous_seconds);
  out.put(frame.state.constraints);
  out.put_array(frame.state.troubles);
  out.put(static_cast<std::uint64_t>(frame.earlier_steps.size()));
  for (const auto& step : frame.earlier_steps) out.put_array(step);
  if (frame.energy) out.put(*frame.energy);
  // Where nothing grabs or sticks frames end here, as those do that are older than grabs, glue and energies.
  const SimulationState& state = frame.state;
  if (state.grabs.pins.empty() && state.grabs.pulls.empty() && state.bonds.empty()) return out.take();
  CHECK(frame.energy.has_value());  // what follows it is found by its place
  pack(state.grabs, out);
  out.put_array(state.bonds);
  return out.take();
}

BodyFrame unpack_body_frame(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  BodyFrame frame;
  frame.state.positions = in.get_array<Vec3>();
  frame.state.velocities = in.get_array<Vec3>();
  frame.state.rotations = in.get_array<Quaternion>();
  frame.state.previous_positions = in.get_array<Vec3>();
  frame.state.previous_velocities = in.get_array<Vec3>();
  frame.state.accelerations = in.get_array<Vec3>();
  frame.state.previous_accelerations = in.get_array<Vec3>();
  frame.state.previous_error = in.get<double>();
  frame.state.previous_seconds = in.get<double>();
  frame.state.constraints = in.get<std::uint64_t>();
  frame.state.troubles = in.get_array<ElementTrouble>();
  frame.earlier_steps.resize(in.get<std::uint64_t>());
  for (auto& step : frame.earlier_steps) step = in.get_array<Vec3>();
  if (!in.at_end()) frame.energy = in.get<FrameEnergy>();
  if (in.at_end()) return frame;
  frame.state.grabs = unpack_grabs(in);
  frame.state.bonds = in.get_array<GlueBond>();
  return frame;
}

std::optional<FrameEnergy> stored_energy(const Cache& cache, const StageKey& frame_key) {
  const auto stored = cache.load(kSimulationStage, frame_key);
  return stored ? unpack_body_frame(stored->bytes).energy : std::nullopt;
}

}  // namespace softreel
