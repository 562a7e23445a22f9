#include "tool/starter/starter_selections.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.h"
#include "core/base/nearest_name.h"

namespace softreel {
namespace {

/// Names of parts that bodies stand on or are fixed at, and of those that one would take hold of.
constexpr const char* kHoldWords[] = {"pin",    "fixed", "anchor", "sole",   "feet",  "foot",
                                      "hooves", "hoof",  "base",   "bottom", "ground"};
constexpr const char* kPullWords[] = {"pull", "handle", "crown", "head", "top", "tip", "mantle"};
/// A group of more than this share of the points is no end of the body.
constexpr double kMostOfABody = 0.4;

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

StarterSelection of_groups(const std::vector<std::string>& names, const SurfaceMesh& surface) {
  StarterSelection selection;
  for (const std::string& name : names) selection.select.terms.push_back({SelectGroup{name}, SelectionUnit::Meter});
  selection.words = fmt::format("the group{} {}", names.size() > 1 ? "s" : "", fmt::join(names, ", "));
  selection.points = select_points(selection.select, surface).size();
  return selection;
}

StarterSelection of_named_groups(const char* option, const std::vector<std::string>& names,
                                 const SurfaceMesh& surface) {
  std::vector<std::string> known;
  for (const VertexGroup& group : surface.groups) known.push_back(group.name);
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string nearest = nearest_name(name, known);
    throw input_error(
        fmt::format("{} {}: the mesh has no group of this name.\n  Accepted: {}.{}", option, name,
                    known.empty() ? "nothing, for it has no groups" : fmt::format("{}", fmt::join(known, ", ")),
                    nearest.empty() ? "" : fmt::format(" Did you mean {}?", nearest)));
  }
  StarterSelection selection = of_groups(names, surface);
  if (selection.points == 0)
    throw input_error(
        fmt::format("{} {}: no triangle of the mesh uses a vertex of it.\n  Accepted: a group that is "
                    "part of the surface.",
                    option, fmt::join(names, ", ")));
  return selection;
}

/// The groups of the first word that some have in their names; empty if there are none, or they are most of the body.
template <std::size_t N>
std::vector<std::string> telling_groups(const SurfaceMesh& surface, const char* const (&words)[N]) {
  for (const char* word : words) {
    std::vector<std::string> names;
    for (const VertexGroup& group : surface.groups)
      if (lower_case(group.name).find(word) != std::string::npos) names.push_back(group.name);
    if (names.empty()) continue;
    const double share = static_cast<double>(of_groups(names, surface).points) /
                         static_cast<double>(std::max<std::size_t>(1, surface.positions.size()));
    if (share > 0 && share < kMostOfABody) return names;
  }
  return {};
}

StarterSelection of_end(const SurfaceMesh& surface, int axis, double from, double to, const std::string& words) {
  StarterSelection selection;
  SelectBox box{Vec3::Zero(), Vec3::Ones()};
  box.min[axis] = from;
  box.max[axis] = to;
  selection.select.terms.push_back({box, SelectionUnit::Box});
  selection.words = words;
  selection.points = select_points(selection.select, surface).size();
  return selection;
}

}  // namespace

bool spans_an_area(const std::vector<Index>& points, const SurfaceMesh& surface) {
  if (points.size() < 3) return false;
  const auto at = [&](std::size_t i) -> const Vec3& { return surface.positions[static_cast<std::size_t>(points[i])]; };
  std::size_t farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if ((at(i) - at(0)).norm() > (at(farthest) - at(0)).norm()) farthest = i;
  const Vec3 along = at(farthest) - at(0);
  const double least = 1e-3 * used_bounds(surface).diagonal();
  if (along.norm() < least) return false;
  return std::any_of(points.begin(), points.end(), [&](Index p) {
    return along.normalized().cross(surface.positions[static_cast<std::size_t>(p)] - at(0)).norm() > least;
  });
}

namespace {

/// The end of the body at 0 or 1 of its box along an axis: as little as spans an area, or takes a point at all.
StarterSelection choose_end(const SurfaceMesh& surface, int axis, bool far_end, double least) {
  static constexpr const char* kNear[] = {"left end", "lowest", "back end"};
  static constexpr const char* kFar[] = {"right end", "highest", "front end"};
  StarterSelection last;
  for (const double share : {0.05, 0.1, 0.15, 0.2, 0.3, 0.45}) {
    if (share < least) continue;
    const std::string part = far_end ? kFar[axis] : kNear[axis];
    const std::string words = axis == 1 ? fmt::format("the {} {:.0f} %", part, 100 * share)
                                        : fmt::format("{:.0f} % at the {}", 100 * share, part);
    last = of_end(surface, axis, far_end ? 1 - share : 0, far_end ? 1 : share, words);
    if (far_end ? last.points > 0 : spans_an_area(select_points(last.select, surface), surface)) return last;
  }
  return last;
}

bool overlap(const StarterSelection& a, const StarterSelection& b, const SurfaceMesh& surface) {
  const std::vector<Index> one = select_points(a.select, surface), other = select_points(b.select, surface);
  std::vector<Index> both;
  std::set_intersection(one.begin(), one.end(), other.begin(), other.end(), std::back_inserter(both));
  return !both.empty();
}

}  // namespace

void choose_selections(const SurfaceMesh& surface, const StarterWishes& wishes, StarterBody& body) {
  const Vec3 size = used_bounds(surface).size();
  const int axis = body.stands ? 1 : size.x() >= size.z() ? 0 : 2;
  const std::vector<std::string> hold = telling_groups(surface, kHoldWords), pull = telling_groups(surface, kPullWords);
  if (!wishes.pin_groups.empty())
    body.held = of_named_groups("--pin", wishes.pin_groups, surface);
  else if (!hold.empty())
    body.held = of_groups(hold, surface);
  else
    body.held = choose_end(surface, axis, false, 0.05);
  if (!wishes.pull_groups.empty())
    body.pulled = of_named_groups("--pull", wishes.pull_groups, surface);
  else if (!pull.empty() && !overlap(body.held, of_groups(pull, surface), surface))
    body.pulled = of_groups(pull, surface);
  else
    body.pulled = choose_end(surface, axis, true, body.stands ? 0.15 : 0.1);
}

}  // namespace softreel
