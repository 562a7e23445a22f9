#include "tool/bodies/constraint_stage.h"

#include <algorithm>

#include <fmt/format.h>

#include "tool/bodies/at_field.h"

namespace softreel {
namespace {

/// Keys in box units to metres: translations in heights of the box, pivots in its coordinates.
Track<Transform> keys_in_meters(Track<Transform> track, bool in_box, bool pivot_given, const Bounds& box,
                                const Vec3& centroid) {
  for (Key<Transform>& key : track.keys) {
    if (in_box) {
      key.value.translate *= box.size().y();
      key.value.pivot = box.min + key.value.pivot.cwiseProduct(box.size());
    }
    if (!pivot_given) key.value.pivot = centroid;
  }
  return track;
}

/// Shares of a height that the body does not have would be nothing at all.
void require_height(const Track<Transform>& keys, const Bounds& box, const Origin& origin, const std::string& field) {
  const bool moves =
      std::any_of(keys.keys.begin(), keys.keys.end(), [](const auto& key) { return !key.value.translate.isZero(0); });
  if (!moves || box.size().y() > 1e-9 * box.diagonal()) return;
  throw input_error(fmt::format(
      "{}: {}.keys translates by heights of the body (keys_unit = \"box\"), but it has none: it lies flat.\n"
      "  Accepted: metres. Take keys_unit = \"m\".",
      to_string(origin), field));
}

Vec3 centroid_of(const std::vector<Index>& points, const SurfaceMesh& surface) {
  Vec3 sum = Vec3::Zero();
  for (const Index p : points) sum += surface.positions[static_cast<std::size_t>(p)];
  return sum / static_cast<double>(points.size());
}

/// Weights that fall smoothly to zero at `falloff` from the centre of the selection, or equal ones; sum 1. Empty if
/// all are 0.
std::vector<double> pull_weights(const std::vector<Index>& points, const SurfaceMesh& surface, double falloff,
                                 const Vec3& center) {
  std::vector<double> weights(points.size(), 1.0);
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (falloff > 0) {
      const double distance = (surface.positions[static_cast<std::size_t>(points[i])] - center).norm();
      weights[i] = distance < falloff ? 1 - eased(Ease::Smooth, distance / falloff) : 0;
    }
    sum += weights[i];
  }
  if (sum > 0)
    for (double& weight : weights) weight /= sum;
  return sum > 0 ? weights : std::vector<double>{};
}

std::vector<Vec3> positions_of(const std::vector<Index>& points, const SurfaceMesh& surface) {
  std::vector<Vec3> positions;
  for (const Index p : points) positions.push_back(surface.positions[static_cast<std::size_t>(p)]);
  return positions;
}

/// Points that hang on a surface far from them turn and swing with it: seldom meant, and where the file is in another
/// place or unit, never.
void warn_of_far_ties(const FollowSettings& follow, const std::string& field, double farthest, const LoadedBody& loaded,
                      const Log& log) {
  constexpr double kFar = 0.1;
  const double size = used_bounds(loaded.surface).diagonal();
  if (farthest <= kFar * size) return;
  log.warn(fmt::format(
      "{}: {}.follow: points hang on the nearest place of {} up to {:.3g} m away from them, {:.0f} % of the body's "
      "diagonal. {}",
      to_string(follow.origin), field, follow.file, farthest, 100 * farthest / size,
      follow.in_scene
          ? "If it is in the units and axes of the body's own file, take placement = \"body\"."
          : "If its numbers are metres in the scene, as softreel's own glTF has them, take placement = \"scene\"."));
}

/// What pins and pulls share: their points move by keys, or as what they follow.
template <typename Settings, typename Constraint>
void add_motion(const Shot& shot, const Settings& settings, const LoadedBody& loaded, const std::string& field,
                const Log& log, Constraint& constraint, FollowedFiles& files) {
  constraint.name = fmt::format("{} ({})", field, to_string(settings.origin));
  constraint.active = settings.active;
  constraint.grab = settings.grab;
  if (settings.grab && shot.settings.mode == SimulationMode::Static && shot.settings.independent)
    throw input_error(
        fmt::format("{}: {}.grab = true needs the frame before, but shot.independent starts each from rest.\n  "
                    "Accepted: grab in a shot whose frames follow each other. Set shot.independent = false.",
                    to_string(settings.origin), field));
  if (settings.keys_in_box) require_height(settings.keys, used_bounds(loaded.surface), settings.origin, field);
  constraint.track = keys_in_meters(settings.keys, settings.keys_in_box, settings.pivot_given,
                                    used_bounds(loaded.surface), centroid_of(constraint.points, loaded.surface));
  if (!settings.follow) return;
  constraint.follow = at_field(settings.follow->origin, field + ".follow",
                               [&] { return &files.motion(shot, *settings.follow, loaded, log); });
  const std::vector<Vec3> positions = positions_of(constraint.points, loaded.surface);
  constraint.ties = constraint.follow->tie(positions, constraint.points);
  warn_of_far_ties(*settings.follow, field, constraint.follow->farthest_from(positions, constraint.ties), loaded, log);
}

/// Points that are painted at all.
std::vector<Index> painted_points(const std::vector<double>& weights, const SurfaceMesh& surface) {
  std::vector<Index> points = select_points({{{SelectAll{}, SelectionUnit::Meter}}}, surface);
  std::erase_if(points, [&](Index p) { return !(weights[static_cast<std::size_t>(p)] > 0); });
  return points;
}

/// Points and shares of a pull.
void add_shares(const PullSettings& settings, const LoadedBody& loaded, const std::string& field, Pull& pull) {
  const std::vector<double>* painted = settings.weights ? &weights_of(*settings.weights, loaded.weight_maps) : nullptr;
  pull.points = settings.select.terms.empty() ? painted_points(*painted, loaded.surface)
                                              : select_or_fail(settings.select, loaded, settings.origin, field);
  const auto nothing_left = [&](const std::string& problem, const std::string& accepted) {
    return input_error(fmt::format("{}: {}.{}.\n  Accepted: {}", to_string(settings.origin), field, problem, accepted));
  };
  const bool any = painted == nullptr || std::any_of(pull.points.begin(), pull.points.end(), [&](Index p) {
                     return (*painted)[static_cast<std::size_t>(p)] > 0;
                   });
  if (!any || pull.points.empty())
    throw nothing_left("weights are 0 at every point that the pull takes",
                       "a point of a weight above 0. Paint some, or select others.");
  pull.weights = pull_weights(pull.points, loaded.surface, settings.falloff, centroid_of(pull.points, loaded.surface));
  if (pull.weights.empty())
    throw nothing_left(fmt::format("falloff = {} m reaches no selected point", settings.falloff),
                       "more than the distance from the selection's centre to its nearest point. Enlarge it.");
  if (painted == nullptr) return;
  for (std::size_t i = 0; i < pull.points.size(); ++i)
    pull.weights[i] *= (*painted)[static_cast<std::size_t>(pull.points[i])];
  if (std::none_of(pull.weights.begin(), pull.weights.end(), [](double weight) { return weight > 0; }))
    throw nothing_left(fmt::format("falloff = {} m reaches no point of a weight above 0", settings.falloff),
                       "such points nearer to the selection's centre. Enlarge it.");
}

}  // namespace

