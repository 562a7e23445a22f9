/// The checks that all formats of given tetrahedra share.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "core/tetmesh/files/tet_file.h"
#include "core/tetmesh/files/tet_mesh_file.h"

namespace softreel {
namespace {

using detail::MeshSource;
using detail::TetFileContents;

/// An element is flat if its volume is below this share of its longest edge cubed: a sliver of a millionth of a degree.
constexpr double kFlat = 1e-9;

struct Format {
  const char* extension;
  TetFileContents (*read)(const MeshSource&);
};
constexpr Format kFormats[] = {
    {".mesh", detail::read_medit}, {".msh", detail::read_gmsh}, {".vtk", detail::read_vtk}, {".vtu", detail::read_vtu}};

void check_nodes(const MeshSource& source, const TetFileContents& contents) {
  for (std::size_t i = 0; i < contents.nodes.size(); ++i)
    if (!contents.nodes[i].allFinite())
      throw broken_file(source, "", fmt::format("node {} has a coordinate that is not finite", i + 1),
                        "finite coordinates", "Mend it in the tool that made it");
  if (contents.tets.empty())
    throw broken_file(source, "", "it has no tetrahedra", "at least one",
                      "Mesh the inside of the body, not its surface");
}

Tet checked_tet(const MeshSource& source, const TetFileContents& contents, std::size_t e) {
  Tet tet;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::int64_t node = contents.tets[e][k];
    if (node < 0 || node >= static_cast<std::int64_t>(contents.nodes.size()))
      throw broken_file(
          source, "",
          fmt::format("tetrahedron {} refers to node {}, counted from 0, which the file does not have", e + 1, node),
          fmt::format("one of the file's {}", contents.nodes.size()), "Export the mesh again; the file may be cut off");
    tet[k] = static_cast<Index>(node);
  }
  return tet;
}

void check_fill(const MeshSource& source, const TetFileContents& contents) {
  if (contents.fill.empty()) return;
  if (contents.fill.size() != contents.tets.size())
    throw broken_file(source, "", fmt::format("it has {} values of fill", contents.fill.size()),
                      fmt::format("one for each of its {} tetrahedra", contents.tets.size()), "Write the mesh again");
  for (std::size_t e = 0; e < contents.fill.size(); ++e)
    if (!(contents.fill[e] > 0 && contents.fill[e] <= 1))
      throw broken_file(source, "", fmt::format("tetrahedron {} is filled by a share of {}", e + 1, contents.fill[e]),
                        "above 0, up to 1", "Leave the cell data \"fill\" out if it means something else");
}

/// Turns an inverted element round; true if it was one.
bool orient(const MeshSource& source, const std::vector<Vec3>& nodes, std::size_t e, Tet& tet) {
  std::array<Vec3, 4> x;
  for (std::size_t k = 0; k < 4; ++k) x[k] = nodes[static_cast<std::size_t>(tet[k])];
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) longest = std::max(longest, (x[i] - x[j]).norm());
  const double volume = tet_volume(x[0], x[1], x[2], x[3]);
  if (!(std::abs(volume) > kFlat * longest * longest * longest))
    throw broken_file(source, "", fmt::format("tetrahedron {} has no volume ({:.3g} m^3)", e + 1, volume),
                      "elements with volume", "Mesh the body again with a bound on the quality of elements");
  if (volume < 0) std::swap(tet[2], tet[3]);
  return volume < 0;
}

/// Moves what is found right into the mesh; returns how many elements were turned round. What the file had is gone
/// before the faces are looked at, which take more.
std::size_t take_contents(const MeshSource& source, TetFileContents contents, TetMesh& mesh) {
  check_nodes(source, contents);
  check_fill(source, contents);
  std::size_t inverted = 0;
  mesh.tets.reserve(contents.tets.size());
  for (std::size_t e = 0; e < contents.tets.size(); ++e) {
    mesh.tets.push_back(checked_tet(source, contents, e));
    inverted += orient(source, contents.nodes, e, mesh.tets.back()) ? 1 : 0;
  }
  mesh.nodes = std::move(contents.nodes);
  mesh.fill = std::move(contents.fill);
  return inverted;
}

/// Leaves out the nodes that no element uses; returns their number.
std::size_t drop_unused_nodes(TetMesh& mesh) {
  std::vector<Index> number(mesh.nodes.size(), -1);
  for (const Tet& tet : mesh.tets)
    for (const Index node : tet) number[static_cast<std::size_t>(node)] = 0;
  std::size_t used = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    mesh.nodes[used] = mesh.nodes[i];
    number[i] = static_cast<Index>(used++);
  }
  const std::size_t dropped = mesh.nodes.size() - used;
  mesh.nodes.resize(used);
  for (Tet& tet : mesh.tets)
    for (Index& node : tet) node = number[static_cast<std::size_t>(node)];
  return dropped;
}

