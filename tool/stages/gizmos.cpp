#include "tool/stages/gizmos.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "core/constraints/pulls.h"
#include "core/constraints/targets.h"
#include "tool/bodies/simulate_key.h"

namespace softreel {
namespace {

const Vec3f kPinColor(1.0f, 0.25f, 0.6f), kPullColor(0.15f, 0.65f, 1.0f), kRegionColor(0.35f, 0.85f, 0.35f);
constexpr float kPointDiameter = 6, kTargetDiameter = 14;
constexpr double kCube = 0.022;     ///< edge of the cubes that get one dot, share of the diagonal of the body's box
constexpr std::size_t kDots = 64;   ///< of a pin or a pull: more of them hide a face; larger cubes then
constexpr std::size_t kLines = 24;  ///< of a pull: more of them hide the body

/// A body at the frame.
using Points = std::vector<Vec3>;

Vec3f at(const Points& points, Index p) {
  return points[static_cast<std::size_t>(p)].cast<float>();
}

void add_dots(GizmoMarks& marks, const Points& points, const std::vector<Index>& selected, const Vec3f& color) {
  for (const Index p : selected) marks.dots.push_back({at(points, p), color, kPointDiameter});
}

/// The first point in each cube of a grid.
std::vector<Index> thinned(const std::vector<Index>& selected, const SurfaceMesh& surface, double cube) {
  const Bounds bounds = used_bounds(surface);
  std::set<std::array<std::int64_t, 3>> taken;
  std::vector<Index> kept;
  for (const Index p : selected) {
    const Vec3 place = (surface.positions[static_cast<std::size_t>(p)] - bounds.min) / cube;
    std::array<std::int64_t, 3> cell;
    for (std::size_t k = 0; k < 3; ++k) cell[k] = std::llround(std::floor(place[static_cast<Eigen::Index>(k)]));
    if (taken.insert(cell).second) kept.push_back(p);
  }
  return kept;
}

std::vector<Index> thinned(const std::vector<Index>& selected, const SurfaceMesh& surface) {
  return thinned(selected, surface, kCube * used_bounds(surface).diagonal());
}

/// At most kDots of them.
std::vector<Index> few_of(const std::vector<Index>& selected, const SurfaceMesh& surface) {
  double cube = kCube * used_bounds(surface).diagonal();
  std::vector<Index> kept = thinned(selected, surface, cube);
  while (kept.size() > kDots) kept = thinned(kept, surface, cube *= 1.25);
  return kept;
}

void add_pull(GizmoMarks& marks, const Pull& pull, const std::vector<Index>& dots, const Points& rest,
              const Points& points, double frame, const Grab& grab) {
  if (pulling_range(pull, frame) < 0) return;
  add_dots(marks, points, dots, kPullColor);
  const std::vector<Vec3> targets = pull_targets(pull, rest, frame, grab);
  const auto target = [&](Index p) {
    const auto place = std::lower_bound(pull.points.begin(), pull.points.end(), p) - pull.points.begin();
    return targets[static_cast<std::size_t>(place)];
  };
  // Evenly spread over the points in the order of the file, ends included.
  const std::size_t lines = std::min(kLines, dots.size());
  for (std::size_t k = 0; k < lines; ++k) {
    const Index p = dots[lines == 1 ? 0 : k * (dots.size() - 1) / (lines - 1)];
    marks.lines.push_back({at(points, p), target(p).cast<float>(), kPullColor});
  }
  Vec3 middle = Vec3::Zero();
  for (const Index p : pull.points) middle += target(p) / static_cast<double>(pull.points.size());
  marks.dots.push_back({middle.cast<float>(), kPullColor, kTargetDiameter});
}

std::vector<Index> points_of_regions(const BodySettings& body, const LoadedBody& loaded) {
  std::vector<Index> points;
  for (const RegionSettings& region : body.regions) {
    const std::vector<Index> selected = select_points(region.select, loaded.surface, loaded.weight_maps);
    points.insert(points.end(), selected.begin(), selected.end());
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

}  // namespace

Gizmos::Gizmos(const ShotRun& run, const GizmoKinds& kinds) : run_(run), kinds_(kinds) {
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    const SurfaceMesh& surface = run.loaded(b).surface;
    BodyMarks body{resolve_constraints(run.shot(), run.settings(b), run.loaded(b), Log{}), {}, {}, {}};
    for (const Pin& pin : body.constraints.pins) body.pin_dots.push_back(few_of(pin.points, surface));
    for (const Pull& pull : body.constraints.pulls) body.pull_dots.push_back(few_of(pull.points, surface));
    body.region_dots = thinned(points_of_regions(run.settings(b), run.loaded(b)), surface);
    bodies_.push_back(std::move(body));
  }
}

GizmoMarks Gizmos::at(int frame, const std::vector<SkinnedBody>& bodies,
                      const std::vector<std::vector<char>>& shown) const {
  GizmoMarks marks;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto dots = [&](std::vector<Index> points) {
      if (!shown.empty()) std::erase_if(points, [&](Index p) { return shown[b][static_cast<std::size_t>(p)] == 0; });
      return points;
    };
    const Points& points = bodies[b].times.back().positions;
    const BodyMarks& body = bodies_[b];
    const std::vector<Pin>& pins = body.constraints.pins;
    const std::vector<Pull>& pulls = body.constraints.pulls;
    const Grab nothing;
    if (kinds_.regions) add_dots(marks, points, dots(body.region_dots), kRegionColor);
    for (std::size_t k = 0; kinds_.pins && k < pins.size(); ++k)
      if (is_active(pins[k].active, frame)) add_dots(marks, points, dots(body.pin_dots[k]), kPinColor);
    for (std::size_t k = 0; kinds_.pulls && k < pulls.size(); ++k)
      add_pull(marks, pulls[k], dots(body.pull_dots[k]), run_.loaded(b).surface.positions, points, frame,
               k < bodies[b].pull_grabs.size() ? bodies[b].pull_grabs[k] : nothing);
  }
  return marks;
}

void Gizmos::add_key(KeyHasher& key, int frame) const {
  key.add("gizmos 2").add(kinds_.pins).add(kinds_.pulls).add(kinds_.regions);
  for (const BodyMarks& body : bodies_) {
    key.add(constraints_key(body.constraints, frame));
    if (kinds_.regions) key.add(body.region_dots);
  }
}

}  // namespace softreel
