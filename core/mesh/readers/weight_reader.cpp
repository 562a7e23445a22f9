#include "core/mesh/readers/weight_reader.h"

#include <fmt/format.h>

#include "core/base/nearest_name.h"
#include "core/mesh/readers/ply_values.h"

namespace softreel {
namespace {

using namespace detail;

constexpr const char* kAccepted = "a number from 0 to 1 for each vertex";

void require_weight(const MeshSource& source, const std::string& place, double weight) {
  if (weight >= 0 && weight <= 1) return;
  throw broken_file(source, place, fmt::format("{} is no weight", weight), kAccepted, "Scale the weights");
}

std::vector<double> read_text(const MeshSource& source) {
  std::vector<double> weights;
  LineScanner lines(text_of(source));
  for (std::string_view line; lines.next(line);) {
    const std::string_view word = trimmed(line);
    if (word.empty() || word.front() == '#') continue;
    const std::string place = at_line(lines.line_number());
    double weight = 0;
    if (!parse_number(word, weight))
      throw broken_file(source, place, fmt::format("'{}' is not a number", word.substr(0, 40)),
                        std::string(kAccepted) + ", one a line", "Mend the line");
    require_weight(source, place, weight);
    weights.push_back(weight);
  }
  return weights;
}

/// Bytes and words of whole numbers count to their largest value, as colours do.
double full_value(PlyType type) {
  if (type == PlyType::UInt8) return 255;
  return type == PlyType::UInt16 ? 65535 : 1;
}

template <typename Values>
void skip(Values& values, const PlyProperty& property) {
  if (!property.is_list) {
    values.next(property.type);
    return;
  }
  const double count = values.next(property.count_type);
  for (double k = 0; k < count; ++k) values.next(property.type);
}

Error unknown_attribute(const MeshSource& source, const PlyElement& vertex, const std::string& attribute) {
  std::vector<std::string> names;
  std::string list;
  for (const PlyProperty& property : vertex.properties) {
    names.push_back(property.name);
    list += (list.empty() ? "" : ", ") + property.name;
  }
  const std::string nearest = nearest_name(attribute, names);
  return broken_file(source, "", fmt::format("its vertices have no number '{}'", attribute), list,
                     nearest.empty() ? "Name one of them as attribute" : fmt::format("Did you mean '{}'?", nearest));
}

template <typename Values>
std::vector<double> read_property(const MeshSource& source, const PlyHeader& header, const std::string& attribute) {
  Values values(source, header);
  for (const PlyElement& element : header.elements) {
    const bool is_vertex = element.name == "vertex";
    const auto wanted = [&](const PlyProperty& p) { return is_vertex && !p.is_list && p.name == attribute; };
    if (is_vertex && std::none_of(element.properties.begin(), element.properties.end(), wanted))
      throw unknown_attribute(source, element, attribute);
    std::vector<double> weights;
    for (std::int64_t row = 0; row < element.count && !element.properties.empty(); ++row)
      for (const PlyProperty& property : element.properties) {
        if (!wanted(property)) {
          skip(values, property);
          continue;
        }
        weights.push_back(values.next(property.type) / full_value(property.type));
        require_weight(source, values.place(), weights.back());
      }
    if (is_vertex) return weights;
  }
  throw broken_file(source, "", "it has no vertices", kAccepted, "Export the weights again");
}

std::vector<double> read_ply_property(const MeshSource& source, const std::string& attribute) {
  const PlyHeader header = read_ply_header(source);
  if (header.encoding == PlyEncoding::Text) return read_property<PlyTextValues>(source, header, attribute);
  if (header.encoding == PlyEncoding::LittleEndian)
    return read_property<PlyBinaryValues<false>>(source, header, attribute);
  return read_property<PlyBinaryValues<true>>(source, header, attribute);
}

}  // namespace

std::vector<double> read_weights(const std::string& path, const std::string& attribute) {
  const std::string bytes = read_mesh_file(path);
  const MeshSource source{path, bytes};
  if (lower_extension(path) != ".ply") return read_text(source);
  return read_ply_property(source, attribute.empty() ? "weight" : attribute);
}

}  // namespace softreel
