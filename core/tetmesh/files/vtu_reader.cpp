/// VTK's XML format of unstructured grids: arrays as text, as base64 in place, or appended raw or as base64.
#include <cstdint>

#include "core/tetmesh/files/vtk_cells.h"

namespace softreel::detail {
namespace {

/// The value of an attribute in the text of a tag, in quotes of either kind; "" if it has none.
std::string attribute(std::string_view tag, const std::string& name) {
  for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
    if (at == 0 || !is_blank(tag[at - 1])) continue;
    std::string_view rest = trimmed(tag.substr(at + name.size()));
    if (!rest.starts_with('=')) continue;
    rest = trimmed(rest.substr(1));
    if (!rest.starts_with('"') && !rest.starts_with('\'')) continue;
    return std::string(rest.substr(1, rest.find(rest.front(), 1) - 1));
  }
  return {};
}

/// Value of a base64 digit, -1 for what is none.
int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/// Decodes groups of four digits, padding inside included (VTK encodes header and data apart).
std::string decode_base64(std::string_view text) {
  std::string bytes;
  std::uint32_t bits = 0;
  int digits = 0, padding = 0;
  for (const char c : text) {
    const int digit = c == '=' ? 0 : base64_digit(c);
    if (digit < 0) continue;
    padding += c == '=' ? 1 : 0;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    if (++digits < 4) continue;
    for (int k = 0; k < 3 - padding; ++k) bytes.push_back(static_cast<char>(bits >> (16 - 8 * k) & 0xff));
    bits = 0;
    digits = padding = 0;
  }
  return bytes;
}

class VtuReader {
 public:
  explicit VtuReader(const MeshSource& source) : source_(source) {}

  TetFileContents read() {
    read_header();
    const std::string_view piece = tag_at(source_.bytes, "<Piece");
    if (source_.bytes.find("<Piece", source_.bytes.find("<Piece") + 1) < appended_at_)
      throw unread_variant(source_, "a grid of several pieces", "a grid of one piece");
    TetFileContents contents;
    const std::vector<double> points = array(section("Points"), "");
    if (points.size() != 3 * number(piece, "NumberOfPoints")) throw cut_off();
    for (std::size_t i = 0; i + 2 < points.size(); i += 3)
      contents.nodes.emplace_back(points[i], points[i + 1], points[i + 2]);
    const std::string_view cells = section("Cells");
    std::vector<double> offsets = array(cells, "offsets");
    offsets.insert(offsets.begin(), 0);
    const std::vector<double> types = array(cells, "types");
    if (types.size() != number(piece, "NumberOfCells")) throw cut_off();
    add_vtk_cells(source_, array(cells, "connectivity"), offsets, types, contents);
    if (contents.tets.size() == types.size()) contents.fill = fill();
    return contents;
  }

 private:
  Error cut_off() const { return ByteReader(source_).cut_off(); }

  /// The text of the first tag with this beginning, without its brackets.
  std::string_view tag_at(std::string_view text, std::string_view beginning) const {
    const std::size_t begin = text.find(beginning), end = text.find('>', begin);
    if (begin == std::string_view::npos || end == std::string_view::npos) throw cut_off();
    return text.substr(begin + 1, end - begin - 1);
  }

  std::size_t number(std::string_view tag, const std::string& name) const {
    std::int64_t value = 0;
    if (!parse_integer(attribute(tag, name), value) || value < 0) throw cut_off();
    return static_cast<std::size_t>(value);
  }

  void read_header() {
    const std::string_view file = tag_at(source_.bytes, "<VTKFile");
    if (attribute(file, "type") != "UnstructuredGrid")
      throw unread_variant(source_, "a VTK file of another kind", "an UnstructuredGrid");
    if (attribute(file, "byte_order") == "BigEndian") throw unread_variant(source_, "big-endian data", "LittleEndian");
    if (!attribute(file, "compressor").empty()) throw unread_variant(source_, "compressed data", "uncompressed data");
    has_long_headers_ = attribute(file, "header_type") == "UInt64";
    appended_at_ = source_.bytes.find("<AppendedData");
    if (appended_at_ == std::string_view::npos) return;
    const std::string_view tag = tag_at(source_.bytes.substr(appended_at_), "<AppendedData");
    const std::size_t begin = source_.bytes.find('_', appended_at_ + tag.size());
    if (begin == std::string_view::npos) throw cut_off();
    appended_ = source_.bytes.substr(begin + 1);
    appended_is_raw_ = attribute(tag, "encoding") == "raw";
  }

