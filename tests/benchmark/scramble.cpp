/// How often a body comes back to its rest shape after its nodes were thrown about, with recovery and without.
///
/// scramble [SEEDS [STEPS [CUBES_ACROSS]]] prints tab-separated values. Default: 50 seeds, at most 400 steps of 1/24 s,
/// a free box of 4 x 3 x 3 cubes of BCC tetrahedra. A body came back if a rigid motion carries its rest shape to within
/// 1e-3 of its size; "steps" is the mean and the most of those that did.
#include <algorithm>
#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "tests/support/scrambled.h"

namespace softreel {
namespace {

void run(int seeds, int steps, Index across) {
  fmt::print("start\trotation\trecovery\tseeds\tcame back\tmean steps\tmost steps\tmost elements shared\n");
  for (const testing::Scramble& scramble : testing::scrambles())
    for (const auto& [name, rotation] : {std::pair{"consistent", RotationMethod::Consistent},
                                         {"energy", RotationMethod::Energy},
                                         {"polar_smooth", RotationMethod::PolarSmooth},
                                         {"qr", RotationMethod::Qr}})
      for (const bool recovery : {false, true}) {
        int back = 0, sum = 0, most = 0;
        Index elements = 0;
        for (int seed = 1; seed <= seeds; ++seed) {
          const testing::Release release =
              testing::release(testing::scramble_model(across), scramble, rotation, recovery, seed, steps);
          elements = std::max(elements, release.most_elements);
          if (!release.came_back) continue;
          ++back;
          sum += release.steps;
          most = std::max(most, release.steps);
        }
        fmt::print("{}\t{}\t{}\t{}\t{}\t{:.1f}\t{}\t{}\n", scramble.name, name, recovery ? "on" : "off", seeds, back,
                   back > 0 ? static_cast<double>(sum) / back : 0.0, most, elements);
        std::fflush(stdout);
      }
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  const auto argument = [&](int k, int otherwise) { return argc > k ? std::atoi(argv[k]) : otherwise; };
  softreel::run(argument(1, 50), argument(2, 400), argument(3, 3));
}
