/// Reads triangles and quads of plain OBJ and OFF files for tests, so that they need no importer.
#pragma once

#include <fstream>
#include <sstream>
#include <string>

#include "core/mesh/surface_mesh.h"

namespace softreel::test {

/// Fans of a polygon.
inline void add_polygon(SurfaceMesh& mesh, const std::vector<Index>& corners) {
  for (std::size_t k = 2; k < corners.size(); ++k) mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
}

/// Positions and triangles of an .obj or .off file; empty if it cannot be opened.
inline SurfaceMesh read_tiny_mesh(const std::string& path) {
  SurfaceMesh mesh;
  std::ifstream file(path);
  std::string line, word;
  const bool off = path.ends_with(".off");
  if (off) {
    std::size_t vertices = 0, faces = 0, edges = 0;
    file >> word >> vertices >> faces >> edges;
    mesh.positions.resize(vertices);
    for (Vec3& p : mesh.positions) file >> p[0] >> p[1] >> p[2];
    for (std::size_t f = 0; f < faces; ++f) {
      std::size_t count = 0;
      file >> count;
      std::vector<Index> corners(count);
      for (Index& corner : corners) file >> corner;
      std::getline(file, line);
      add_polygon(mesh, corners);
    }
    return mesh;
  }
  while (std::getline(file, line)) {
    std::istringstream words(line);
    words >> word;
    if (words && word == "v") {
      Vec3 p;
      words >> p[0] >> p[1] >> p[2];
      mesh.positions.push_back(p);
    } else if (words && word == "f") {
      std::vector<Index> corners;
      while (words >> word) corners.push_back(std::stoi(word) - 1);
      add_polygon(mesh, corners);
    }
  }
  return mesh;
}

}  // namespace softreel::test
