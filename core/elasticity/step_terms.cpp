#include "core/elasticity/step_terms.h"

namespace softreel {
namespace {

constexpr std::int64_t kBatchGrain = 256;
constexpr std::int64_t kNodeGrain = 512;

}  // namespace

void find_step_terms(const ElasticBody& body, const StepSource& source, StepTerms& terms, const Threads& threads) {
  const std::span<const ElementBatch> batches = body.batches;
  const std::size_t padded = kElementLanes * batches.size();
  terms.gradients.resize(16 * padded);
  terms.forces.resize(12 * padded + 1);
  const float expected = batches.empty() ? 0.0F : static_cast<float>(batches[0].lambda[0] / batches[0].mu[0]);
  const double different = threads.sum_chunks(
      static_cast<std::int64_t>(batches.size()), kBatchGrain, [&](std::int64_t begin, std::int64_t end) {
        return static_cast<double>(find_step_batches(batches, source, expected, terms, static_cast<std::size_t>(begin),
                                                     static_cast<std::size_t>(end)));
      });
  terms.uniform_ratio = different == 0;
}

void gather_step_forces(const NodeElements& node_elements, const StepTerms& terms, std::span<Vec3> forces,
                        const Threads& threads) {
  using Lanes = Eigen::Array4d;
  threads.for_chunks(static_cast<std::int64_t>(forces.size()), kNodeGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      Lanes sum = Lanes::Zero();
      for (std::int64_t k = node_elements.offsets[i]; k < node_elements.offsets[i + 1]; ++k)
        sum += Eigen::Map<const Lanes>(terms.forces.data() +
                                       std::size_t{3} * node_elements.entries[static_cast<std::size_t>(k)]);
      forces[i] = sum.head<3>();
    }
  });
}

}  // namespace softreel
