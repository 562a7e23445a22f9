/// VTK's legacy format, text and binary, with cells as lists (versions up to 4.2) or with offsets (5.1).
#include <map>

#include "core/tetmesh/files/vtk_cells.h"

namespace softreel::detail {
namespace {

class VtkReader {
 public:
  explicit VtkReader(const MeshSource& source) : in_(source) {}

  TetFileContents read() {
    if (!in_.line().starts_with("# vtk DataFile"))
      throw unread_variant(in_.source(), "a .vtk file that does not begin with '# vtk DataFile'",
                           "VTK's legacy format");
    in_.line();  // the title
    const std::string encoding = keyword();
    if (encoding != "ascii" && encoding != "binary") throw in_.not_a("ASCII or BINARY", encoding);
    is_binary_ = encoding == "binary";
    TetFileContents contents;
    while (!in_.at_end()) {
      const std::string_view word = in_.word();
      const std::string entry = small_letters(word);
      if (entry == "dataset") {
        if (const std::string kind(in_.word()); small_letters(kind) != "unstructured_grid")
          throw unread_variant(in_.source(), fmt::format("a data set '{}'", kind.substr(0, 30)), "UNSTRUCTURED_GRID");
      } else if (entry == "points") {
        read_points(contents);
      } else if (entry == "cells") {
        read_cells();
      } else if (entry == "cell_types") {
        types_ = whole_numbers(in_.count(1), "int");
      } else if (entry == "metadata") {
        skip_metadata();
      } else if (entry == "field" && offsets_.empty()) {
        skip_field();  // of the whole data set, such as its time, before its points
      } else if (entry == "point_data" || entry == "cell_data" || entry == "field") {
        break;  // nothing that makes the mesh comes behind them
      } else {
        throw in_.not_a("keyword of an unstructured grid", word);
      }
    }
    if (offsets_.empty()) throw in_.cut_off();
    add_vtk_cells(in_.source(), connectivity_, offsets_, types_, contents);
    return contents;
  }

 private:
  /// The next word in small letters: VTK takes keywords and names of types in letters of either size.
  std::string keyword() { return small_letters(in_.word()); }

  std::vector<double> numbers(std::size_t count, const std::string& type) {
    return values(count, type, [&] { return in_.number(); });
  }
  std::vector<double> whole_numbers(std::size_t count, const std::string& type) {
    return values(count, type, [&] { return static_cast<double>(in_.integer()); });
  }

  /// `count` values, which text_value() reads in text; a binary block begins behind the line of its header.
  template <typename TextValue>
  std::vector<double> values(std::size_t count, const std::string& type, const TextValue& text_value) {
    if (is_binary_) in_.line();
    std::vector<double> list;
    for (std::size_t i = 0; i < count; ++i) list.push_back(is_binary_ ? binary_value(type) : text_value());
    return list;
  }

  double binary_value(const std::string& type) {
    if (type == "double") return in_.binary<double>(true);
    if (type == "float") return in_.binary<float>(true);
    if (type == "int") return in_.binary<std::int32_t>(true);
    if (type == "vtktypeint64" || type == "long") return static_cast<double>(in_.binary<std::int64_t>(true));
    throw unread_variant(in_.source(), fmt::format("the data type '{}'", type.substr(0, 30)),
                         "float, double, int and vtktypeint64");
  }

  /// Up to the empty line that ends it.
  void skip_metadata() {
    in_.line();
    while (!in_.rest().empty() && !in_.line().empty()) continue;
  }

  void skip_field() {
    in_.word();  // its name
    const std::size_t arrays = in_.count(1);
    for (std::size_t a = 0; a < arrays; ++a) {
      while (keyword() == "metadata") skip_metadata();  // else the array's name
      const std::size_t components = in_.count(1), tuples = in_.count(1);
      if (components > 0 && tuples > in_.rest().size() / components + 1) throw in_.cut_off();
      const std::string type = keyword();
      if (is_binary_) {
        in_.line();
        in_.skip(components * tuples * bytes_of(type));
      } else {
        for (std::size_t k = 0; k < components * tuples; ++k) in_.word();
      }
    }
  }

  std::size_t bytes_of(const std::string& type) const {
    static const std::map<std::string, std::size_t> sizes{
        {"char", 1},          {"unsigned_char", 1}, {"short", 2},        {"unsigned_short", 2},
        {"int", 4},           {"float", 4},         {"unsigned_int", 4}, {"long", 8},
        {"unsigned_long", 8}, {"vtktypeint64", 8},  {"double", 8},       {"vtkidtype", 4}};
    const auto found = sizes.find(type);
    if (found == sizes.end())
      throw unread_variant(in_.source(), fmt::format("a field of the data type '{}'", type.substr(0, 30)),
                           "fields of numbers");
    return found->second;
  }

  void read_points(TetFileContents& contents) {
    const std::size_t count = in_.count(6);
    const std::vector<double> list = numbers(3 * count, keyword());
    for (std::size_t i = 0; i < count; ++i) contents.nodes.emplace_back(list[3 * i], list[3 * i + 1], list[3 * i + 2]);
  }

  void read_cells() {
    const std::size_t count = in_.count(1), size = in_.count(1);
    ByteReader ahead = in_;
    if (!ahead.at_end() && small_letters(ahead.word()) == "offsets") {
      in_.word();
      offsets_ = whole_numbers(count, keyword());
      if (keyword() != "connectivity") throw in_.cut_off();
      connectivity_ = whole_numbers(size, keyword());
      return;
    }
    const std::vector<double> lists = whole_numbers(size, "int");
    offsets_.assign(1, 0);
    for (std::size_t i = 0; i < lists.size();) {
      const double length = lists[i++];
      if (!(length >= 0) || length > static_cast<double>(lists.size() - i)) throw in_.cut_off();
      for (double k = 0; k < length; ++k) connectivity_.push_back(lists[i++]);
      offsets_.push_back(static_cast<double>(connectivity_.size()));
    }
  }

  ByteReader in_;
  bool is_binary_ = false;
  std::vector<double> connectivity_, offsets_, types_;
};

}  // namespace

TetFileContents read_vtk(const MeshSource& source) {
  return VtkReader(source).read();
}

}  // namespace softreel::detail
