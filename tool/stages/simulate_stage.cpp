#include "tool/stages/simulate_stage.h"

#include <fmt/format.h>

#include "tool/stages/bytes.h"
#include "tool/stages/simulate_key.h"

namespace softreel {
namespace {

std::vector<std::uint8_t> pack(const BodyFrame& frame) {
  ByteWriter out;
  out.put_array(frame.state.positions);
  out.put_array(frame.state.velocities);
  out.put_array(frame.state.rotations);
  out.put(static_cast<std::uint64_t>(frame.earlier_steps.size()));
  for (const auto& step : frame.earlier_steps) out.put_array(step);
  return out.take();
}

BodyFrame unpack(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  BodyFrame frame;
  frame.state.positions = in.get_array<Vec3>();
  frame.state.velocities = in.get_array<Vec3>();
  frame.state.rotations = in.get_array<Quaternion>();
  frame.earlier_steps.resize(in.get<std::uint64_t>());
  for (auto& step : frame.earlier_steps) step = in.get_array<Vec3>();
  frame.from_cache = true;
  return frame;
}

void count(BodyFrame& frame, const StepReport& report) {
  frame.linear_iterations += report.solve.iterations;
  frame.nonlinear_iterations += report.nonlinear_iterations;
}

}  // namespace

BodySimulation::BodySimulation(const Shot& shot, BodyModel model, const StageKey& filled_key, const RunContext& context)
    : shot_(shot),
      model_(std::move(model)),
      context_(context),
      base_key_(simulation_base_key(shot, model_, filled_key)),
      previous_key_(base_key_),
      state_(rest_state()),
      upcoming_(first_simulated_frame()) {}

BodySimulation::~BodySimulation() = default;

const BodyModel& BodySimulation::model() const {
  return model_;
}

std::vector<LevelInfo> BodySimulation::levels() const {
  return simulator_ ? simulator_->levels() : std::vector<LevelInfo>{};
}

SimulationState BodySimulation::rest_state() const {
  return {model_.mesh.nodes, std::vector<Vec3>(model_.mesh.nodes.size(), Vec3::Zero()),
          std::vector<Quaternion>(model_.mesh.tets.size(), Quaternion::Identity())};
}

Simulator& BodySimulation::simulator() {
  if (!simulator_) {
    const ScopedStage stage(context_.times, "simulate/set-up");
    simulator_ = std::make_unique<Simulator>(model_, shot_.solver, context_.threads, context_.log, context_.times);
  }
  if (!simulator_holds_state_) simulator_->set_state(state_);
  simulator_holds_state_ = true;
  return *simulator_;
}

void BodySimulation::require_solved(const StepReport& report, int frame) const {
  if (report.ok()) return;
  const char* what = report.solve.status == SolveStatus::MaxIterations ? "did not converge" : "broke down";
  const bool is_static = shot_.settings.mode == SimulationMode::Static || frame == first_simulated_frame();
  const char* advice = is_static
                           ? "Accepted: a shape that pins and pulls can hold. Move the constraint in smaller steps, "
                             "stiffen the material, lower the gravity, or start at rest in a dynamic shot"
                           : "Accepted: a step that can be solved. Move the constraint more slowly, raise "
                             "solver.substeps, or soften what is stiff";
  throw work_error(
      fmt::format("{}: frame {}, body \"{}\": the {} {} after {} iterations (relative residual {:.3g}){}{}.\n"
                  "  {}; the frames before are kept.",
                  shot_.path, frame, model_.name, is_static ? "equilibrium" : "step", what, report.solve.iterations,
                  report.solve.residual, report.culprit.empty() ? "" : "; worst at ", report.culprit, advice));
}

int BodySimulation::first_simulated_frame() const {
  return shot_.settings.first_frame - shot_.settings.preroll;
}

StageKey BodySimulation::next_key(int frame) const {
  const int start = first_simulated_frame();
  const bool from_rest = shot_.settings.mode == SimulationMode::Static && shot_.settings.independent;
  return frame_key(shot_, model_, frame == start || from_rest ? base_key_ : previous_key_, frame, frame == start);
}

BodyFrame BodySimulation::next_frame() {
  const int frame = upcoming_;
  const StageKey key = next_key(frame);
  BodyFrame result;
  if (const auto bytes = context_.cache.load("simulation", key)) {
    result = unpack(*bytes);
    simulator_holds_state_ = false;
  } else {
    result = simulated(frame);
    context_.cache.store("simulation", key, pack(result));
  }
  result.key = key;
  state_ = result.state;
  previous_key_ = key;
  ++upcoming_;
  return result;
}

BodyFrame BodySimulation::start_frame() {
  BodyFrame result;
  result.state = state_;
  return result;
}

BodyFrame BodySimulation::simulated(int frame) {
  const ShotSettings& settings = shot_.settings;
  const bool is_start = frame == first_simulated_frame();
  const bool is_static = settings.mode == SimulationMode::Static;
  if (is_start && !is_static && settings.start == StartState::Rest) return start_frame();
  BodyFrame result;
  if (is_static || is_start) {
    if (is_static && settings.independent) {
      state_ = rest_state();
      simulator_holds_state_ = false;
    }
    const StepReport report = simulator().find_equilibrium(frame);
    require_solved(report, frame);
    count(result, report);
  } else {
    const int substeps = shot_.solver.substeps;
    const double seconds = 1.0 / (settings.fps * substeps);
    for (int s = 1; s <= substeps; ++s) {
      context_.stop_if_cancelled();
      const StepReport report = simulator().step(frame - 1 + static_cast<double>(s) / substeps, seconds);
      require_solved(report, frame);
      count(result, report);
      if (s < substeps) result.earlier_steps.push_back(simulator_->state().positions);
    }
  }
  result.state = simulator_->state();
  return result;
}

}  // namespace softreel
