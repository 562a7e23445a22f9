/// Medit's text format: keywords, each with a count and so many records.
#include <map>

#include "core/tetmesh/files/tet_file.h"

namespace softreel::detail {
namespace {

/// Numbers in a record of the keywords that are skipped, the reference included.
const std::map<std::string_view, std::size_t> kSkippedSections{{"Edges", 3},
                                                               {"Triangles", 4},
                                                               {"Quadrilaterals", 5},
                                                               {"Corners", 1},
                                                               {"RequiredVertices", 1},
                                                               {"Ridges", 1},
                                                               {"RequiredEdges", 1},
                                                               {"RequiredTriangles", 1},
                                                               {"RequiredTetrahedra", 1},
                                                               {"Normals", 3},
                                                               {"NormalAtVertices", 2},
                                                               {"Tangents", 3},
                                                               {"TangentAtVertices", 2}};

void read_vertices(ByteReader& in, TetFileContents& contents) {
  const std::size_t count = in.count(8);
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = in.number();
    in.number();  // the reference
    contents.nodes.push_back(p);
  }
}

void read_tetrahedra(ByteReader& in, TetFileContents& contents) {
  const std::size_t count = in.count(10);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<std::int64_t, 4> tet;
    for (std::int64_t& node : tet) node = std::max<std::int64_t>(in.integer(), 0) - 1;
    in.number();
    contents.tets.push_back(tet);
  }
}

}  // namespace

TetFileContents read_medit(const MeshSource& source) {
  ByteReader in(source, '#');
  TetFileContents contents;
  if (in.word() != "MeshVersionFormatted")
    throw unread_variant(source, "a .mesh file that does not begin with MeshVersionFormatted", "Medit's text format");
  in.integer();
  while (!in.at_end()) {
    const std::string_view keyword = in.word();
    if (keyword == "End") {
      break;
    } else if (keyword == "Dimension") {
      if (in.integer() != 3) throw unread_variant(source, "a plane mesh", "Dimension 3");
    } else if ((keyword == "Vertices" && !contents.nodes.empty()) ||
               (keyword == "Tetrahedra" && !contents.tets.empty())) {
      throw unread_variant(source, fmt::format("a second section '{}'", keyword), "one of each");
    } else if (keyword == "Vertices") {
      read_vertices(in, contents);
    } else if (keyword == "Tetrahedra") {
      read_tetrahedra(in, contents);
    } else if (const auto skipped = kSkippedSections.find(keyword); skipped != kSkippedSections.end()) {
      const std::size_t numbers = in.count(2 * skipped->second) * skipped->second;
      for (std::size_t i = 0; i < numbers; ++i) in.number();
    } else if (in.at_end() || in.word() != "0") {  // "Hexahedra 0" says that there are none
      throw wrong_element(source, fmt::format("an entry '{}'", keyword.substr(0, 30)));
    }
  }
  return contents;
}

}  // namespace softreel::detail
