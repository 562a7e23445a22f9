/// Gmsh's format, versions 2 and 4.1, text and binary.
#include <map>

#include "core/tetmesh/files/tet_file.h"
#include "core/tetmesh/key_index.h"

namespace softreel::detail {
namespace {

constexpr std::int64_t kTetrahedron = 4;

/// Nodes of the elements that are skipped, by Gmsh's number of their type: points, lines and faces up to third order.
const std::map<std::int64_t, std::size_t> kSkippedTypes{{1, 2},  {2, 3},  {3, 4},  {8, 3},   {9, 6},  {10, 9},
                                                        {15, 1}, {16, 8}, {20, 9}, {21, 10}, {26, 4}, {36, 16}};

class GmshReader {
 public:
  explicit GmshReader(const MeshSource& source) : in_(source) {}

  TetFileContents read() {
    read_format();
    while (!in_.at_end()) {
      const std::string section(in_.word());
      if (section.size() < 2 || section[0] != '$') throw in_.not_a("section", section);
      if (section == "$Nodes")
        is_old_ ? read_old_nodes() : read_nodes();
      else if (section == "$Elements")
        is_old_ ? read_old_elements() : read_elements();
      else if (section == "$ElementData")
        read_element_data();
      in_.skip_past("$End" + section.substr(1));
    }
    number_nodes();
    for (const std::int64_t tag : tet_tags_)
      if (const auto found = fill_.find(tag); found != fill_.end()) contents_.fill.push_back(found->second);
    return std::move(contents_);
  }

 private:
  void read_format() {
    std::string_view section = in_.word();
    while (section == "$Comments") {
      in_.skip_past("$EndComments");
      section = in_.word();
    }
    if (section != "$MeshFormat")
      throw unread_variant(in_.source(), "a .msh file that does not begin with $MeshFormat",
                           "Gmsh's versions 2 and 4.1");
    const std::string version(in_.word());
    is_old_ = version.starts_with("2");
    if (!is_old_ && version != "4.1")
      throw unread_variant(in_.source(), fmt::format("Gmsh's version '{}'", version.substr(0, 20)),
                           "Gmsh's versions 2 and 4.1");
    is_binary_ = in_.integer() != 0;
    if (in_.integer() != 8) throw unread_variant(in_.source(), "a data size other than 8", "double precision");
    if (is_binary_) {
      in_.line();
      if (in_.binary<std::int32_t>() != 1) throw unread_variant(in_.source(), "big-endian data", "little-endian data");
    }
    in_.skip_past("$EndMeshFormat");
  }

  std::int64_t small() { return is_binary_ ? in_.binary<std::int32_t>() : in_.integer(); }
  std::int64_t large() { return is_binary_ ? static_cast<std::int64_t>(in_.binary<std::uint64_t>()) : in_.integer(); }
  double real() { return is_binary_ ? in_.binary<double>() : in_.number(); }
  /// Steps to the first byte behind the line of a section's name or count.
  void begin_binary() {
    if (is_binary_) in_.line();
  }

  void add_node(std::int64_t tag) {
    if (!tags_.insert(static_cast<std::uint64_t>(tag)).second)
      throw broken_file(in_.source(), in_.place(), fmt::format("node {} is given twice", tag), "each node once",
                        "Export the mesh again");
  }
  Vec3 position() {
    const double x = real(), y = real(), z = real();
    return {x, y, z};
  }

  void read_old_nodes() {
    const std::size_t count = in_.count(8);
    begin_binary();
    for (std::size_t i = 0; i < count; ++i) {
      add_node(small());
      contents_.nodes.push_back(position());
    }
  }

  void read_nodes() {
    begin_binary();
    const std::size_t blocks = in_.checked_count(large(), 4);
    for (int k = 0; k < 3; ++k) large();  // nodes, smallest and largest tag
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::int64_t dimension = small();
      small();  // the entity
      const std::int64_t extra = small() != 0 ? dimension : 0;
      const std::size_t count = in_.checked_count(large(), 2);
      for (std::size_t i = 0; i < count; ++i) add_node(large());
      for (std::size_t i = 0; i < count; ++i) {
        contents_.nodes.push_back(position());
        for (std::int64_t k = 0; k < extra; ++k) real();
      }
    }
  }

