#include "core/mesh/readers/ply_header.h"

#include <array>

#include <fmt/format.h>

#include "core/mesh/readers/text_scanner.h"

namespace softreel::detail {
namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};

constexpr std::array<TypeName, 16> kTypeNames{{{"char", PlyType::Int8},
                                               {"int8", PlyType::Int8},
                                               {"uchar", PlyType::UInt8},
                                               {"uint8", PlyType::UInt8},
                                               {"short", PlyType::Int16},
                                               {"int16", PlyType::Int16},
                                               {"ushort", PlyType::UInt16},
                                               {"uint16", PlyType::UInt16},
                                               {"int", PlyType::Int32},
                                               {"int32", PlyType::Int32},
                                               {"uint", PlyType::UInt32},
                                               {"uint32", PlyType::UInt32},
                                               {"float", PlyType::Float32},
                                               {"float32", PlyType::Float32},
                                               {"double", PlyType::Float64},
                                               {"float64", PlyType::Float64}}};

class HeaderReader {
 public:
  explicit HeaderReader(const MeshSource& source) : source_(source), lines_(text_of(source)) {}

  PlyHeader read() {
    std::string_view line;
    if (!lines_.next(line) || trimmed(line) != "ply") throw broken("the first line is not 'ply'");
    bool has_format = false;
    while (lines_.next(line)) {
      std::string_view rest = line;
      const std::string_view keyword = take_word(rest);
      if (keyword == "end_header") {
        if (!has_format) throw broken("the header has no line 'format'");
        header_.lines = lines_.line_number();
        header_.body = lines_.rest();
        return std::move(header_);
      }
      if (keyword == "format") {
        read_format(take_word(rest));
        has_format = true;
      } else if (keyword == "element") {
        read_element(rest);
      } else if (keyword == "property") {
        read_property(rest);
      } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
        throw broken(fmt::format("the word '{}' has no meaning in the header", keyword.substr(0, 20)));
      }
    }
    throw broken("the header has no end");
  }

 private:
  void read_format(std::string_view name) {
    if (name == "ascii")
      header_.encoding = PlyEncoding::Text;
    else if (name == "binary_little_endian")
      header_.encoding = PlyEncoding::LittleEndian;
    else if (name == "binary_big_endian")
      header_.encoding = PlyEncoding::BigEndian;
    else
      throw broken(fmt::format("the format is '{}'", name));
  }

  void read_element(std::string_view rest) {
    PlyElement element;
    element.name = std::string(take_word(rest));
    const std::string_view count = take_word(rest);
    if (!parse_integer(count, element.count) || element.count < 0 || element.count > INT32_MAX)
      throw broken(fmt::format("element '{}' has the count '{}'", element.name, count));
    header_.elements.push_back(std::move(element));
  }

  void read_property(std::string_view rest) {
    if (header_.elements.empty()) throw broken("a property stands before the first element");
    PlyProperty property;
    std::string_view word = take_word(rest);
    if (word == "list") {
      property.is_list = true;
      property.count_type = type_of(take_word(rest));
      word = take_word(rest);
    }
    property.type = type_of(word);
    property.name = std::string(take_word(rest));
    header_.elements.back().properties.push_back(std::move(property));
  }

  PlyType type_of(std::string_view name) const {
    for (const TypeName& known : kTypeNames)
      if (known.name == name) return known.type;
    throw broken(fmt::format("a property has the type '{}'", name));
  }

  Error broken(const std::string& problem) const {
    return broken_file(source_, at_line(lines_.line_number()), problem,
                       "ply, format ascii or binary_little_endian or binary_big_endian, element NAME COUNT, "
                       "property [list TYPE] TYPE NAME, end_header",
                       "Check that the file is a PLY mesh, or export it again");
  }

  const MeshSource& source_;
  LineScanner lines_;
  PlyHeader header_;
};

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

PlyHeader read_ply_header(const MeshSource& source) {
  return HeaderReader(source).read();
}

std::string encode_ply_name(const std::string& name) {
  std::string encoded;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= ' ' || byte == 127 || c == '%')
      encoded += fmt::format("%{:02X}", byte);
    else
      encoded += c;
  }
  return encoded;
}

std::string decode_ply_name(const std::string& name) {
  std::string decoded;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool is_code =
        name[i] == '%' && i + 2 < name.size() && hex_value(name[i + 1]) >= 0 && hex_value(name[i + 2]) >= 0;
    decoded += is_code ? static_cast<char>(hex_value(name[i + 1]) * 16 + hex_value(name[i + 2])) : name[i];
    if (is_code) i += 2;
  }
  return decoded;
}

}  // namespace softreel::detail
