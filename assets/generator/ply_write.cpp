#include "assets/generator/ply_write.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>

#include "core/base/error.h"
#include "core/base/srgb.h"

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
  if (!mesh.colors.empty())
    for (const char* color : {"red", "green", "blue"}) text += std::string("property uchar ") + color + "\n";
  for (const VertexGroup& group : mesh.groups) text += "property uchar group_" + group.name + "\n";
  text += "element face " + std::to_string(mesh.triangles.size()) + "\n";
  text += "property list uchar int vertex_indices\n";
  if (!mesh.triangle_textures.empty()) text += "property list uchar float texcoord\n";
  return text + "end_header\n";
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
    if (!mesh.colors.empty())
      for (int k = 0; k < 3; ++k)
        append(bytes, static_cast<unsigned char>(std::lround(255 * srgb_encode(mesh.colors[v][k]))));
    for (const auto& flag : flags) append(bytes, flag[v]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    append(bytes, static_cast<unsigned char>(3));
    for (const Index v : mesh.triangles[t]) append(bytes, v);
    if (mesh.triangle_textures.empty()) continue;
    append(bytes, static_cast<unsigned char>(6));
    for (const Index c : mesh.triangle_textures[t])
      for (int k = 0; k < 2; ++k)
        append(bytes, static_cast<float>(mesh.texture_coordinates[static_cast<std::size_t>(c)][k]));
  }
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw work_error(path + " cannot be written. Give a folder that exists and has room.");
}

}  // namespace softreel::sculpt
