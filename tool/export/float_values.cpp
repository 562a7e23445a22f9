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

}  // namespace softreel