std::vector<Index> select_or_fail(const Selection& selection, const LoadedBody& loaded, const Origin& origin,
                                  const std::string& field) {
  std::vector<Index> points =
      at_field(origin, field + ".select", [&] { return select_points(selection, loaded.surface, loaded.weight_maps); });
  if (!points.empty()) return points;
  const Bounds box = used_bounds(loaded.surface);
  throw input_error(fmt::format(
      "{}: {}.select takes no point of the surface.\n  The body reaches from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, "
      "{:.4g}, {:.4g}) m. Accepted: a selection that takes at least one vertex; enlarge it, or use unit = \"box\".",
      to_string(origin), field, box.min.x(), box.min.y(), box.min.z(), box.max.x(), box.max.y(), box.max.z()));
}

BodyConstraints resolve_constraints(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                                    const Log& log) {
  BodyConstraints resolved;
  for (std::size_t i = 0; i < body.pins.size(); ++i) {
    const PinSettings& settings = body.pins[i];
    const std::string field = fmt::format("body.{}.pin[{}]", body.name, i);
    Pin& pin = resolved.pins.emplace_back();
    pin.points = select_or_fail(settings.select, loaded, settings.origin, field);
    add_motion(shot, settings, loaded, field, log, pin, resolved.followed);
  }
  for (std::size_t i = 0; i < body.pulls.size(); ++i) {
    const PullSettings& settings = body.pulls[i];
    const std::string field = fmt::format("body.{}.pull[{}]", body.name, i);
    Pull& pull = resolved.pulls.emplace_back();
    add_shares(settings, loaded, field, pull);
    add_motion(shot, settings, loaded, field, log, pull, resolved.followed);
    pull.stiffness = settings.stiffness;
    pull.max_force = settings.max_force;
  }
  return resolved;
}

}  // namespace softreel
