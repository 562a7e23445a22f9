#include "core/mesh/readers/mesh_source.h"

#include <filesystem>
#include <fstream>

#include <fmt/format.h>

namespace softreel::detail {

namespace fs = std::filesystem;

namespace {

/// Length of the UTF-8 sequence of a printable character that `text` starts with; 0 if there is none.
std::size_t printable_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return byte(0) >= 0x20 && byte(0) != 0x7f ? 1 : 0;
  const std::size_t length = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte(k) & 0xc0) != 0x80) return 0;
  return length;
}

}  // namespace

std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 300;
  std::string line;
  while (!text.empty() && line.size() < kMost) {
    const std::size_t length = printable_length(text);
    if (length > 0)
      line += text.substr(0, length);
    else
      line += '?';
    text.remove_prefix(length > 0 ? length : 1);
  }
  return text.empty() ? line : line + "...";
}

Error unusable_file(const std::string& path, const std::string& problem, const std::string& advice) {
  return input_error(
      fmt::format("{}: {}.\n  Accepted: a mesh file (.obj, .ply, .off, .stl, .gltf, .glb, .fbx, .dae, ...). {}.", path,
                  shown(problem), advice));
}

void require_mesh_file(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!fs::exists(status)) throw unusable_file(path, "there is no such mesh file", "Check the path");
  if (fs::is_directory(status)) throw unusable_file(path, "this is a folder, not a mesh file", "Name a file in it");
  if (!fs::is_regular_file(status)) throw unusable_file(path, "this is not a regular file", "Save the mesh to a file");
  if (fs::file_size(path, ignored) == 0) throw unusable_file(path, "the mesh file is empty", "Export the mesh again");
}

std::string read_mesh_file(const std::string& path) {
  require_mesh_file(path);
  std::ifstream file(path, std::ios::binary);
  std::string bytes;
  std::error_code ignored;
  bytes.resize(fs::file_size(path, ignored));
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file) throw unusable_file(path, "the mesh file cannot be read", "Check its permissions");
  return bytes;
}

std::string_view without_mark(std::string_view bytes) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return bytes.substr(bytes.starts_with(kMark) ? kMark.size() : 0);
}

std::string_view text_of(const MeshSource& source) {
  if (source.bytes.starts_with("\xff\xfe") || source.bytes.starts_with("\xfe\xff"))
    throw broken_file(source, "", "its text is UTF-16", "ASCII or UTF-8", "Save the file in UTF-8");
  return without_mark(source.bytes);
}

std::string small_letters(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::string lower_extension(const std::string& path) {
  return small_letters(fs::path(path).extension().string());
}

bool has_linear_colors(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".gltf" || extension == ".glb";
}

Error broken_file(const MeshSource& source, const std::string& place, const std::string& problem,
                  const std::string& accepted, const std::string& advice) {
  return input_error(
      fmt::format("{}{}: {}.\n  Accepted: {}. {}.", source.name, place, shown(problem), accepted, advice));
}

Error bad_index(const MeshSource& source, const std::string& place, const std::string& what, const std::string& value,
                std::size_t count) {
  return broken_file(source, place, fmt::format("a face refers to {} {}, which the file does not have", what, value),
                     fmt::format("one of the file's {}", count), "Export the mesh again; the file may be cut off");
}

std::string at_line(std::int64_t line) {
  return fmt::format(":{}", line);
}

bool close_polygon(PolygonList& polygons) {
  const auto begin = static_cast<std::size_t>(polygons.offsets.back());
  if (polygons.corner_vertices.size() - begin < 3) {
    polygons.corner_vertices.resize(begin);
    if (polygons.corner_textures.size() > begin) polygons.corner_textures.resize(begin);
    return false;
  }
  polygons.offsets.push_back(static_cast<Index>(polygons.corner_vertices.size()));
  return true;
}

void SkippedFaces::add(const std::string& place) {
  if (count++ == 0) first_place = place;
}

void SkippedFaces::report(const MeshSource& source, const Log& log) const {
  if (count == 0) return;
  log.warn(fmt::format("{}: {} face(s) of fewer than 3 corners left out, the first at {}{}", source.name, count,
                       source.name, first_place));
}

}  // namespace softreel::detail
