#include "core/mesh/readers/off_reader.h"

#include <numeric>

#include <fmt/format.h>

#include "core/mesh/readers/text_scanner.h"

namespace softreel::detail {
namespace {

class OffReader {
 public:
  OffReader(const MeshSource& source, const Log& log) : source_(source), log_(log), lines_(text_of(source)) {}

  SurfaceMesh read() {
    std::string_view line = next_line("header");
    std::string_view rest = line;
    std::string_view keyword = take_word(rest);
    if (keyword.ends_with("OFF")) {
      has_textures_ = keyword.starts_with("ST");
      if (keyword.find('4') != keyword.npos || keyword.find('n') != keyword.npos)
        throw broken_file(source_, place(),
                          fmt::format("the header is {}: points of other than 3 coordinates", keyword),
                          "OFF, COFF, NOFF, CNOFF, STOFF", "Export the mesh in 3 dimensions");
      if (trimmed(rest).starts_with("BINARY"))
        throw broken_file(source_, place(), "the file is a binary OFF file", "the text form",
                          "Export it as text or PLY");
      line = trimmed(rest).empty() ? next_line("line of counts") : rest;
    }
    const std::size_t vertices = read_count(line, "vertices");
    const std::size_t faces = read_count(line, "faces");
    for (std::size_t v = 0; v < vertices; ++v) read_vertex(next_line("vertex", v + 1, vertices));
    for (std::size_t f = 0; f < faces; ++f) read_face(next_line("face", f + 1, faces));
    if (has_textures_) mesh_.polygons.corner_textures = mesh_.polygons.corner_vertices;
    skipped_.report(source_, log_);
    return std::move(mesh_);
  }

 private:
  /// The next line that says something, without its comment. what, number, count: what it should hold, for the error.
  std::string_view next_line(const char* what, std::size_t number = 1, std::size_t count = 1) {
    std::string_view line;
    while (lines_.next(line)) {
      line = line.substr(0, line.find('#'));
      if (!trimmed(line).empty()) return line;
    }
    throw broken_file(source_, place(), fmt::format("the file ends before {} {} of {}", what, number, count),
                      "as many lines as its header announces", "Export the mesh again; the file may be cut off");
  }

  std::size_t read_count(std::string_view& rest, const char* what) {
    const std::string_view word = take_word(rest);
    std::int64_t value = 0;
    if (!parse_integer(word, value) || value < 0 || value > INT32_MAX)
      throw broken_file(source_, place(), fmt::format("the number of {} is '{}'", what, word),
                        "a header of OFF and the numbers of vertices, faces and edges",
                        "Check that the file is an OFF mesh, or export it again");
    return static_cast<std::size_t>(value);
  }

  double read_number(std::string_view& rest) {
    const std::string_view word = take_word(rest);
    double value = 0;
    if (!parse_number(word, value))
      throw broken_file(source_, place(), fmt::format("a vertex has the coordinate '{}'", word),
                        "three decimal numbers a line", "Mend the line or export the mesh again");
    return value;
  }

  void read_vertex(std::string_view rest) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = read_number(rest);
    mesh_.positions.push_back(p);
    if (!has_textures_) return;
    std::vector<double> others;  // normal, colour, then s and t
    while (!trimmed(rest).empty()) others.push_back(read_number(rest));
    if (others.size() < 2)
      throw broken_file(source_, place(), "a vertex of an ST file has no texture coordinates",
                        "s and t at the line's end", "Export the mesh again");
    mesh_.texture_coordinates.emplace_back(others[others.size() - 2], others.back());
  }

  void read_face(std::string_view rest) {
    const std::string_view first = take_word(rest);
    std::int64_t corners = 0;
    if (!parse_integer(first, corners) || corners < 0)
      throw broken_file(source_, place(), fmt::format("a face has '{}' corners", first),
                        "the number of corners, then the vertices from 0", "Mend the line or export the mesh again");
    for (std::int64_t k = 0; k < corners; ++k) {
      const std::string_view word = take_word(rest);
      std::int64_t v = 0;
      if (!parse_integer(word, v) || v < 0 || v >= static_cast<std::int64_t>(mesh_.positions.size()))
        throw bad_index(source_, place(), "vertex", fmt::format("'{}'", word), mesh_.positions.size());
      mesh_.polygons.corner_vertices.push_back(static_cast<Index>(v));
    }
    if (!close_polygon(mesh_.polygons)) skipped_.add(place());
  }

  std::string place() const { return at_line(lines_.line_number()); }

  const MeshSource& source_;
  const Log& log_;
  LineScanner lines_;
  SurfaceMesh mesh_;
  bool has_textures_ = false;
  SkippedFaces skipped_;
};

}  // namespace

SurfaceMesh read_off(const MeshSource& source, const Log& log) {
  return OffReader(source, log).read();
}

}  // namespace softreel::detail
