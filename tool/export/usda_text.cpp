#include "tool/export/usda_text.h"

#include <algorithm>
#include <iterator>

#include <fmt/compile.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace softreel {
namespace {

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Corners without a texture coordinate get one more, (0, 0), behind those of the file.
std::string texture_lines(const SurfaceMesh& mesh, const std::string& indent) {
  if (mesh.polygons.corner_textures.empty()) return "";
  std::vector<float> values;
  for (const Vec2& at : mesh.texture_coordinates)
    values.insert(values.end(), {static_cast<float>(at.x()), static_cast<float>(at.y())});
  std::vector<Index> indices = mesh.polygons.corner_textures;
  const auto none = static_cast<Index>(mesh.texture_coordinates.size());
  if (std::count(indices.begin(), indices.end(), -1) > 0) values.insert(values.end(), {0, 0});
  std::replace(indices.begin(), indices.end(), -1, none);
  return fmt::format(
      "{0}texCoord2f[] primvars:st = {1} (\n{0}    interpolation = \"faceVarying\"\n{0})\n"
      "{0}int[] primvars:st:indices = {2}\n",
      indent, usda_vectors(values, 2), usda_integers(indices));
}

std::string subset(const std::string& name, const VertexGroup& group, const char* element,
                   std::span<const Index> members, const std::string& indent) {
  return fmt::format(
      "\n{0}def GeomSubset \"{1}\"\n{0}{{\n{0}    uniform token elementType = \"{2}\"\n"
      "{0}    uniform token familyName = \"group\"\n{0}    int[] indices = {3}\n"
      "{0}    custom string softreel:name = {4}\n{0}}}\n",
      indent, name, element, usda_integers(members), usda_quoted(group.name));
}

}  // namespace

std::string UsdaNames::unique(const std::string& name) {
  std::string valid;
  for (const char c : name) valid += is_letter(c) || is_digit(c) ? c : '_';
  if (valid.empty() || is_digit(valid[0])) valid.insert(0, "_");
  std::string result = valid;
  for (int n = 1; std::find(taken_.begin(), taken_.end(), result) != taken_.end(); ++n)
    result = fmt::format("{}_{}", valid, n);
  taken_.push_back(result);
  return result;
}

std::string usda_quoted(const std::string& text) {
  using Json = nlohmann::json;  // names of files may be of any bytes, a layer is UTF-8
  const std::string valid = Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace));
  std::string quoted = "\"";
  for (const char c : valid) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (c == '\n' || c == '\r')
      quoted += c == '\n' ? "\\n" : "\\r";
    else
      quoted += c;
  }
  return quoted + '"';
}

std::string usda_vectors(std::span<const float> values, std::size_t components) {
  fmt::memory_buffer text;
  text.reserve(12 * values.size() + 4);
  const auto out = std::back_inserter(text);
  text.push_back('[');
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool first = i % components == 0;
    fmt::format_to(out, FMT_COMPILE("{}{}"), first ? (i == 0 ? "(" : "), (") : ", ", values[i]);
  }
  fmt::format_to(out, FMT_COMPILE("{}"), values.empty() ? "]" : ")]");
  return fmt::to_string(text);
}

std::string usda_integers(std::span<const Index> values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}

std::string usda_matrix(const Placement& placement) {
  const Mat3 rows = placement.linear.transpose();
  std::string text = "( ";
  for (int r = 0; r < 3; ++r) text += fmt::format("({}, {}, {}, 0), ", rows(r, 0), rows(r, 1), rows(r, 2));
  return text + fmt::format("({}, {}, {}, 1) )", placement.offset.x(), placement.offset.y(), placement.offset.z());
}

std::string usda_topology(const SurfaceMesh& mesh, const std::string& indent) {
  const std::vector<Index>& offsets = mesh.polygons.offsets;
  std::vector<Index> counts;
  for (std::size_t p = 0; p + 1 < offsets.size(); ++p) counts.push_back(offsets[p + 1] - offsets[p]);
  return fmt::format(
      "{0}uniform bool doubleSided = 1\n{0}int[] faceVertexCounts = {1}\n"
      "{0}int[] faceVertexIndices = {2}\n{3}{0}uniform token subdivisionScheme = \"none\"\n",
      indent, usda_integers(counts), usda_integers(mesh.polygons.corner_vertices), texture_lines(mesh, indent));
}

std::string usda_groups(const SurfaceMesh& mesh, const std::string& indent) {
  std::vector<std::vector<Index>> faces(mesh.groups.size());
  const std::vector<Index>& of_polygon = mesh.polygons.polygon_groups;
  for (std::size_t p = 0; p < of_polygon.size(); ++p)
    if (of_polygon[p] >= 0) faces[static_cast<std::size_t>(of_polygon[p])].push_back(static_cast<Index>(p));
  const std::vector<Index>& materials = mesh.polygons.polygon_materials;
  for (std::size_t p = 0; p < materials.size(); ++p)
    if (materials[p] >= 0 && (of_polygon.empty() || of_polygon[p] != materials[p]))
      faces[static_cast<std::size_t>(materials[p])].push_back(static_cast<Index>(p));
  std::string text;
  UsdaNames names;
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    const VertexGroup& group = mesh.groups[g];
    if (faces[g].empty())
      text += subset(names.unique(group.name), group, "point", group.vertices, indent);
    else
      text += subset(names.unique(group.name), group, "face", faces[g], indent);
  }
  return text;
}

}  // namespace softreel
