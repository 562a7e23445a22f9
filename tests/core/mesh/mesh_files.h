/// Small meshes for the tests: files in a folder of their own, and shapes with known facts.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/base/error.h"
#include "core/mesh/polygon_triangulation.h"
#include "core/mesh/readers/mesh_import.h"

namespace softreel::testing {

/// A folder that lasts as long as the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "softreel_test_XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string path(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, std::string_view bytes) const {
    std::ofstream(path(name), std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path(name);
  }

 private:
  std::filesystem::path path_;
};

/// Warnings of an import.
struct Warnings {
  std::vector<std::string> lines;
  Log log() {
    return {nullptr, [this](const std::string& line) { lines.push_back(line); }};
  }
};

inline SurfaceMesh import_text(const std::string& name, std::string_view text) {
  const TemporaryFolder folder;
  return import_mesh(folder.write(name, text), Log{});
}

/// What import_mesh says of a bad file; empty if it takes it.
inline std::string import_error(const std::string& name, std::string_view text) {
  try {
    import_text(name, text);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    return error.what();
  }
  return {};
}

/// A mesh of triangles only, as an importer would give it.
inline SurfaceMesh make_mesh(std::vector<Vec3> positions, const std::vector<Triangle>& triangles) {
  SurfaceMesh mesh;
  mesh.positions = std::move(positions);
  for (const Triangle& t : triangles) {
    mesh.polygons.corner_vertices.insert(mesh.polygons.corner_vertices.end(), t.begin(), t.end());
    mesh.polygons.offsets.push_back(static_cast<Index>(mesh.polygons.corner_vertices.size()));
  }
  triangulate_polygons(mesh);
  return mesh;
}

/// Adds a box of 12 outward triangles; turned inward on demand.
inline void add_box(SurfaceMesh& mesh, const Vec3& min, const Vec3& max, bool inward = false) {
  const auto first = static_cast<Index>(mesh.positions.size());
  for (int corner = 0; corner < 8; ++corner)
    mesh.positions.emplace_back((corner & 1) != 0 ? max.x() : min.x(), (corner & 2) != 0 ? max.y() : min.y(),
                                (corner & 4) != 0 ? max.z() : min.z());
  constexpr std::array<std::array<Index, 4>, 6> kSides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& side : kSides) {
    for (std::size_t k = 0; k < 4; ++k) mesh.polygons.corner_vertices.push_back(first + side[inward ? 3 - k : k]);
    mesh.polygons.offsets.push_back(static_cast<Index>(mesh.polygons.corner_vertices.size()));
  }
  triangulate_polygons(mesh);
}

inline SurfaceMesh unit_box() {
  SurfaceMesh mesh;
  add_box(mesh, Vec3::Zero(), Vec3::Ones());
  return mesh;
}

/// Path of a real test surface beside the project; empty where absent.
inline std::string shared_mesh(const std::string& name) {
  const std::filesystem::path path = std::filesystem::path(SOFTREEL_SOURCE_DIR) / "../shared/meshes" / name;
  return std::filesystem::exists(path) ? path.string() : std::string();
}

}  // namespace softreel::testing
