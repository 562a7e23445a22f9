#include "assets/generator/ply_write.h"

#include <bit>
#include <cstring>
#include <fstream>

#include "core/base/error.h"

namespace softreel::sculpt {

namespace {

static_assert(std::endian::native == std::endian::little);

template <typename T>
void append(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

std::string header(const SurfaceMesh& mesh) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment made by assets/generator\n";
  text += "element vertex " + std::to_string(mesh.positions.size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) text += std::string("property float ") + axis + "\n";
  for (const VertexGroup& group : mesh.groups) text += "property uchar group_" + group.name + "\n";
  text += "element face " + std::to_string(mesh.triangles.size()) + "\n";
  return text + "property list uchar int vertex_indices\nend_header\n";
}

}  // namespace

void write_ply(const SurfaceMesh& mesh, const std::string& path) {
  std::vector<std::vector<unsigned char>> flags;
  for (const VertexGroup& group : mesh.groups) {
    flags.emplace_back(mesh.positions.size(), static_cast<unsigned char>(0));
    for (const Index v : group.vertices) flags.back()[static_cast<std::size_t>(v)] = 1;
  }
  std::string bytes = header(mesh);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    for (int k = 0; k < 3; ++k) append(bytes, static_cast<float>(mesh.positions[v][k]));
    for (const auto& flag : flags) append(bytes, flag[v]);
  }
  for (const Triangle& triangle : mesh.triangles) {
    append(bytes, static_cast<unsigned char>(3));
    for (const Index v : triangle) append(bytes, v);
  }
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw work_error(path + " cannot be written. Give a folder that exists and has room.");
}

}  // namespace softreel::sculpt
