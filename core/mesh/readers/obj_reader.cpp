#include "core/mesh/readers/obj_reader.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "core/mesh/readers/text_scanner.h"
#include "core/mesh/readers/vertex_colors.h"

namespace softreel::detail {
namespace {

/// Polygons [first, last) that lie in one group.
struct GroupRange {
  Index group, first, last;
};

/// Vertex sets from polygon ranges, in the order in which the names came up.
void collect_groups(SurfaceMesh& mesh, const std::vector<GroupRange>& ranges) {
  std::vector<std::vector<const GroupRange*>> ranges_of(mesh.groups.size());
  for (const GroupRange& range : ranges) ranges_of[static_cast<std::size_t>(range.group)].push_back(&range);
  std::vector<std::size_t> seen(mesh.positions.size(), 0);
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    std::vector<Index>& vertices = mesh.groups[g].vertices;
    for (const GroupRange* range : ranges_of[g]) {
      const Index begin = mesh.polygons.offsets[static_cast<std::size_t>(range->first)];
      const Index end = mesh.polygons.offsets[static_cast<std::size_t>(range->last)];
      for (Index c = begin; c < end; ++c) {
        const Index v = mesh.polygons.corner_vertices[static_cast<std::size_t>(c)];
        if (std::exchange(seen[static_cast<std::size_t>(v)], g + 1) != g + 1) vertices.push_back(v);
      }
    }
    std::sort(vertices.begin(), vertices.end());
  }
}

class ObjReader {
 public:
  ObjReader(const MeshSource& source, const Log& log) : source_(source), log_(log), lines_(text_of(source)) {}

  SurfaceMesh read() {
    std::string_view line;
    while (next_statement(line)) read_statement(line);
    close_ranges();
    check_forward_references();
    if (!mesh_.colors.empty()) pad_colors(mesh_.colors, mesh_.positions.size());
    if (!has_textures_) mesh_.polygons.corner_textures.clear();
    if (mesh_.groups.empty()) mesh_.polygons.polygon_groups.clear();
    if (!has_materials_) mesh_.polygons.polygon_materials.clear();
    collect_groups(mesh_, ranges_);
    skipped_.report(source_, log_);
    return std::move(mesh_);
  }

 private:
  /// An index beyond what the file had so far; checked once the whole file is read.
  struct ForwardReference {
    Index value;
    bool is_texture;
    std::int64_t line;
  };

  bool next_statement(std::string_view& line) {
    if (!lines_.next(line)) return false;
    if (line.empty() || line.back() != '\\') return true;
    joined_.clear();
    while (!line.empty() && line.back() == '\\') {
      joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
      if (!lines_.next(line)) line = {};
    }
    joined_.append(line);
    line = joined_;
    return true;
  }

  void read_statement(std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (keyword == "v") {
      mesh_.positions.push_back(read_numbers<3>(line, "vertex"));
      read_color(line);
    } else if (keyword == "vt") {
      read_texture(line);
    } else if (keyword == "f" || keyword == "fo") {
      read_face(line);
    } else if (keyword == "g") {
      set_group_names(line);
    } else if (keyword == "o") {
      set_names(object_, trimmed(line));
    } else if (keyword == "usemtl") {
      set_names(material_, trimmed(line));
    }
  }

  template <int N>
  Eigen::Matrix<double, N, 1> read_numbers(std::string_view& rest, const char* what) const {
    Eigen::Matrix<double, N, 1> values;
    for (int k = 0; k < N; ++k) {
      const std::string_view word = take_word(rest);
      if (word.empty() || word[0] == '#')
        throw broken_file(source_, place(), fmt::format("a {} has {} coordinate(s)", what, k), fmt::format("{}", N),
                          "Export the mesh again; the file may be cut off");
      if (!parse_number(word, values[k]))
        throw broken_file(source_, place(), fmt::format("a {} has the coordinate '{}'", what, word),
                          "a decimal number such as -0.25 or 1e-3", "Mend the line or export the mesh again");
    }
    return values;
  }

  /// "v x y z r g b", a widespread extension; one number after z is a weight, and anything else is not for us.
  void read_color(std::string_view rest) {
    std::array<double, 3> c{};
    for (double& value : c)
      if (!parse_number(take_word(rest), value)) return;
    pad_colors(mesh_.colors, mesh_.positions.size() - 1);
    mesh_.colors.push_back(displayed_color(c[0], c[1], c[2]));
  }

  void read_texture(std::string_view rest) {
    std::string_view second = rest;
    take_word(second);
    second = take_word(second);
    if (second.empty() || second[0] == '#')  // "vt u" is a coordinate along a curve
      mesh_.texture_coordinates.emplace_back(read_numbers<1>(rest, "texture coordinate")[0], 0.0);
    else
      mesh_.texture_coordinates.push_back(read_numbers<2>(rest, "texture coordinate"));
  }

