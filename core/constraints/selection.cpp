#include "core/constraints/selection.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/nearest_name.h"
#include "core/mesh/point_tree.h"

namespace softreel {
namespace {

using PointTest = std::function<bool(const Vec3&)>;

/// Scene position of a point in box coordinates; 0 and 1 give exactly the box's sides.
Vec3 from_box(const Bounds& box, const Vec3& p) {
  Vec3 scene;
  for (int k = 0; k < 3; ++k) scene[k] = std::lerp(box.min[k], box.max[k], p[k]);
  return scene;
}

Vec3 scene_point(const Vec3& p, SelectionUnit unit, const Bounds& box) {
  return unit == SelectionUnit::Box ? from_box(box, p) : p;
}

PointTest box_test(const SelectBox& shape, SelectionUnit unit, const Bounds& box) {
  const Vec3 min = scene_point(shape.min, unit, box), max = scene_point(shape.max, unit, box);
  return [min, max](const Vec3& p) { return (p.array() >= min.array()).all() && (p.array() <= max.array()).all(); };
}

PointTest sphere_test(const SelectSphere& shape, SelectionUnit unit, const Bounds& box) {
  const Vec3 center = scene_point(shape.center, unit, box);
  const double radius = unit == SelectionUnit::Box ? shape.radius * box.size().y() : shape.radius;
  return [center, radius](const Vec3& p) { return (p - center).norm() <= radius; };
}

/// In box coordinates the normal is one of the box's space, too: the plane keeps its points of the box, whatever the
/// body's proportions. Along an axis in which the body is flat all points are equal.
PointTest plane_test(const SelectPlane& shape, SelectionUnit unit, const Bounds& box) {
  const Vec3 point = scene_point(shape.point, unit, box);
  Vec3 normal = shape.normal;
  if (unit == SelectionUnit::Box)
    for (int k = 0; k < 3; ++k) normal[k] = box.size()[k] > 0 ? normal[k] / box.size()[k] : 0;
  return [point, normal](const Vec3& p) { return normal.dot(p - point) >= 0; };
}

/// The test that the shape's place in space decides; none for groups, nearest points and weights.
std::optional<PointTest> space_test(const SelectionTerm& term, const Bounds& box) {
  if (const auto* shape = std::get_if<SelectBox>(&term.shape)) return box_test(*shape, term.unit, box);
  if (const auto* shape = std::get_if<SelectSphere>(&term.shape)) return sphere_test(*shape, term.unit, box);
  if (const auto* shape = std::get_if<SelectPlane>(&term.shape)) return plane_test(*shape, term.unit, box);
  if (std::holds_alternative<SelectAll>(term.shape)) return [](const Vec3&) { return true; };
  return std::nullopt;
}

std::vector<Index> numbers_of_used(const SurfaceMesh& surface) {
  const std::vector<bool> used = used_vertices(surface);
  std::vector<Index> vertices;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v]) vertices.push_back(static_cast<Index>(v));
  return vertices;
}

Error unknown_group(const std::string& name, const SurfaceMesh& surface) {
  if (surface.groups.empty())
    return input_error(fmt::format(
        "the mesh has no vertex group '{}': it names none.\n  Accepted: a selection by place. Select by box, "
        "sphere or plane.",
        name));
  std::vector<std::string> names;
  std::string list;
  for (const VertexGroup& group : surface.groups) {
    names.push_back(group.name);
    list += (list.empty() ? "'" : ", '") + group.name + "'";
  }
  const std::string nearest = nearest_name(name, names);
  const std::string advice = nearest.empty() ? "Choose one of them, or select by box, sphere or plane"
                                             : fmt::format("Did you mean '{}'?", nearest);
  return input_error(fmt::format("the mesh has no vertex group '{}'.\n  Accepted: {}. {}", name, list, advice));
}

const VertexGroup& find_group(const std::string& name, const SurfaceMesh& surface) {
  for (const VertexGroup& group : surface.groups)
    if (group.name == name) return group;
  throw unknown_group(name, surface);
}

