/// A number that stands for the bits of other numbers, to tell whether they changed; not for hostile input.
#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "core/base/types.h"

namespace softreel {

/// FNV-1a over words of 64 bits, their halves mixed (Fowler, Noll, Vo 1991).
class Fingerprint {
 public:
  Fingerprint& add(std::uint64_t word) {
    value_ = (value_ ^ word) * 0x100000001b3ULL;
    value_ ^= value_ >> 32U;
    return *this;
  }
  Fingerprint& add(double number) { return add(std::bit_cast<std::uint64_t>(number)); }
  Fingerprint& add(const Vec3& v) { return add(v.x()).add(v.y()).add(v.z()); }
  Fingerprint& add(const Mat3& m) {
    for (int k = 0; k < 9; ++k) add(m(k / 3, k % 3));
    return *this;
  }
  Fingerprint& add(Index index) { return add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(index))); }
  Fingerprint& add(const Triangle& triangle) { return add(triangle[0]).add(triangle[1]).add(triangle[2]); }
  template <typename T>
  Fingerprint& add(std::span<const T> values) {
    add(std::uint64_t{values.size()});
    for (const T& value : values) add(value);
    return *this;
  }

  std::uint64_t value() const { return value_; }
  /// The same as two numbers that a double holds exactly.
  double high() const { return static_cast<double>(value_ >> 32U); }
  double low() const { return static_cast<double>(value_ & 0xffffffffULL); }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace softreel