  void read_face(std::string_view rest) {
    PolygonList& polygons = mesh_.polygons;
    for (std::string_view word = take_word(rest); !word.empty() && word[0] != '#'; word = take_word(rest)) {
      const char* const end = word.data() + word.size();
      std::int64_t vertex = 0, texture = 0;
      auto parsed = std::from_chars(word.data(), end, vertex);
      bool valid = parsed.ec == std::errc() && (parsed.ptr == end || *parsed.ptr == '/');
      if (valid && end - parsed.ptr > 1 && parsed.ptr[1] != '/') {
        parsed = std::from_chars(parsed.ptr + 1, end, texture);
        valid = parsed.ec == std::errc() && (parsed.ptr == end || *parsed.ptr == '/') && texture != 0;
      }
      if (!valid)
        throw broken_file(source_, place(), fmt::format("a face has the corner '{}'", word),
                          "v, v/vt, v//vn or v/vt/vn with whole numbers", "Mend the line or export the mesh again");
      polygons.corner_vertices.push_back(resolve(vertex, mesh_.positions.size(), false));
      polygons.corner_textures.push_back(texture == 0 ? -1 : resolve(texture, mesh_.texture_coordinates.size(), true));
      has_textures_ = has_textures_ || texture != 0;
    }
    if (!close_polygon(polygons)) return skipped_.add(place());
    polygons.polygon_groups.push_back(main_group());
    polygons.polygon_materials.push_back(material_);
    has_materials_ = has_materials_ || material_ >= 0;
  }

  Index resolve(std::int64_t value, std::size_t count, bool is_texture) {
    const auto signed_count = static_cast<std::int64_t>(count);
    const std::int64_t index = value > 0 ? value - 1 : signed_count + value;
    if (value == 0 || index < 0 || index > INT32_MAX)
      throw bad_index(source_, place(), is_texture ? "texture coordinate" : "vertex", std::to_string(value), count);
    if (index >= signed_count) forward_.push_back({static_cast<Index>(index), is_texture, lines_.line_number()});
    return static_cast<Index>(index);
  }

  void check_forward_references() const {
    for (const ForwardReference& reference : forward_) {
      const std::size_t count = reference.is_texture ? mesh_.texture_coordinates.size() : mesh_.positions.size();
      if (static_cast<std::size_t>(reference.value) >= count)
        throw bad_index(source_, at_line(reference.line), reference.is_texture ? "texture coordinate" : "vertex",
                        std::to_string(std::int64_t{reference.value} + 1), count);
    }
  }

  void set_group_names(std::string_view rest) {
    close_ranges();
    names_.clear();
    for (std::string_view word = take_word(rest); !word.empty() && word[0] != '#'; word = take_word(rest))
      names_.push_back(group_index(word));
  }

  void set_names(Index& slot, std::string_view name) {
    close_ranges();
    slot = name.empty() ? -1 : group_index(name);
  }

  Index group_index(std::string_view name) {
    const auto [place_of, added] = group_of_.try_emplace(std::string(name), static_cast<Index>(mesh_.groups.size()));
    if (added) mesh_.groups.push_back({std::string(name), {}});
    return place_of->second;
  }

  Index main_group() const {
    if (!names_.empty()) return names_.front();
    return object_ >= 0 ? object_ : material_;
  }

  /// The faces since the last change of names belong to the names that held until now.
  void close_ranges() {
    const auto end = static_cast<Index>(mesh_.polygons.size());
    if (end > range_begin_) {
      for (const Index name : names_) ranges_.push_back({name, range_begin_, end});
      if (object_ >= 0) ranges_.push_back({object_, range_begin_, end});
      if (material_ >= 0) ranges_.push_back({material_, range_begin_, end});
    }
    range_begin_ = end;
  }

  std::string place() const { return at_line(lines_.line_number()); }

  const MeshSource& source_;
  const Log& log_;
  LineScanner lines_;
  std::string joined_;
  SurfaceMesh mesh_;
  bool has_textures_ = false, has_materials_ = false;
  std::vector<ForwardReference> forward_;
  SkippedFaces skipped_;
  std::map<std::string, Index> group_of_;
  std::vector<Index> names_;  ///< of the last g line
  Index object_ = -1, material_ = -1;
  Index range_begin_ = 0;
  std::vector<GroupRange> ranges_;
};

}  // namespace

SurfaceMesh read_obj(const MeshSource& source, const Log& log) {
  return ObjReader(source, log).read();
}

}  // namespace softreel::detail
