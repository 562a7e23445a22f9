/// The numbers of a PLY body one after the other, from text or from binary data of either byte order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "core/mesh/readers/ply_header.h"
#include "core/mesh/readers/text_scanner.h"

namespace softreel::detail {

static_assert(std::endian::native == std::endian::little, "bytes are swapped for big-endian files only");

inline Error cut_off(const MeshSource& source, const std::string& place) {
  return broken_file(source, place, "the file ends before its data do", "as much data as its header announces",
                     "Export the mesh again; the file may be cut off");
}

/// Words of a text body. The types do not matter: a number is what the text says, in double.
class PlyTextValues {
 public:
  PlyTextValues(const MeshSource& source, const PlyHeader& header)
      : source_(source), rest_(header.body), line_(header.lines + 1) {}

  double next(PlyType) {
    while (!rest_.empty() && is_blank(rest_.front())) {
      if (rest_.front() == '\n') ++line_;
      rest_.remove_prefix(1);
    }
    const std::string_view word = take_word(rest_);
    if (word.empty()) throw cut_off(source_, place());
    double value = 0;
    if (!parse_number(word, value))
      throw broken_file(source_, place(), fmt::format("'{}' is not a number", word.substr(0, 20)),
                        "numbers, in the order of the header's properties", "Mend the line or export the mesh again");
    return value;
  }

  std::size_t bytes_left() const { return rest_.size(); }
  std::string place() const { return at_line(line_); }

 private:
  const MeshSource& source_;
  std::string_view rest_;
  std::int64_t line_;
};

/// Values of a binary body.
template <bool kSwapped>
class PlyBinaryValues {
 public:
  PlyBinaryValues(const MeshSource& source, const PlyHeader& header) : source_(source), rest_(header.body) {}

  double next(PlyType type) {
    switch (type) {
      case PlyType::Int8:
        return take<std::int8_t>();
      case PlyType::UInt8:
        return take<std::uint8_t>();
      case PlyType::Int16:
        return take<std::int16_t>();
      case PlyType::UInt16:
        return take<std::uint16_t>();
      case PlyType::Int32:
        return take<std::int32_t>();
      case PlyType::UInt32:
        return take<std::uint32_t>();
      case PlyType::Float32:
        return double{take<float>()};
      case PlyType::Float64:
        return take<double>();
    }
    return std::numeric_limits<double>::quiet_NaN();  // all types are above
  }

  std::size_t bytes_left() const { return rest_.size(); }
  std::string place() const { return fmt::format(" (byte {})", source_.bytes.size() - rest_.size()); }

 private:
  template <typename T>
  T take() {
    if (rest_.size() < sizeof(T)) throw cut_off(source_, place());
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), rest_.data(), sizeof(T));
    if constexpr (kSwapped) std::reverse(bytes.begin(), bytes.end());
    rest_.remove_prefix(sizeof(T));
    return std::bit_cast<T>(bytes);
  }

  const MeshSource& source_;
  std::string_view rest_;
};

}  // namespace softreel::detail
