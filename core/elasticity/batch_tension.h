/// What tension above the limit adds to the elements of a batch; for the kernel of a step only.
#pragma once

#include <cstddef>

#include "core/elasticity/element_lanes.h"
#include "core/elasticity/step_terms.h"

namespace softreel {

/// By lanes.
struct alignas(32) BatchTension {
  double moment[3][kElementLanes];     ///< w, Pa s: t times the stress in the frame of the rest shape gains [w]x
  double curvature[6][kElementLanes];  ///< C of find_tension_curvatures by its upper triangle, 00 01 02 11 12 22
};

/// Of the batch that starts at element `first`. Apart from the kernel, so that batches without tension, nearly all,
/// keep what they have in registers.
BatchTension find_batch_tension(const StepSource& source, const ElementBatch& batch, std::size_t first);

}  // namespace softreel
