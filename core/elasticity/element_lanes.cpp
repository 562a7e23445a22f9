#include "core/elasticity/element_lanes.h"

#include <algorithm>
#include <limits>

namespace softreel {

std::vector<ElementBatch> make_element_batches(const std::vector<Tet>& tets, const std::vector<ElementShape>& shapes,
                                               const std::vector<ElasticLaw>& laws) {
  std::vector<ElementBatch> batches((tets.size() + kElementLanes - 1) / kElementLanes);
  for (std::size_t b = 0; b < batches.size(); ++b)
    for (std::size_t lane = 0; lane < kElementLanes; ++lane) {
      ElementBatch& batch = batches[b];
      const std::size_t e = std::min(kElementLanes * b + lane, tets.size() - 1);
      for (int k = 0; k < 3; ++k)
        for (int c = 0; c < 3; ++c) batch.gradients[3 * k + c][lane] = shapes[e].gradients(c, k + 1);
      batch.volume[lane] = shapes[e].volume;
      batch.lambda[lane] = laws[e].lambda;
      batch.mu[lane] = laws[e].mu;
      batch.pressure_limit[lane] = laws[e].capped ? laws[e].pressure_limit() : std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < 4; ++k) batch.nodes[k][lane] = tets[e][k];
    }
  return batches;
}

}  // namespace softreel
