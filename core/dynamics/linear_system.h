/// The sparse system of a step or of a Newton iteration with some nodes held.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/sparse/block_matrix.h"

namespace softreel {

/// product = matrix * x, rows in parallel.
void multiply(const BlockMatrixd& matrix, std::span<const Vec3> x, std::span<Vec3> product, const Threads& threads);

/// Zeroes rows and columns of held nodes; their diagonal becomes the mean diagonal of the others, so that the system
/// stays definite and as well scaled as before (design 4.5).
void eliminate_held(BlockMatrixd& matrix, std::span<const std::uint8_t> held, const Threads& threads);

}  // namespace softreel
