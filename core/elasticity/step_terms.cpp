#include "core/elasticity/step_terms.h"

namespace softreel {
namespace {

constexpr std::int64_t kSlopeGrain = 1024;

}  // namespace

void take_step_slopes(const ElasticBody& body, const StepSource& source, StiffnessTerms& terms,
                      const Threads& threads) {
  if (!source.secant_at_limit) return;
  const auto chunk = [&](std::int64_t begin, std::int64_t end) {
    double different = 0;
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
      const ElasticLaw& law = body.laws[e];
      const Mat3 F = deformation_gradient(body.shapes[e].gradients, nodes_of(body.tets[e], source.positions));
      const double trace = corotated_strain(source.rotations[e].toRotationMatrix(), F).trace();
      terms.ratios[e] =
          step_pressure_slope(law, trace, true, source.seconds.position, source.damping_stiffness[e]) / law.mu;
      if (terms.ratios[e] != body.laws[0].lambda / body.laws[0].mu) ++different;
    }
    return different;
  };
  terms.uniform_ratio = threads.sum_chunks(static_cast<std::int64_t>(terms.ratios.size()), kSlopeGrain, chunk) == 0;
}

void find_step_terms(const ElasticBody& body, const StepSource& source, StepTerms& terms, const Threads& threads) {
  const std::span<const ElementBatch> batches = body.batches;
  terms.gradients.resize(16 * kElementLanes * batches.size());
  terms.curvatures.resize(body.node_slabs.slab_offsets.size() - 1);
  terms.changed.resize(body.node_slabs.slab_offsets.size() - 1, 1);
  terms.forces.resize(4 * body.node_slabs.sums());
  const float expected = batches.empty() ? 0.0F : static_cast<float>(batches[0].lambda[0] / batches[0].mu[0]);
  const auto slabs = static_cast<std::int64_t>(terms.changed.size());
  const double different = threads.sum_chunks(slabs, 1, [&](std::int64_t slab, std::int64_t) {
    return static_cast<double>(find_step_slab(body, source, expected, terms, static_cast<std::size_t>(slab)));
  });
  terms.uniform_ratio = different == 0;
}

void gather_step_forces(const ElasticBody& body, const StepTerms& terms, std::span<Vec3> forces,
                        const Threads& threads) {
  add_slabs(body.node_slabs, terms.forces, forces, threads);
}

}  // namespace softreel