/// The `count` vertices nearest to the point; of equally near ones the lower indices.
std::vector<Index> nearest_vertices(const SelectNearest& shape, const Vec3& point, const SurfaceMesh& surface,
                                    std::vector<Index> vertices) {
  const auto distance = [&](Index v) { return (surface.positions[static_cast<std::size_t>(v)] - point).squaredNorm(); };
  const auto count =
      static_cast<std::ptrdiff_t>(std::min(vertices.size(), static_cast<std::size_t>(std::max<Index>(shape.count, 0))));
  std::partial_sort(vertices.begin(), vertices.begin() + count, vertices.end(), [&](Index a, Index b) {
    const double da = distance(a), db = distance(b);
    return da != db ? da < db : a < b;
  });
  vertices.resize(static_cast<std::size_t>(count));
  return vertices;
}

/// Marks the used vertices that one term takes.
void mark_term(const SelectionTerm& term, const SurfaceMesh& surface, std::span<const WeightMap> maps,
               const Bounds& box, const std::vector<Index>& used, std::vector<char>& marked) {
  if (const std::optional<PointTest> test = space_test(term, box)) {
    for (const Index v : used)
      if ((*test)(surface.positions[static_cast<std::size_t>(v)])) marked[static_cast<std::size_t>(v)] = 1;
  } else if (const auto* group = std::get_if<SelectGroup>(&term.shape)) {
    for (const Index v : find_group(group->name, surface).vertices) marked[static_cast<std::size_t>(v)] = 1;
  } else if (const auto* nearest = std::get_if<SelectNearest>(&term.shape)) {
    const Vec3 point = scene_point(nearest->point, term.unit, box);
    for (const Index v : nearest_vertices(*nearest, point, surface, used)) marked[static_cast<std::size_t>(v)] = 1;
  } else if (const auto* painted = std::get_if<SelectWeights>(&term.shape)) {
    const std::vector<double>& weights = weights_of(painted->source, maps);
    for (const Index v : used)
      if (weights[static_cast<std::size_t>(v)] >= painted->threshold) marked[static_cast<std::size_t>(v)] = 1;
  }
}

}  // namespace

const std::vector<double>& weights_of(const WeightSource& source, std::span<const WeightMap> maps) {
  const auto found = std::find_if(maps.begin(), maps.end(), [&](const WeightMap& map) { return map.source == source; });
  CHECK(found != maps.end());
  return found->weights;
}

std::vector<Index> select_points(const Selection& selection, const SurfaceMesh& surface,
                                 std::span<const WeightMap> maps) {
  const std::vector<Index> used = numbers_of_used(surface);
  const Bounds box = used_bounds(surface);
  std::vector<char> marked(surface.positions.size(), 0);
  for (const SelectionTerm& term : selection.terms) mark_term(term, surface, maps, box, used, marked);
  std::vector<Index> points;
  for (const Index v : used)
    if (marked[static_cast<std::size_t>(v)] != 0) points.push_back(v);
  return points;
}

std::vector<bool> contains(const Selection& selection, const SurfaceMesh& surface, const std::vector<Vec3>& points,
                           std::span<const WeightMap> maps) {
  const Bounds box = used_bounds(surface);
  std::vector<bool> inside(points.size(), false);
  Selection of_surface;  // groups, nearest points and weights
  for (const SelectionTerm& term : selection.terms) {
    const std::optional<PointTest> test = space_test(term, box);
    if (!test) {
      of_surface.terms.push_back(term);
      continue;
    }
    for (std::size_t i = 0; i < points.size(); ++i) inside[i] = inside[i] || (*test)(points[i]);
  }
  if (of_surface.terms.empty()) return inside;
  std::vector<char> is_member(surface.positions.size(), 0);
  for (const Index v : select_points(of_surface, surface, maps)) is_member[static_cast<std::size_t>(v)] = 1;
  const std::vector<Index> used = numbers_of_used(surface);
  std::vector<Vec3> used_positions;
  for (const Index v : used) used_positions.push_back(surface.positions[static_cast<std::size_t>(v)]);
  const PointTree tree(std::move(used_positions));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Index nearest = inside[i] ? -1 : tree.nearest(points[i]);
    if (nearest >= 0) inside[i] = is_member[static_cast<std::size_t>(used[static_cast<std::size_t>(nearest)])] != 0;
  }
  return inside;
}

}  // namespace softreel
