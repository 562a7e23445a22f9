/// The header of a PLY file: its encoding, elements and properties.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/readers/mesh_source.h"

namespace softreel::detail {

enum class PlyEncoding { Text, LittleEndian, BigEndian };
enum class PlyType { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::Float32;
  bool is_list = false;
  PlyType count_type = PlyType::UInt8;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::Text;
  std::vector<PlyElement> elements;
  std::int64_t lines = 0;  ///< of the header
  std::string_view body;   ///< what follows the header
};

/// Throws input_error with the line.
PlyHeader read_ply_header(const MeshSource& source);

/// Group names may hold any bytes, names in a PLY header no blanks: those, control bytes and '%' become %XX.
std::string encode_ply_name(const std::string& name);
std::string decode_ply_name(const std::string& name);

/// Vertex properties with this prefix are vertex groups: a vertex is a member where the value is not 0.
constexpr std::string_view kPlyGroupPrefix = "group_";

}  // namespace softreel::detail
