/// Cells of VTK's two formats as tetrahedra.
#pragma once

#include "core/tetmesh/files/tet_file.h"

namespace softreel::detail {

/// Takes the tetrahedra out of VTK's cells: cell i has the nodes [offsets[i], offsets[i + 1]) of `connectivity` and
/// the type types[i]. Cells of lower dimension are skipped, others of three dimensions refused.
inline void add_vtk_cells(const MeshSource& source, const std::vector<double>& connectivity,
                          const std::vector<double>& offsets, const std::vector<double>& types,
                          TetFileContents& contents) {
  constexpr double kTetra = 10;
  const auto is_flat = [](double type) { return (type >= 0 && type <= 9) || (type >= 21 && type <= 23); };
  if (offsets.size() != types.size() + 1)
    throw broken_file(source, "", fmt::format("{} cells have {} offsets", types.size(), offsets.size() - 1), "one each",
                      "Export the mesh again");
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (is_flat(types[i])) continue;
    if (types[i] != kTetra) throw wrong_element(source, fmt::format("cells of VTK's type {}", types[i]));
    if (!(offsets[i] >= 0) || offsets[i + 1] != offsets[i] + 4 ||
        !(offsets[i + 1] <= static_cast<double>(connectivity.size())))
      throw broken_file(source, "", fmt::format("tetrahedron {} does not have 4 nodes", i), "4 nodes each",
                        "Export the mesh again");
    std::array<std::int64_t, 4> tet;
    const auto first = static_cast<std::size_t>(offsets[i]);
    for (std::size_t k = 0; k < 4; ++k) {
      const double node = connectivity[first + k];
      tet[k] = node >= 0 && node < 4e9 ? static_cast<std::int64_t>(node) : -1;
    }
    contents.tets.push_back(tet);
  }
}

}  // namespace softreel::detail
