#include "tool/stages/glue_facts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/tetmesh/triangle_tree.h"
#include "tool/bodies/simulate_key.h"

namespace softreel {
namespace {

const LoadedBody& find_loaded(const ShotRun& run, const std::string& name) {
  std::size_t b = 0;
  while (run.settings(b).name != name) ++b;  // the shot was checked when it was read
  return run.loaded(b);
}

}  // namespace

GlueFacts glue_facts(const ShotRun& run) {
  GlueFacts facts;
  const std::vector<GlueSettings>& glues = run.shot().glues;
  for (std::size_t g = 0; g < glues.size(); ++g) {
    const GlueSettings& glue = glues[g];
    const std::string field = fmt::format("glue[{}]", g);
    const LoadedBody& body = find_loaded(run, glue.bodies[0]);
    const SurfaceMesh& surface = body.surface;
    const SurfaceMesh& other = find_loaded(run, glue.bodies[1]).surface;
    const std::vector<Index> points = select_or_fail(glue.select, body, glue.origin, field);
    const TriangleTree tree(other.positions, other.triangles);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Index point : points)
      nearest = std::min(nearest, tree.nearest(surface.positions[static_cast<std::size_t>(point)]).squared_distance);
    nearest = std::sqrt(nearest);
    facts.lines.push_back(fmt::format("{} ({}): {} points of {}, at rest the nearest is {:.4g} m from {}", field,
                                      to_string(glue.origin), points.size(), glue.bodies[0], nearest, glue.bodies[1]));
    if (nearest > glue.distance && is_active(glue.active, first_simulated_frame(run.shot())))
      facts.warnings.push_back(fmt::format(
          "{} ({}): it starts with the shot, at rest no selected point of {} is within distance = {:g} m, and where "
          "glue starts with nothing to stick the simulation ends. Move the bodies together, set a greater distance, or "
          "an active range that starts where they touch.",
          field, to_string(glue.origin), glue.bodies[0], glue.distance));
  }
  return facts;
}

}  // namespace softreel
