/// What every mesh reader works on: the bytes of a file, its name for messages, and the checks that all formats share.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/base/log.h"
#include "core/mesh/surface_mesh.h"

namespace softreel::detail {

/// A mesh file in memory; owns nothing.
struct MeshSource {
  std::string name;  ///< as messages call it: the path as the user gave it
  std::string_view bytes;
};

/// Text out of a file as messages may show it: one line of at most 300 bytes, '?' for control and other odd bytes.
std::string shown(std::string_view text);

/// The error of a file that gives no mesh at all, whatever its format. Here and below, `problem` is shown().
Error unusable_file(const std::string& path, const std::string& problem, const std::string& advice);

/// Throws input_error for what is no regular file, or empty.
void require_mesh_file(const std::string& path);

/// The bytes of a mesh file. Throws input_error as require_mesh_file, and for a file that cannot be read.
std::string read_mesh_file(const std::string& path);

/// Without the byte order mark that some editors put before UTF-8.
std::string_view without_mark(std::string_view bytes);

/// The text of a file whose format is text: its bytes without that mark.
/// Throws input_error for UTF-16.
std::string_view text_of(const MeshSource& source);

/// Text with small letters for capital ones, those of ASCII only.
std::string small_letters(std::string_view text);

/// ".obj", in small letters; "" if the path has none.
std::string lower_extension(const std::string& path);

/// Whether colours of vertices in such a file are linear: those of glTF are, by its specification.
bool has_linear_colors(const std::string& path);

/// The error of a file that breaks its format. place: ":12" for a line, " (byte 80)" in a binary file, or "".
Error broken_file(const MeshSource& source, const std::string& place, const std::string& problem,
                  const std::string& accepted, const std::string& advice);

/// The error of a face that names a vertex (or texture coordinate) which the file does not have.
Error bad_index(const MeshSource& source, const std::string& place, const std::string& what, const std::string& value,
                std::size_t count);

/// ":line", as compilers print it.
std::string at_line(std::int64_t line);

/// Ends a polygon whose corners were appended to the list. One of fewer than 3 corners is taken back: returns false.
bool close_polygon(PolygonList& polygons);

/// Counts faces of fewer than 3 corners, which have no area, and reports them in one warning.
struct SkippedFaces {
  std::int64_t count = 0;
  std::string first_place;

  void add(const std::string& place);
  void report(const MeshSource& source, const Log& log) const;
};

}  // namespace softreel::detail