  /// Nodes of an element type; 4 for tetrahedra.
  std::size_t nodes_of(std::int64_t type) const {
    if (type == kTetrahedron) return 4;
    const auto skipped = kSkippedTypes.find(type);
    if (skipped == kSkippedTypes.end())
      throw wrong_element(in_.source(), fmt::format("elements of Gmsh's type {}", type));
    return skipped->second;
  }

  /// Turns the tags of the elements' nodes into their numbers: only now, as nodes may come behind the elements.
  void number_nodes() {
    for (std::size_t e = 0; e < contents_.tets.size(); ++e)
      for (std::int64_t& node : contents_.tets[e]) {
        const Index number = tags_.find(static_cast<std::uint64_t>(node));
        if (number < 0)
          throw broken_file(in_.source(), "",
                            fmt::format("element {} refers to node {}, which is not given", tet_tags_[e], node),
                            fmt::format("one of the file's {}", contents_.nodes.size()), "Export the mesh again");
        node = number;
      }
  }

  /// One element's nodes, as tags, read by `next`. element: its tag.
  template <typename Next>
  void read_element(std::int64_t type, std::int64_t element, const Next& next) {
    std::array<std::int64_t, 4> tet{};
    const std::size_t count = nodes_of(type);
    for (std::size_t k = 0; k < count; ++k) {
      const std::int64_t tag = next();
      if (type == kTetrahedron) tet[k] = tag;
    }
    if (type != kTetrahedron) return;
    contents_.tets.push_back(tet);
    tet_tags_.push_back(element);
  }

  void read_old_elements() {
    std::size_t left = in_.count(8);
    begin_binary();
    while (left > 0) {
      const std::int64_t first = small();  // text: the element's own number; binary: the type of a block
      const std::int64_t type = is_binary_ ? first : small();
      const std::size_t block = is_binary_ ? in_.checked_count(small(), 4) : 1;
      const std::size_t tags = in_.checked_count(small(), 1);
      if (block == 0 || block > left) throw in_.cut_off();
      for (std::size_t e = 0; e < block; ++e) {
        const std::int64_t element = is_binary_ ? small() : first;
        for (std::size_t k = 0; k < tags; ++k) small();
        read_element(type, element, [&] { return small(); });
      }
      left -= block;
    }
  }

  void read_elements() {
    begin_binary();
    const std::size_t blocks = in_.checked_count(large(), 4);
    for (int k = 0; k < 3; ++k) large();
    for (std::size_t b = 0; b < blocks; ++b) {
      small();  // dimension
      small();  // entity
      const std::int64_t type = small();
      const std::size_t count = in_.checked_count(large(), 2);
      for (std::size_t e = 0; e < count; ++e) {
        const std::int64_t element = large();
        read_element(type, element, [&] { return large(); });
      }
    }
  }

  /// Values "fill", one an element, in both versions alike; others are left for the section's end to be found.
  void read_element_data() {
    in_.line();
    bool is_fill = false;
    const std::size_t names = in_.count(1);
    in_.line();
    for (std::size_t k = 0; k < names; ++k) is_fill = (in_.line() == "\"fill\"" && k == 0) || is_fill;
    if (!is_fill) return;
    const std::size_t times = in_.count(1);
    for (std::size_t k = 0; k < times; ++k) in_.number();
    std::vector<std::int64_t> numbers(in_.count(1));  // step, numbers an element, elements
    for (std::int64_t& number : numbers) number = in_.integer();
    if (numbers.size() < 3 || numbers[1] != 1) return;
    begin_binary();
    for (std::size_t left = in_.checked_count(numbers[2], 4); left > 0; --left) {
      const std::int64_t element = small();
      fill_[element] = real();
    }
  }

  ByteReader in_;
  TetFileContents contents_;
  KeyIndex tags_;
  std::vector<std::int64_t> tet_tags_;   ///< per tetrahedron
  std::map<std::int64_t, double> fill_;  ///< by element
  bool is_old_ = false, is_binary_ = false;
};

}  // namespace

TetFileContents read_gmsh(const MeshSource& source) {
  return GmshReader(source).read();
}

}  // namespace softreel::detail
