/// Four numbers in one register, and the same where they lie in an array: for kernels whose lanes are those of one row.
///
/// GNU vectors, for their shuffles, which std::experimental::simd does not have. Arrays of scalars are read and written
/// through the types that may alias them.
#pragma once

namespace softreel::detail {

typedef double FourDoubles __attribute__((vector_size(32)));
typedef float FourFloats __attribute__((vector_size(16)));

/// In an array, at a multiple of 32 bytes.
typedef double FourStoredDoubles __attribute__((vector_size(32), may_alias));

/// In an array, at any of its scalars.
typedef float FourFloatsAnywhere __attribute__((vector_size(16), aligned(4), may_alias));

/// Four one after the other, also in an array, there at a multiple of 16 bytes.
struct [[gnu::may_alias]] FourRows {
  FourFloats rows[4];
};

}  // namespace softreel::detail
