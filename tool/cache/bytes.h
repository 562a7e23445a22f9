/// Plain values to bytes and back, for cache files. Little-endian, as all supported machines are.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "core/base/error.h"

namespace softreel {

class ByteWriter {
 public:
  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { put_raw(&value, sizeof(T)); }
  /// Length and raw elements; T must have no padding that could carry old bits.
  template <typename T>
  void put_array(const std::vector<T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    put_raw(values.data(), values.size() * sizeof(T));
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  void put_raw(const void* data, std::size_t size) {
    if (size == 0) return;
    const std::size_t at = bytes_.size();
    bytes_.resize(at + size);
    std::memcpy(bytes_.data() + at, data, size);
  }
  std::vector<std::uint8_t> bytes_;
};

/// Throws work_error if the bytes end too early (a checksum has matched, so this is a mistake of format).
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <typename T>
  requires std::is_trivially_copyable_v<T> T get() {
    T value;
    get_raw(&value, sizeof(T));
    return value;
  }
  bool at_end() const { return bytes_.empty(); }
  template <typename T>
  std::vector<T> get_array() {
    const auto size = get<std::uint64_t>();
    if (size > bytes_.size() / sizeof(T)) throw work_error("a cache file ends too early");
    std::vector<T> values(size);
    get_raw(values.data(), size * sizeof(T));
    return values;
  }

 private:
  void get_raw(void* data, std::size_t size) {
    if (size > bytes_.size()) throw work_error("a cache file ends too early");
    if (size > 0) std::memcpy(data, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }
  std::span<const std::uint8_t> bytes_;
};

}  // namespace softreel
