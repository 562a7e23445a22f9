#include "tool/bodies/simulate_stage.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/elasticity/mass.h"
#include "tool/bodies/body_frame_bytes.h"
#include "tool/bodies/glue_stage.h"
#include "tool/bodies/simulate_key.h"
#include "tool/cache/stage_names.h"

namespace softreel {
namespace {

StageKey materials_key(const Shot& shot, const BodySettings& settings, const LoadedBody& loaded) {
  KeyHasher key("materials");
  add_materials(key, shot, settings, loaded);
  return key.key();
}

}  // namespace

SimulationWork& SimulationWork::operator+=(const SimulationWork& other) {
  linear_iterations += other.linear_iterations;
  nonlinear_iterations += other.nonlinear_iterations;
  steps += other.steps;
  steps_at_rest += other.steps_at_rest;
  steps_rejected += other.steps_rejected;
  frames_unchanged += other.frames_unchanged;
  kept_hierarchies += other.kept_hierarchies;
  kept_matrices += other.kept_matrices;
  return *this;
}

namespace {

SimulationSource source_of(const Shot& shot, const BodySettings& settings, const LoadedBody& loaded,
                           const BodyConstraints& constraints, const RunContext& context) {
  const StageKey filled = filled_key(settings, loaded);
  return {filled,
          simulation_keys(shot, solver_of(shot, settings), constraints, filled, materials_key(shot, settings, loaded)),
          [&settings, &loaded, filled, &context] { return fill_body(settings, loaded, filled, context); },
          [&shot, &settings, &loaded](const FilledBody& body, const BodyConstraints& held) {
            require_regions(settings, loaded, body.mesh);
            return make_body_model(shot, settings, loaded, body, held);
          }};
}

}  // namespace

BodySimulation::BodySimulation(const Shot& shot, const BodySettings& settings, const LoadedBody& loaded,
                               BodyConstraints constraints, const RunContext& context)
    : BodySimulation(shot, settings, source_of(shot, settings, loaded, constraints, context), std::move(constraints),
                     context) {}

BodySimulation::BodySimulation(const Shot& shot, const BodySettings& settings, SimulationSource source,
                               BodyConstraints&& constraints, const RunContext& context)
    : shot_(shot),
      settings_(settings),
      context_(context),
      source_(std::move(source)),
      constraints_(std::move(constraints)),
      touched_(source_.frame_keys.size(), false),
      frame_number_(first_simulated_frame(shot) - 1),
      goes_back_(shot.render.shutter > 0 || shot.render.params.channels.has(PictureChannel::Motion)),
      other_number_(frame_number_) {}

BodySimulation::~BodySimulation() = default;

void BodySimulation::join(GlueGroup& group, std::size_t member) {
  group_ = &group;
  member_ = member;
}

const StageKey& BodySimulation::frame_key(int frame) const {
  if (group_ != nullptr) return group_->frame_key(frame);
  return source_.frame_keys.at(static_cast<std::size_t>(frame - first_simulated_frame(shot_)));
}

const std::string& BodySimulation::whole_name() const {
  return group_ != nullptr ? group_->name() : settings_.name;
}

const std::map<int, FrameEnergy>& BodySimulation::energies() const {
  return group_ != nullptr ? group_->energies() : energies_;
}

const FilledBody& BodySimulation::filled() {
  if (!filled_) {
    context_.stop_if_cancelled();
    filled_ = std::make_unique<FilledBody>(source_.fill());
  }
  return *filled_;
}

std::vector<LevelInfo> BodySimulation::levels() const {
  if (group_ != nullptr) return member_ == 0 ? group_->levels() : std::vector<LevelInfo>{};
  return simulator_ ? simulator_->levels() : std::vector<LevelInfo>{};
}

SimulationState BodySimulation::rest_state() const {
  const TetMesh& mesh = filled_->mesh;
  return {mesh.nodes, std::vector<Vec3>(mesh.nodes.size(), Vec3::Zero()),
          std::vector<Quaternion>(mesh.tets.size(), Quaternion::Identity())};
}

/// The simulator in the state of frame_.
Simulator& BodySimulation::simulator() {
  if (!simulator_) {
    const ScopedStage stage(context_.times, "simulate/set-up");
    simulator_ = std::make_unique<Simulator>(source_.make_model(filled(), constraints_), solver_of(shot_, settings_),
                                             context_.threads, context_.log, context_.times);
  }
  if (!simulator_holds_frame_) simulator_->set_state(frame_.state);
  simulator_holds_frame_ = true;
  return *simulator_;
}

void BodySimulation::require_solved(const StepReport& report, int frame) const {
  if (report.ok()) return;
  const char* what = report.solve.status == SolveStatus::MaxIterations ? "did not converge" : "broke down";
  const bool is_static = shot_.settings.mode == SimulationMode::Static || frame == first_simulated_frame(shot_);
  const char* advice = is_static
                           ? "Accepted: a shape that pins and pulls can hold. Move the constraint in smaller steps, "
                             "stiffen the material, lower the gravity, or start at rest in a dynamic shot"
                           : "Accepted: a step that can be solved. Move the constraint more slowly, raise "
                             "solver.substeps, or soften what is stiff";
  throw work_error(
      fmt::format("{}: frame {}, body \"{}\": the {} {} after {} iterations (relative residual {:.3g}){}{}.\n"
                  "  {}; the frames before are kept.",
                  shot_.path, frame, settings_.name, is_static ? "equilibrium" : "step", what, report.solve.iterations,
                  report.solve.residual, report.culprit.empty() ? "" : "; worst at ", report.culprit, advice));
}

bool BodySimulation::starts_from_rest(int frame) const {
  const bool independent = shot_.settings.mode == SimulationMode::Static && shot_.settings.independent;
  return independent || frame == first_simulated_frame(shot_);
}

/// frame_ is the body at `frame` now.
void BodySimulation::note(int frame) {
  frame_number_ = frame;
  touched_[static_cast<std::size_t>(frame - first_simulated_frame(shot_))] = true;
  if (frame_.energy) energies_[frame] = *frame_.energy;
}

/// A frame counts as loaded once, however often it is.
void BodySimulation::note_loaded(int frame, double seconds) {
  simulator_holds_frame_ = false;
  if (!touched_[static_cast<std::size_t>(frame - first_simulated_frame(shot_))]) {
    counts_.loaded += 1;
    counts_.saved_seconds += seconds;
  }
  note(frame);
}

/// From now on there is no frame_.
void BodySimulation::put_aside() {
  if (goes_back_) {
    other_ = std::move(frame_);
    other_number_ = frame_number_;
  }
  frame_ = {};
  frame_number_ = first_simulated_frame(shot_) - 1;
  simulator_holds_frame_ = false;
}

bool BodySimulation::take_other(int frame) {
  if (other_number_ != frame) return false;
  std::swap(frame_, other_);
  std::swap(frame_number_, other_number_);
  simulator_holds_frame_ = false;
  return true;
}

bool BodySimulation::load(int frame) {
  const auto stored = context_.cache.load(kSimulationStage, frame_key(frame));
  if (!stored) return false;
  put_aside();
  frame_ = unpack_body_frame(stored->bytes);
  note_loaded(frame, stored->seconds);
  return true;
}

/// From frame_, which is the one before, or from rest.
void BodySimulation::produce(int frame) {
  if (starts_from_rest(frame)) put_aside();
  BodyFrame made;
  const auto simulate = [&] {
    made = simulated(frame);
    return pack(made);
  };
  const Cache::Produced produced = context_.cache.produce(
      kSimulationStage, frame_key(frame), [&] { context_.stop_if_cancelled(); }, simulate);
  const bool holds = simulator_holds_frame_ && !produced.from_cache;
  if (!starts_from_rest(frame)) put_aside();  // else it is done, and frame_ is nothing but the rest that it began with
  frame_ = produced.from_cache ? unpack_body_frame(produced.bytes) : std::move(made);
  if (produced.from_cache) return note_loaded(frame, produced.seconds);
  simulator_holds_frame_ = holds;
  counts_.computed += 1;
  counts_.work += frame_.work;
  if (frame_.recovering_elements > 0) counts_.recoveries.push_back({settings_.name, frame, frame_.recovering_elements});
  note(frame);
}

const BodyFrame& BodySimulation::at(int frame) {
  if (group_ != nullptr) return group_->at(member_, frame);
  if (frame_number_ == frame) return frame_;
  goes_back_ = goes_back_ || frame < frame_number_;
  int from = frame;  // the nearest frame at or before this one that is at hand
  while (!(from == frame_number_ || take_other(from) || load(from) || starts_from_rest(from))) --from;
  if (from != frame_number_) produce(from);
  while (frame_number_ < frame) produce(frame_number_ + 1);
  return frame_;
}

void BodySimulation::require_small_error(const FrameReport& report, int frame) const {
  if (!report.too_short) return;
  throw work_error(fmt::format(
      "{}: frame {}, body \"{}\": the error of a step is {:.3g} of the body's size with the shortest step that "
      "solver.max_substeps = {} allows.\n  Accepted: at most solver.step_error = {:.3g}. Raise one of the two, or let "
      "what jumps (a pin that is switched on, constant keys) move over a few frames; the frames before are kept.",
      shot_.path, frame, settings_.name, report.last.error, shot_.solver.max_substeps, shot_.solver.step_error));
}

/// Steps of time from the frame before.
void BodySimulation::advance(int frame, BodyFrame& result) {
  Simulator& body = simulator();
  simulator_holds_frame_ = false;  // until all of the frame is done
  const auto keep = [&](int part) {
    if (part < shot_.solver.substeps) result.earlier_steps.push_back(body.state().positions);
  };
  const FrameReport report = advance_to_frame(
      body, frame, shot_.settings.fps, [&] { context_.stop_if_cancelled(); }, keep);
  require_solved(report.last, frame);
  require_small_error(report, frame);
  result.work = {report.linear_iterations, report.nonlinear_iterations, report.steps,
                 report.steps_at_rest,     report.steps_rejected,       0,
                 report.kept_hierarchies,  report.kept_matrices};
  result.recovering_elements = report.recovering_elements;
}

SimulationWork BodySimulation::find_equilibrium(int frame) {
  Simulator& body = simulator();
  simulator_holds_frame_ = false;
  const StepReport report = body.find_equilibrium(frame);
  require_solved(report, frame);
  return {report.solve.iterations, report.nonlinear_iterations, 0, 0, 0, 0, 0, 0};
}

/// Of the simulator's state: a pass over the elements, a small part of what a step takes.
FrameEnergy BodySimulation::measured_energy() {
  const ScopedStage stage(context_.times, "simulate/measure");
  const StateMeasures measures = simulator_->measure();
  if (!rest_potential_) {
    const BodyModel& model = simulator_->model();
    const NodalMasses masses = lump_masses(model.mesh, model.materials);
    double potential = 0;
    for (std::size_t i = 0; i < masses.mass.size(); ++i)
      potential -= masses.mass[i] * model.gravity.dot(model.mesh.nodes[i]);
    rest_potential_ = potential;
  }
  return {measures.kinetic_energy, measures.elastic_energy, measures.potential_energy - *rest_potential_};
}

BodyFrame BodySimulation::simulated(int frame) {
  context_.stop_if_cancelled();
  filled();
  const ShotSettings& settings = shot_.settings;
  const bool is_static = settings.mode == SimulationMode::Static;
  BodyFrame result;
  if (starts_from_rest(frame)) {
    frame_.state = rest_state();
    simulator_holds_frame_ = false;
  } else if (is_static && constraints_key(constraints_, frame) == constraints_key(constraints_, frame - 1)) {
    result.state = frame_.state;
    result.energy = frame_.energy;
    result.work.frames_unchanged = 1;
    return result;
  }
  const bool is_start = frame == first_simulated_frame(shot_);
  if (is_start && !is_static && settings.start == StartState::Rest) {
    if (has_grabs(constraints_)) {
      simulator().start_grabs(frame);
      frame_.state = simulator_->state();
    }
    result.state = frame_.state;
    result.energy = FrameEnergy();
    return result;
  }
  if (is_static || is_start)
    result.work = find_equilibrium(frame);
  else
    advance(frame, result);
  result.state = simulator_->state();
  result.energy = measured_energy();
  simulator_holds_frame_ = true;
  return result;
}

SimulationCounts BodySimulation::counts(int last) const {
  if (group_ != nullptr) return member_ == 0 ? group_->counts(last) : SimulationCounts{};
  SimulationCounts counts = counts_;
  const auto frames = static_cast<std::size_t>(last - first_simulated_frame(shot_) + 1);
  for (std::size_t i = 0; i < frames; ++i) {
    if (touched_[i]) continue;
    const auto seconds = context_.cache.seconds(kSimulationStage, source_.frame_keys[i]);
    if (!seconds) continue;
    counts.not_needed += 1;
    counts.saved_seconds += *seconds;
  }
  return counts;
}

}  // namespace softreel
