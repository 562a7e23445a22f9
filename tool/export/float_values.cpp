#include "tool/export/float_values.h"

#include <cmath>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {

void append_floats(const std::string& where, std::span<const Vec3> values, std::vector<float>& floats) {
  const std::size_t begin = floats.size();
  floats.resize(begin + 3 * values.size());
  float* out = floats.data() + begin;
  for (std::size_t v = 0; v < values.size(); ++v)
    for (int k = 0; k < 3; ++k) {
      *out = static_cast<float>(values[v][k]);
      if (!std::isfinite(*out++))
        throw work_error(
            fmt::format("{}: vertex {} has the coordinate {}, which is no finite float32.\n"
                        "  Accepted: finite positions. Look for a vertex in the mesh file or a step of the simulation "
                        "that is not finite, or export OBJ or PLY.",
                        where, v + 1, values[v][k]));
    }
}

void require_texture_coordinates(const std::string& where, const SurfaceMesh& mesh, double most) {
  for (std::size_t k = 0; k < mesh.texture_coordinates.size(); ++k) {
    const Vec2& at = mesh.texture_coordinates[k];
    if (std::abs(at.x()) <= most && std::abs(at.y()) <= most) continue;
    throw work_error(
        fmt::format("{}: texture coordinate {} of the mesh file is ({}, {}), which its numbers cannot say.\n"
                    "  Accepted: finite numbers. Unwrap the mesh again in the program that made it.",
                    where, k + 1, at.x(), at.y()));
  }
}

float seconds_of(const SampleTimes& times, int sample, double fps) {
  return static_cast<float>(times.frame(sample) / fps);
}

void require_float_times(const char* format, const SampleTimes& times, double fps) {
  for (int sample = 0; sample < times.count; ++sample) {
    const float seconds = seconds_of(times, sample, fps);
    if (!std::isfinite(seconds))
      throw input_error(
          fmt::format("{}: frame {} at {} frames a second is at no time that float32 can say.\n"
                      "  Accepted: times below 3.4e38 s. Use a larger --fps.",
                      format, times.frame(sample), fps));
    if (sample > 0 && !(seconds > seconds_of(times, sample - 1, fps)))
      throw input_error(
          fmt::format("{}: frames {} and {} are both at {} s, as its times are float32.\n"
                      "  Accepted: samples that differ there. Use fewer --subframes, a smaller --fps, or usda.",
                      format, times.frame(sample - 1), times.frame(sample), seconds));
  }
}

}  // namespace softreel
