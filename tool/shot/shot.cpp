#include "tool/shot/shot.h"

#include <cmath>

#include <fmt/format.h>

namespace softreel {

std::string to_string(const Origin& origin) {
  if (origin.line == 0) return origin.file;
  const std::string place = fmt::format("{}:{}:{}", origin.file, origin.line, origin.column);
  return origin.changed_by.empty() ? place : fmt::format("{} with {}", place, origin.changed_by);
}

PixelWindow window_of(const RenderSettings& render) {
  if (render.crop == Vec4(0, 0, 1, 1) && render.overscan == 0) return {};
  const auto pixel = [](double share, int size) { return static_cast<int>(std::lround(share * size)); };
  const int width = render.params.width, height = render.params.height;
  const int more_x = pixel(render.overscan, width), more_y = pixel(render.overscan, height);
  return {pixel(render.crop[0], width) - more_x, pixel(render.crop[1], height) - more_y,
          pixel(render.crop[2], width) + more_x, pixel(render.crop[3], height) + more_y};
}

SolverParams solver_of(const Shot& shot, const BodySettings& body) {
  SolverParams solver = shot.solver;
  solver.rotation = body.rotation.value_or(solver.rotation);
  return solver;
}

}  // namespace softreel