/// Leaves each element out that has the nodes of one before it. numbers: those of the elements in the file.
void drop_repeated_tets(TetMesh& mesh, std::vector<std::size_t>& numbers) {
  std::vector<std::pair<Tet, std::size_t>> sorted;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    sorted.emplace_back(mesh.tets[e], e);
    std::sort(sorted.back().first.begin(), sorted.back().first.end());
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> repeated(mesh.tets.size(), false);
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (sorted[i].first == sorted[i - 1].first) repeated[sorted[i].second] = true;
  std::size_t kept = 0;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    if (repeated[e]) continue;
    mesh.tets[kept] = mesh.tets[e];
    if (!mesh.fill.empty()) mesh.fill[kept] = mesh.fill[e];
    numbers[kept++] = e;
  }
  mesh.tets.resize(kept);
  if (!mesh.fill.empty()) mesh.fill.resize(kept);
}

/// Elements that lie in one place are no mesh: left out where they are the same, refused else. Returns how many were
/// left out.
std::size_t mend_overlaps(const MeshSource& source, TetMesh& mesh) {
  if (!find_overlap_at_face(mesh)) return 0;
  std::vector<std::size_t> numbers(mesh.tets.size());
  const std::size_t before = mesh.tets.size();
  drop_repeated_tets(mesh, numbers);
  if (const auto overlap = find_overlap_at_face(mesh))
    throw broken_file(source, "",
                      fmt::format("tetrahedra {} and {} overlap: they lie on one side of a face that they share",
                                  numbers[at((*overlap)[0])] + 1, numbers[at((*overlap)[1])] + 1),
                      "at most two tetrahedra at a face, one on each side",
                      "Leave one of them out, or mesh the body again");
  return before - mesh.tets.size();
}

/// Faces of one piece that lie on one of another without shared nodes. Not of whole lattice tetrahedra, which know
/// their fill: there limbs side by side are apart on purpose.
std::size_t count_parted_faces(const TetMesh& mesh, const std::vector<Index>& piece_of) {
  if (!mesh.fill.empty()) return 0;
  const std::vector<Index> weld = weld_positions(mesh.nodes);
  std::map<Triangle, Index> pieces;  // by welded nodes
  std::size_t parted = 0;
  for (const BoundaryFace& face : find_boundary(mesh)) {
    Triangle key;
    for (std::size_t k = 0; k < 3; ++k) key[k] = weld[static_cast<std::size_t>(face.nodes[k])];
    std::sort(key.begin(), key.end());
    const Index piece = piece_of[static_cast<std::size_t>(face.element)];
    const auto [first, is_new] = pieces.try_emplace(key, piece);
    parted += !is_new && first->second != piece ? 1 : 0;
  }
  return parted;
}

void warn_of_parted_pieces(const std::string& name, const TetMesh& mesh, const Log& log) {
  const std::vector<Index> piece_of = face_connected_pieces(mesh);
  const Index pieces = piece_of.empty() ? 0 : *std::max_element(piece_of.begin(), piece_of.end()) + 1;
  if (pieces <= 1) return;
  if (const std::size_t parted = count_parted_faces(mesh, piece_of); parted > 0)
    log.warn(fmt::format(
        "{}: its tetrahedra are {} pieces, which come apart although they touch at {} faces: the nodes there "
        "are equal but not shared. Accepted: this mesh, as it is. Merge equal nodes if it is one body.",
        name, pieces, parted));
}

}  // namespace

bool is_tet_mesh_extension(const std::string& extension) {
  return std::any_of(std::begin(kFormats), std::end(kFormats),
                     [&](const Format& format) { return extension == format.extension; });
}

bool is_tet_mesh_file(const std::string& path) {
  const std::string extension = detail::lower_extension(path);
  if (!is_tet_mesh_extension(extension)) return false;
  constexpr std::string_view kOgre{"\0\x10[MeshSerializer", 17};
  std::string head(kOgre.size(), ' ');
  std::ifstream(path, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
  return head != kOgre;
}

TetMesh read_tet_mesh(const std::string& path, const Log& log) {
  return decode_tet_mesh(path, detail::read_mesh_file(path), detail::lower_extension(path), log);
}

TetMesh decode_tet_mesh(const std::string& name, std::string_view bytes, const std::string& extension, const Log& log) {
  const MeshSource source{name, detail::text_of({name, bytes})};  // all four begin with text
  const Format* const format =
      std::find_if(std::begin(kFormats), std::end(kFormats), [&](const Format& f) { return extension == f.extension; });
  if (format == std::end(kFormats))
    throw detail::unread_variant(source, fmt::format("the format '{}' of tetrahedra", extension),
                                 ".mesh (Medit), .msh (Gmsh), .vtk, .vtu (VTK)");
  TetMesh mesh;
  const std::size_t inverted = take_contents(source, format->read(source), mesh);
  if (inverted > 0) log.info(fmt::format("{}: {} inverted tetrahedra were turned round", name, inverted));
  if (const std::size_t repeated = mend_overlaps(source, mesh); repeated > 0)
    log.info(fmt::format("{}: {} tetrahedra that it has twice were left out", name, repeated));
  if (const std::size_t dropped = drop_unused_nodes(mesh); dropped > 0)
    log.info(fmt::format("{}: {} nodes that no tetrahedron uses were left out", name, dropped));
  warn_of_parted_pieces(name, mesh, log);
  return mesh;
}

}  // namespace softreel
