#include "tool/stages/shot_run.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/skinning/skinning.h"

namespace softreel {

struct ShotRun::Body {
  LoadedBody loaded;
  FilledBody filled;
  std::unique_ptr<BodySimulation> simulation;
  std::vector<Vec3> previous_positions;  ///< nodes at the frame before; empty at the start
  BodyFrame frame;
};

ShotRun::ShotRun(const Shot& shot, const RunContext& context) : shot_(shot), context_(context) {
  for (const BodySettings& settings : shot.bodies) {
    auto body = std::make_unique<Body>();
    body->loaded = load_body(settings, context);
    for (const std::string& fact : body->loaded.facts) context.log.info(settings.name + ": " + fact);
    // Selections that take nothing are said before the long work starts.
    std::vector<Pin> pins;
    std::vector<Pull> pulls;
    resolve_constraints(settings, body->loaded.surface, pins, pulls);
    bodies_.push_back(std::move(body));
  }
}

ShotRun::~ShotRun() = default;

const LoadedBody& ShotRun::loaded(std::size_t body) const {
  return bodies_[body]->loaded;
}

const FilledBody& ShotRun::filled(std::size_t body) const {
  CHECK(filled_);
  return bodies_[body]->filled;
}

std::vector<LevelInfo> ShotRun::levels(std::size_t body) const {
  CHECK(filled_);
  return bodies_[body]->simulation->levels();
}

void ShotRun::fill() {
  if (filled_) return;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body& body = *bodies_[b];
    context_.stop_if_cancelled();
    body.filled = fill_body(settings(b), body.loaded, context_);
    body.simulation = std::make_unique<BodySimulation>(
        shot_, make_body_model(shot_, settings(b), body.loaded, body.filled), body.filled.key, context_);
  }
  filled_ = true;
}

void ShotRun::advance_to(int frame) {
  fill();
  for (const auto& body : bodies_) {
    while (body->simulation->upcoming_frame() <= frame) {
      context_.stop_if_cancelled();
      body->previous_positions = std::move(body->frame.state.positions);
      body->frame = body->simulation->next_frame();
      counts_.frames += 1;
      counts_.frames_from_cache += body->frame.from_cache ? 1 : 0;
      counts_.linear_iterations += body->frame.linear_iterations;
      counts_.nonlinear_iterations += body->frame.nonlinear_iterations;
    }
    CHECK(body->simulation->upcoming_frame() == frame + 1);
  }
}

std::vector<Vec3> positions_between(const std::vector<const std::vector<Vec3>*>& steps, double time) {
  const auto intervals = static_cast<double>(steps.size() - 1);
  const double place = std::clamp((1 + time) * intervals, 0.0, intervals);
  const auto first = static_cast<std::size_t>(std::min(std::floor(place), std::max(0.0, intervals - 1)));
  const double share = place - static_cast<double>(first);
  if (share == 0 || steps.size() == 1) return *steps[first];
  const std::vector<Vec3>&a = *steps[first], &b = *steps[first + 1];
  std::vector<Vec3> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = share == 1 ? b[i] : Vec3(a[i] + share * (b[i] - a[i]));
  return result;
}

SkinnedBody ShotRun::skin(const Body& body, const SkinRequest& request) const {
  std::vector<const std::vector<Vec3>*> steps;
  if (!body.previous_positions.empty()) steps.push_back(&body.previous_positions);
  for (const auto& step : body.frame.earlier_steps) steps.push_back(&step);
  steps.push_back(&body.frame.state.positions);
  const bool blurred = request.shutter > 0 && steps.size() > 1;
  const int segments = blurred ? request.segments : 0;
  SkinnedBody skinned;
  for (int k = 0; k <= segments; ++k) {
    const double time = segments == 0 ? 0.0 : request.shutter * (static_cast<double>(k) / segments - 1);
    const std::vector<Vec3> nodes = positions_between(steps, time);
    SkinnedBody::Time& at = skinned.times.emplace_back();
    const FilledBody& filled = body.filled;
    at.positions =
        skin_positions(body.loaded.surface.positions, filled.embedding, filled.mesh, nodes, context_.threads);
    if (request.normals)
      at.normals = skin_normals(filled.normals, filled.embedding, filled.mesh, nodes, context_.threads);
  }
  return skinned;
}

std::vector<SkinnedBody> ShotRun::skin(const SkinRequest& request) {
  const ScopedStage stage(context_.times, "skin");
  std::vector<SkinnedBody> skinned;
  for (const auto& body : bodies_) skinned.push_back(skin(*body, request));
  return skinned;
}

}  // namespace softreel
