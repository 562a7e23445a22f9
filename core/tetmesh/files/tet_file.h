/// What the readers of tetrahedral formats share: contents not yet checked, and numbers from text or binary bytes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/base/types.h"
#include "core/mesh/readers/mesh_source.h"
#include "core/mesh/readers/text_scanner.h"

namespace softreel::detail {

static_assert(std::endian::native == std::endian::little, "bytes are swapped for big-endian files only");

/// A file's nodes and linear tetrahedra, indices from 0 as the file has them: checked by read_tet_mesh.
struct TetFileContents {
  std::vector<Vec3> nodes;
  std::vector<std::array<std::int64_t, 4>> tets;
  std::vector<double> fill;  ///< TetMesh::fill, if the file has it
};

TetFileContents read_medit(const MeshSource& source);
TetFileContents read_gmsh(const MeshSource& source);
TetFileContents read_vtk(const MeshSource& source);
TetFileContents read_vtu(const MeshSource& source);

/// The error of a kind of element that is neither a linear tetrahedron nor of lower dimension.
inline Error wrong_element(const MeshSource& source, const std::string& what) {
  return broken_file(source, "", fmt::format("it has {}", what),
                     "linear tetrahedra (points, lines and faces are skipped)",
                     "Mesh the body with tetrahedra of first order, or give its surface");
}

/// The error of a file of this format that is written in a way which is not read.
inline Error unread_variant(const MeshSource& source, const std::string& what, const std::string& accepted) {
  return broken_file(source, "", fmt::format("{} is not read", what), accepted, "Save it that way");
}

/// Walks over the bytes of a file: words, lines and binary values.
class ByteReader {
 public:
  /// comment: what begins a comment up to the end of its line, where the format has some; never inside a word.
  explicit ByteReader(const MeshSource& source, std::optional<char> comment = std::nullopt)
      : source_(source), rest_(source.bytes), comment_(comment) {}

  const MeshSource& source() const { return source_; }
  std::string_view rest() const { return rest_; }
  std::string place() const { return fmt::format(" (byte {})", source_.bytes.size() - rest_.size()); }

  bool at_end() {
    skip_blanks();
    return rest_.empty();
  }
  /// The next word; an error at the end of the file.
  std::string_view word() {
    skip_blanks();
    const std::string_view found = take_word(rest_);
    if (found.empty()) throw cut_off();
    return found;
  }
  double number() {
    const std::string_view text = word();
    double value = 0;
    if (!parse_number(text, value)) throw not_a("number", text);
    return value;
  }
  std::int64_t integer() {
    const std::string_view text = word();
    std::int64_t value = 0;
    if (!parse_integer(text, value)) throw not_a("whole number", text);
    return value;
  }
  /// A whole number that says how many items of at least `least_bytes` follow: refused if the file is too short.
  std::size_t count(std::size_t least_bytes) { return checked_count(integer(), least_bytes); }
  std::size_t checked_count(std::int64_t value, std::size_t least_bytes) const {
    if (value < 0 || static_cast<std::uint64_t>(value) > rest_.size() / least_bytes + 1) throw cut_off();
    return static_cast<std::size_t>(value);
  }

  /// Everything up to the end of the line, and steps behind that.
  std::string_view line() {
    const std::size_t end = rest_.find('\n');
    const std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    return trimmed(text);
  }

  template <typename T>
  T binary(bool big_endian = false) {
    if (rest_.size() < sizeof(T)) throw cut_off();
    std::array<char, sizeof(T)> bytes;
    std::copy_n(rest_.data(), sizeof(T), bytes.begin());
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    rest_.remove_prefix(sizeof(T));
    return std::bit_cast<T>(bytes);
  }
  void skip(std::size_t bytes) {
    if (rest_.size() < bytes) throw cut_off();
    rest_.remove_prefix(bytes);
  }
  /// Comments are blanks, too.
  void skip_blanks() {
    while (!rest_.empty() && (is_blank(rest_.front()) || rest_.front() == comment_))
      rest_.remove_prefix(rest_.front() == comment_ ? std::min(rest_.find('\n'), rest_.size()) : 1);
  }
  /// Steps behind the next occurrence of `text`.
  void skip_past(std::string_view text) {
    const std::size_t found = rest_.find(text);
    if (found == std::string_view::npos) throw cut_off();
    rest_.remove_prefix(found + text.size());
  }

  Error cut_off() const {
    return broken_file(source_, place(), "the file ends before its data do", "as much data as its headers announce",
                       "Export the mesh again; the file may be cut off");
  }
  Error not_a(const std::string& what, std::string_view text) const {
    return broken_file(source_, place(), fmt::format("'{}' is no {}", text.substr(0, 20), what),
                       fmt::format("a {} there", what), "Export the mesh again");
  }

 private:
  const MeshSource& source_;
  std::string_view rest_;
  std::optional<char> comment_;
};

}  // namespace softreel::detail
