#include "tests/tool/export/readers/point_cache_reader.h"

#include <bit>
#include <cstdint>
#include <stdexcept>

namespace softreel::testing {
namespace {

class Bytes {
 public:
  Bytes(const std::string& text, bool big_endian) : text_(text), big_endian_(big_endian) {}

  std::string text(std::size_t count) {
    if (text_.size() - at_ < count) throw std::runtime_error("the file is too short");
    at_ += count;
    return text_.substr(at_ - count, count);
  }
  std::uint32_t word() {
    const std::string four = text(4);
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) {
      const auto byte = static_cast<std::uint8_t>(four[static_cast<std::size_t>(i)]);
      value |= std::uint32_t{byte} << (8 * (big_endian_ ? 3 - i : i));
    }
    return value;
  }
  int integer() { return static_cast<int>(word()); }
  float number() { return std::bit_cast<float>(word()); }
  std::vector<float> numbers(int count) {
    std::vector<float> values;
    for (int i = 0; i < count; ++i) values.push_back(number());
    return values;
  }
  void require_end() const {
    if (at_ != text_.size()) throw std::runtime_error("the file is too long");
  }

 private:
  const std::string& text_;
  bool big_endian_;
  std::size_t at_ = 0;
};

}  // namespace

PointCache read_pc2(const std::string& text) {
  Bytes bytes(text, false);
  PointCache cache;
  if (bytes.text(12) != std::string("POINTCACHE2\0", 12)) throw std::runtime_error("no PC2 signature");
  if (bytes.integer() != 1) throw std::runtime_error("not version 1");
  cache.points = bytes.integer();
  cache.start_frame = bytes.number();
  cache.frames_apart = bytes.number();
  const int samples = bytes.integer();
  for (int s = 0; s < samples; ++s) cache.samples.push_back(bytes.numbers(3 * cache.points));
  bytes.require_end();
  return cache;
}

PointCache read_mdd(const std::string& text) {
  Bytes bytes(text, true);
  PointCache cache;
  const int samples = bytes.integer();
  cache.points = bytes.integer();
  cache.times = bytes.numbers(samples);
  for (int s = 0; s < samples; ++s) cache.samples.push_back(bytes.numbers(3 * cache.points));
  bytes.require_end();
  return cache;
}

}  // namespace softreel::testing
