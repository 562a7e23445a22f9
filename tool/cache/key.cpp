#include "tool/cache/key.h"

#include <cstring>

#include <fmt/format.h>
#include <xxhash.h>

namespace softreel {

KeyHasher::KeyHasher(std::string_view domain) {
  add(domain);
}

void KeyHasher::add_bytes(const void* data, std::size_t size) {
  if (size == 0) return;
  const std::size_t at = bytes_.size();
  bytes_.resize(at + size);
  std::memcpy(bytes_.data() + at, data, size);
}

KeyHasher& KeyHasher::add_integer(std::int64_t value) {
  add_bytes(&value, sizeof value);
  return *this;
}

KeyHasher& KeyHasher::add(std::string_view text) {
  add_integer(static_cast<std::int64_t>(text.size()));
  add_bytes(text.data(), text.size());
  return *this;
}

KeyHasher& KeyHasher::add(double value) {
  const double same_zero = value == 0 ? 0.0 : value;
  add_bytes(&same_zero, sizeof same_zero);
  return *this;
}

KeyHasher& KeyHasher::add(const Vec3& value) {
  return add(value.x()).add(value.y()).add(value.z());
}

KeyHasher& KeyHasher::add(const Vec3f& value) {
  return add(Vec3(value.cast<double>()));
}

StageKey KeyHasher::key() const {
  return hash_bytes(bytes_);
}

StageKey hash_bytes(std::span<const std::uint8_t> bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace softreel
