#include "tool/stages/glue_facts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

const LoadedBody& find_loaded(const ShotRun& run, const std::string& name) {
  std::size_t b = 0;
  while (run.settings(b).name != name) ++b;  // the shot was checked when it was read
  return run.loaded(b);
}

}  // namespace

std::vector<std::string> glue_facts(const ShotRun& run) {
  std::vector<std::string> lines;
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
    lines.push_back(fmt::format("{} ({}): {} points of {}, at rest the nearest is {:.4g} m from {}", field,
                                to_string(glue.origin), points.size(), glue.bodies[0], std::sqrt(nearest),
                                glue.bodies[1]));
  }
  return lines;
}

}  // namespace softreel
