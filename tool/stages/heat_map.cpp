#include "tool/stages/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/elasticity/element_strain.h"
#include "core/skinning/skinning.h"
#include "tool/stages/shot_run.h"

namespace softreel {
namespace {

constexpr std::int64_t kGrain = 1024;
constexpr double kShareBelow = 0.99;
constexpr double kSmallestRange = 1e-6;

std::array<Vec3, 4> corners(const Tet& tet, const std::vector<Vec3>& nodes) {
  std::array<Vec3, 4> x;
  for (std::size_t k = 0; k < 4; ++k) x[k] = nodes[static_cast<std::size_t>(tet[k])];
  return x;
}

std::vector<double> element_values(HeatQuantity quantity, const HeatSource& source, const Threads& threads) {
  const TetMesh& mesh = source.filled.mesh;
  std::vector<double> values(mesh.tets.size());
  threads.for_chunks(static_cast<std::int64_t>(values.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
      const Mat3 F =
          deformation_gradient(corners(mesh.tets[e], mesh.nodes), corners(mesh.tets[e], source.node_positions));
      const Vec3 stretches = principal_stretches(F);
      values[e] = quantity == HeatQuantity::Strain ? largest_strain(stretches)
                                                   : von_mises_stress(stretches, source.materials[e]);
    }
  });
  return values;
}

double mean_displacement(const Tet& tet, const std::vector<Vec3>& rest, const std::vector<Vec3>& deformed) {
  double sum = 0;
  for (const Index node : tet)
    sum += (deformed[static_cast<std::size_t>(node)] - rest[static_cast<std::size_t>(node)]).norm();
  return 0.25 * sum;
}

/// A unit in which the range's end is a number of a few digits.
LegendUnit unit_of(HeatQuantity quantity, double size) {
  if (quantity == HeatQuantity::Strain) return {"%", 100};
  const auto step = [size](double limit) { return size >= 0.9999 * limit; };
  if (quantity == HeatQuantity::Stress)
    return step(1e9)   ? LegendUnit{"GPa", 1e-9}
           : step(1e6) ? LegendUnit{"MPa", 1e-6}
           : step(1e3) ? LegendUnit{"kPa", 1e-3}
                       : LegendUnit{"Pa", 1};
  return step(1) ? LegendUnit{"m", 1} : step(0.01) ? LegendUnit{"cm", 100} : LegendUnit{"mm", 1000};
}

}  // namespace

std::vector<double> heat_values(HeatQuantity quantity, const HeatSource& source, const Threads& threads) {
  CHECK(quantity != HeatQuantity::None);
  const FilledBody& filled = source.filled;
  if (quantity != HeatQuantity::Displacement)
    return skin_values(element_values(quantity, source, threads), filled.embedding, filled.mesh, threads);
  const std::vector<Vec3> points =
      skin_positions(source.rest_points, filled.embedding, filled.mesh, source.node_positions, threads);
  std::vector<double> distances(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) distances[i] = (points[i] - source.rest_points[i]).norm();
  return distances;
}

std::vector<double> element_heat_values(HeatQuantity quantity, const HeatSource& source, const Threads& threads) {
  CHECK(quantity != HeatQuantity::None);
  if (quantity != HeatQuantity::Displacement) return element_values(quantity, source, threads);
  const TetMesh& mesh = source.filled.mesh;
  std::vector<double> values;
  values.reserve(mesh.tets.size());
  for (const Tet& tet : mesh.tets) values.push_back(mean_displacement(tet, mesh.nodes, source.node_positions));
  return values;
}

double round_up(double x) {
  CHECK(x > 0);
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double step : {1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (step * power >= x * (1 - 1e-9)) return step * power;
  return 10 * power;
}

double upper_end(std::vector<double> values, const SurfaceMesh& surface) {
  CHECK(values.size() == surface.positions.size());
  const std::vector<bool> used = used_vertices(surface);
  std::size_t kept = 0;
  for (std::size_t v = 0; v < values.size(); ++v)
    if (used[v] && std::isfinite(values[v])) values[kept++] = values[v];
  values.resize(kept);
  if (values.empty()) return 0;
  const auto rank = static_cast<std::size_t>(kShareBelow * static_cast<double>(values.size() - 1));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

HeatRange find_heat_range(ShotRun& run, HeatQuantity quantity) {
  double most = kSmallestRange;
  const ShotSettings& settings = run.shot().settings;
  for (int frame = settings.first_frame; frame <= settings.last_frame; ++frame) {
    run.context().stop_if_cancelled();
    for (std::size_t b = 0; b < run.body_count(); ++b)
      most = std::max(most, upper_end(run.heat(b, frame, quantity), run.loaded(b).surface));
  }
  const HeatRange range{0, round_up(most)};
  run.context().log.info(fmt::format("heat: colours from 0 to {:.4g}, found in frames {} to {}", range.high,
                                     settings.first_frame, settings.last_frame));
  return range;
}

HeatLegend heat_legend(HeatQuantity quantity, const HeatRange& range) {
  const char* title = quantity == HeatQuantity::Strain   ? "Strain"
                      : quantity == HeatQuantity::Stress ? "Von Mises stress"
                                                         : "Displacement";
  return make_heat_legend(title, range.low, range.high,
                          unit_of(quantity, std::max(std::abs(range.low), std::abs(range.high))));
}

std::string small_legend_warning(const HeatRange& range, int width, int height) {
  return fmt::format(
      "The pictures, {} x {} pixels, have no room for the letters of the heat's legend, whose bar goes from {:.4g} to "
      "{:.4g} (SI units). Accepted: 160 x 120 pixels or more. Make them larger.",
      width, height, range.low, range.high);
}

}  // namespace softreel
