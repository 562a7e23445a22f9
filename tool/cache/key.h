/// Keys of results: the hash of everything a result depends on, and of nothing else (design sec. 1).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// 128 bits as 32 hexadecimal digits.
using StageKey = std::string;

/// Collects values into a key (XXH3, 128 bits). Order matters; -0.0 counts as 0.0, so that an edit which changes no
/// value changes no key.
class KeyHasher {
 public:
  /// domain: what is hashed, with its format version, for example "tetrahedra 1".
  explicit KeyHasher(std::string_view domain);

  KeyHasher& add(std::string_view text);
  KeyHasher& add(const char* text) { return add(std::string_view(text)); }
  KeyHasher& add(double value);
  KeyHasher& add(const Vec3& value);
  KeyHasher& add(const Vec3f& value);
  template <typename T>
  requires std::is_integral_v<T> || std::is_enum_v<T> KeyHasher& add(T value) {
    return add_integer(static_cast<std::int64_t>(value));
  }
  template <typename T>
  KeyHasher& add(const std::vector<T>& values) {
    add(values.size());
    if constexpr (std::is_integral_v<T>) {
      add_bytes(values.data(), values.size() * sizeof(T));
    } else {
      for (const T& value : values) add(value);
    }
    return *this;
  }
  template <typename T, std::size_t N>
  KeyHasher& add(const std::array<T, N>& values) {
    for (const T& value : values) add(value);
    return *this;
  }

  StageKey key() const;

 private:
  KeyHasher& add_integer(std::int64_t value);
  void add_bytes(const void* data, std::size_t size);

  std::vector<std::uint8_t> bytes_;
};

/// XXH3-128 of raw bytes, for checksums of files.
StageKey hash_bytes(std::span<const std::uint8_t> bytes);

}  // namespace softreel
