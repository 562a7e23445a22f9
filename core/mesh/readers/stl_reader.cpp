#include "core/mesh/readers/stl_reader.h"

#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "core/mesh/readers/text_scanner.h"

namespace softreel::detail {
namespace {

static_assert(std::endian::native == std::endian::little, "binary meshes are read as they lie in memory");

constexpr std::size_t kHeaderBytes = 84, kFacetBytes = 50, kNormalBytes = 12;

std::uint64_t announced_bytes(std::string_view bytes) {
  std::uint32_t facets = 0;
  std::memcpy(&facets, bytes.data() + kHeaderBytes - sizeof facets, sizeof facets);
  return kHeaderBytes + std::uint64_t{kFacetBytes} * facets;
}

/// Adds the triangle of the last three positions.
void close_facet(SurfaceMesh& mesh) {
  const auto end = static_cast<Index>(mesh.positions.size());
  for (Index v = end - 3; v < end; ++v) mesh.polygons.corner_vertices.push_back(v);
  mesh.polygons.offsets.push_back(end);
}

/// bytes: exactly the header and its facets.
SurfaceMesh read_binary(std::string_view bytes) {
  SurfaceMesh mesh;
  const std::size_t facets = (bytes.size() - kHeaderBytes) / kFacetBytes;
  mesh.positions.reserve(3 * facets);
  mesh.polygons.offsets.reserve(facets + 1);
  mesh.polygons.corner_vertices.reserve(3 * facets);
  for (std::size_t at = kHeaderBytes; at + kFacetBytes <= bytes.size(); at += kFacetBytes) {
    std::array<float, 9> corners;
    std::memcpy(corners.data(), bytes.data() + at + kNormalBytes, sizeof corners);
    for (std::size_t k = 0; k < 9; k += 3)
      mesh.positions.emplace_back(double{corners[k]}, double{corners[k + 1]}, double{corners[k + 2]});
    close_facet(mesh);
  }
  return mesh;
}

/// Text begins with "solid"; so do some binary files, but their number of facets has a zero byte.
bool is_text_stl(const MeshSource& source) {
  std::string_view text = without_mark(source.bytes);
  return text.substr(0, kHeaderBytes).find('\0') == text.npos && small_letters(take_word(text)) == "solid";
}

class StlTextReader {
 public:
  explicit StlTextReader(const MeshSource& source) : source_(source), lines_(text_of(source)) {}

  SurfaceMesh read() {
    std::string_view line;
    while (lines_.next(line)) read_line(line);
    if (in_facet_) throw broken("the file ends inside a facet");
    close_solid();
    return std::move(mesh_);
  }

 private:
  void read_line(std::string_view line) {
    std::string_view rest = line;
    for (std::string word = next_keyword(rest); !word.empty(); word = next_keyword(rest)) {
      if (word == "vertex") {
        read_vertex(rest);
      } else if (word == "facet") {
        if (in_facet_) throw broken("a facet starts inside another one");
        in_facet_ = true;
        corners_ = 0;
      } else if (word == "endfacet") {
        if (!in_facet_ || corners_ != 3) throw broken(fmt::format("a facet has {} corner(s)", corners_));
        in_facet_ = false;
        close_facet(mesh_);
      } else if (word == "solid") {
        close_solid();
        solid_ = std::string(trimmed(rest));
        return;
      } else if (word == "endsolid") {
        close_solid();
        return;
      } else if (word == "normal" || word == "outer") {
        skip_words(rest, word == "normal" ? 3 : 1);
      } else if (word != "endloop") {
        throw broken(fmt::format("the word '{}' is not one of STL", word.substr(0, 20)));
      }
    }
  }

  /// Some programs write STL in capital letters.
  static std::string next_keyword(std::string_view& rest) { return small_letters(take_word(rest)); }

  static void skip_words(std::string_view& rest, int count) {
    for (int k = 0; k < count; ++k) take_word(rest);
  }

  void read_vertex(std::string_view& rest) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = take_word(rest);
      if (!parse_number(word, p[k])) throw broken(fmt::format("a vertex has the coordinate '{}'", word));
    }
    if (!in_facet_ || ++corners_ > 3) throw broken("a vertex lies outside of a facet of 3 corners");
    mesh_.positions.push_back(p);
  }

  /// The vertices since the last solid become a group, if the solid has a name.
  void close_solid() {
    const auto end = static_cast<Index>(mesh_.positions.size());
    if (!solid_.empty() && end > solid_begin_) {
      VertexGroup group{solid_, {}};
      for (Index v = solid_begin_; v < end; ++v) group.vertices.push_back(v);
      mesh_.groups.push_back(std::move(group));
    }
    solid_begin_ = end;
    solid_.clear();
  }

  Error broken(const std::string& problem) const {
    return broken_file(source_, at_line(lines_.line_number()), problem,
                       "solid, facet normal, outer loop, three times vertex x y z, endloop, endfacet, endsolid",
                       "Export the mesh again, best as binary STL, PLY or OBJ");
  }

  const MeshSource& source_;
  LineScanner lines_;
  SurfaceMesh mesh_;
  bool in_facet_ = false;
  int corners_ = 0;
  std::string solid_;
  Index solid_begin_ = 0;
};

}  // namespace

SurfaceMesh read_stl(const MeshSource& source, const Log& log) {
  const std::string_view bytes = source.bytes;
  const std::uint64_t announced = bytes.size() < kHeaderBytes ? 0 : announced_bytes(bytes);
  if (announced > 0 && announced == bytes.size()) return read_binary(bytes);
  if (is_text_stl(source)) return StlTextReader(source).read();
  if (announced > kHeaderBytes && announced < bytes.size()) {
    log.warn(fmt::format("{}: {} bytes after the last triangle left out", source.name, bytes.size() - announced));
    return read_binary(bytes.substr(0, announced));
  }
  text_of(source);  // refuses UTF-16 by its name
  throw broken_file(source, "", fmt::format("{} bytes are no STL file", bytes.size()),
                    fmt::format("text that starts with 'solid', or a binary file of {} bytes by its header",
                                announced == 0 ? "at least 84" : std::to_string(announced)),
                    "Export the mesh again; the file may be cut off");
}

}  // namespace softreel::detail
