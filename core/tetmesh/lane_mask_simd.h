/// Which of eight numbers are small enough, as bits: without it their loop is branches that no processor foresees.
#pragma once

#include <immintrin.h>

namespace softreel {

/// Bit k of the result: values[k] <= limit; not where either is not a number. values: eight, aligned to 32 bytes.
inline unsigned lanes_within(const float* values, float limit) {
  return static_cast<unsigned>(
      _mm256_movemask_ps(_mm256_cmp_ps(_mm256_load_ps(values), _mm256_set1_ps(limit), _CMP_LE_OQ)));
}

}  // namespace softreel