  /// What stands between a tag and its end.
  std::string_view section(const std::string& name) const {
    const std::string_view head = source_.bytes.substr(0, appended_at_);
    const std::size_t begin = head.find("<" + name), end = head.find("</" + name, begin);
    if (begin == std::string_view::npos || end == std::string_view::npos) throw cut_off();
    return head.substr(begin, end - begin);
  }

  /// How full the cells are, as embedded meshes are written; empty if the file does not say.
  std::vector<double> fill() const {
    const std::string_view head = source_.bytes.substr(0, appended_at_);
    if (head.find("<CellData") == std::string_view::npos) return {};
    const std::string_view data = section("CellData");
    return find_array(data, "fill") == std::string_view::npos ? std::vector<double>{} : array(data, "fill");
  }

  /// Where the array of a name begins in a section, the first one for ""; npos if there is none.
  std::size_t find_array(std::string_view text, const std::string& name) const {
    std::size_t begin = text.find("<DataArray");
    while (begin != std::string_view::npos && !name.empty() &&
           attribute(tag_at(text.substr(begin), "<DataArray"), "Name") != name)
      begin = text.find("<DataArray", begin + 1);
    return begin;
  }

  std::vector<double> array(std::string_view text, const std::string& name) const {
    const std::size_t begin = find_array(text, name);
    if (begin == std::string_view::npos) throw cut_off();
    const std::string_view tag = tag_at(text.substr(begin), "<DataArray");
    const std::string format = attribute(tag, "format"), type = attribute(tag, "type");
    const std::size_t after = begin + tag.size() + 2;
    const std::string_view inside = text.substr(after, text.find('<', after) - after);
    if (format == "ascii") return from_text(inside);
    if (format == "binary") return from_bytes(decode_base64(inside), type);
    if (format != "appended")
      throw unread_variant(source_, fmt::format("an array in format '{}'", format), "ascii, binary and appended");
    const std::size_t offset = number(tag, "offset");
    if (offset > appended_.size()) throw cut_off();
    const std::string_view data = appended_.substr(offset);
    return appended_is_raw_ ? from_bytes(data, type) : from_bytes(decode_base64(data.substr(0, data.find('<'))), type);
  }

  std::vector<double> from_text(std::string_view text) const {
    const MeshSource inside{source_.name, text};
    ByteReader in(inside);
    std::vector<double> list;
    while (!in.at_end()) list.push_back(in.number());
    return list;
  }

  /// A block: its length in bytes, then its values.
  std::vector<double> from_bytes(std::string_view bytes, const std::string& type) const {
    const MeshSource block{source_.name, bytes};
    ByteReader in(block);
    const std::uint64_t length = has_long_headers_ ? in.binary<std::uint64_t>() : in.binary<std::uint32_t>();
    if (length > in.rest().size()) throw cut_off();
    if (type == "Float64") return values<double>(in, length);
    if (type == "Float32") return values<float>(in, length);
    if (type == "Int64") return values<std::int64_t>(in, length);
    if (type == "UInt64") return values<std::uint64_t>(in, length);
    if (type == "Int32") return values<std::int32_t>(in, length);
    if (type == "UInt32") return values<std::uint32_t>(in, length);
    if (type == "Int8") return values<std::int8_t>(in, length);
    if (type == "UInt8") return values<std::uint8_t>(in, length);
    throw unread_variant(source_, fmt::format("the data type '{}'", type), "Float32, Float64 and integers");
  }

  template <typename T>
  static std::vector<double> values(ByteReader& in, std::uint64_t length) {
    std::vector<double> list;
    for (std::uint64_t i = 0; i < length / sizeof(T); ++i) list.push_back(static_cast<double>(in.binary<T>()));
    return list;
  }

  const MeshSource& source_;
  std::size_t appended_at_ = std::string_view::npos;
  std::string_view appended_;
  bool appended_is_raw_ = false, has_long_headers_ = false;
};

}  // namespace

TetFileContents read_vtu(const MeshSource& source) {
  return VtuReader(source).read();
}

}  // namespace softreel::detail
