/// Surface meshes out of assimp; with assimp_scene_reader.cpp the only place that knows it.
#include "core/mesh/readers/assimp_reader.h"

#include <algorithm>
#include <map>

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "core/mesh/readers/assimp_loading.h"
#include "core/mesh/readers/mesh_source.h"
#include "core/mesh/readers/text_scanner.h"
#include "core/mesh/readers/vertex_colors.h"

namespace softreel::detail {
namespace {

/// Puts the meshes of an assimp scene together in the order of its nodes. Checks what it follows: assimp's own
/// validation also refuses sound meshes, for the sake of lights and cameras.
class SceneMerger {
 public:
  SceneMerger(const aiScene& scene, const std::string& path) : scene_(scene), path_(path) {}

  SurfaceMesh merge() {
    if (scene_.mRootNode != nullptr) add_node(*scene_.mRootNode, aiMatrix4x4());
    for (VertexGroup& group : mesh_.groups) {
      std::sort(group.vertices.begin(), group.vertices.end());
      group.vertices.erase(std::unique(group.vertices.begin(), group.vertices.end()), group.vertices.end());
    }
    if (mesh_.texture_coordinates.empty()) mesh_.polygons.corner_textures.clear();
    if (mesh_.groups.empty()) mesh_.polygons.polygon_groups.clear();
    std::vector<Index>& materials = mesh_.polygons.polygon_materials;
    if (std::all_of(materials.begin(), materials.end(), [](Index material) { return material < 0; })) materials.clear();
    if (!mesh_.colors.empty()) pad_colors(mesh_.colors, mesh_.positions.size());
    return std::move(mesh_);
  }

 private:
  void add_node(const aiNode& node, const aiMatrix4x4& parent) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      const unsigned number = node.mMeshes[m];
      if (number >= scene_.mNumMeshes || scene_.mMeshes[number] == nullptr)
        throw unusable_file(path_,
                            fmt::format("a node has mesh {}, but the file has {} meshes", number, scene_.mNumMeshes),
                            "Export it again, best as OBJ or PLY");
      add_mesh(*scene_.mMeshes[number], transform, node);
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c)
      if (node.mChildren[c] != nullptr) add_node(*node.mChildren[c], transform);
  }

  unsigned checked(unsigned corner, const aiMesh& part) const {
    if (corner < part.mNumVertices) return corner;
    throw unusable_file(
        path_,
        fmt::format("a face of mesh '{}' refers to vertex {} of {}", part.mName.C_Str(), corner, part.mNumVertices),
        "Export it again, best as OBJ or PLY");
  }

  void add_mesh(const aiMesh& part, const aiMatrix4x4& transform, const aiNode& node) {
    const auto first_vertex = static_cast<Index>(mesh_.positions.size());
    const auto first_texture = static_cast<Index>(mesh_.texture_coordinates.size());
    const bool has_textures = part.HasTextureCoords(0);
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D p = transform * part.mVertices[v];
      mesh_.positions.emplace_back(double{p.x}, double{p.y}, double{p.z});
      if (has_textures)
        mesh_.texture_coordinates.emplace_back(double{part.mTextureCoords[0][v].x},
                                               double{part.mTextureCoords[0][v].y});
    }
    add_colors(part);
    const auto [group, material] = add_names(part, node, first_vertex);
    const bool mirrored = transform.Determinant() < 0;
    PolygonList& polygons = mesh_.polygons;
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        const auto corner = static_cast<Index>(checked(face.mIndices[mirrored ? face.mNumIndices - 1 - k : k], part));
        polygons.corner_vertices.push_back(first_vertex + corner);
        polygons.corner_textures.push_back(has_textures ? first_texture + corner : -1);
      }
      if (!close_polygon(polygons)) continue;  // a point or a line
      polygons.polygon_groups.push_back(group);
      polygons.polygon_materials.push_back(material);
    }
  }

  /// Colours of a part's vertices, which are the last ones. Those of glTF are linear by its specification.
  void add_colors(const aiMesh& part) {
    if (!part.HasVertexColors(0)) return;
    pad_colors(mesh_.colors, mesh_.positions.size() - part.mNumVertices);
    const bool linear = has_linear_colors(path_);
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiColor4D& c = part.mColors[0][v];
      mesh_.colors.push_back(linear ? Vec3f(c.r, c.g, c.b) : displayed_color(double{c.r}, double{c.g}, double{c.b}));
    }
  }

  struct PartNames {
    Index group = -1, material = -1;
  };

  /// Makes the vertices from first_vertex on members of the groups of their names; returns the first, and that of the
  /// material unless assimp made it up.
  PartNames add_names(const aiMesh& part, const aiNode& node, Index first_vertex) {
    aiString material;
    if (part.mMaterialIndex < scene_.mNumMaterials)
      scene_.mMaterials[part.mMaterialIndex]->Get(AI_MATKEY_NAME, material);
    PartNames names;
    for (const aiString& name : {node.mName, part.mName, material}) {
      if (name.length == 0) continue;
      const auto [found, added] = group_of_.try_emplace(name.C_Str(), static_cast<Index>(mesh_.groups.size()));
      if (added) mesh_.groups.push_back({name.C_Str(), {}});
      if (names.group < 0) names.group = found->second;
      if (name == material && name != aiString(AI_DEFAULT_MATERIAL_NAME)) names.material = found->second;
      std::vector<Index>& vertices = mesh_.groups[static_cast<std::size_t>(found->second)].vertices;
      for (auto v = first_vertex; v < static_cast<Index>(mesh_.positions.size()); ++v) vertices.push_back(v);
    }
    return names;
  }

  const aiScene& scene_;
  const std::string& path_;
  SurfaceMesh mesh_;
  std::map<std::string, Index> group_of_;
};

/// What assimp says of a file that it could not read, in our words where it says nothing of the file.
Error read_error(const std::string& path, std::string_view said) {
  const std::string_view problem = trimmed(said);
  if (problem.starts_with("No suitable reader"))
    return unusable_file(
        path,
        "the mesh cannot be read: no reader knows this format, neither by the name's ending nor by the first bytes",
        "Export the mesh in one of these formats");
  return unusable_file(path,
                       fmt::format("the mesh cannot be read: {}", problem.substr(0, problem.find_last_not_of('.') + 1)),
                       "Export it again, best as OBJ or PLY");
}

}  // namespace

const aiScene* load_scene(Assimp::Importer& importer, const std::string& path, std::string& problem) {
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_LIGHTS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_CAMERAS, false);
  try {
    const aiScene* scene = importer.ReadFile(path, 0);
    problem = importer.GetErrorString();
    return scene;
  } catch (const std::exception& error) {
    problem = error.what();
    return nullptr;
  }
}

SurfaceMesh softreel_read_with_assimp(const std::string& path, const Log& log) {
  Assimp::Importer importer;
  std::string problem;
  const aiScene* scene = load_scene(importer, path, problem);
  if (scene == nullptr) throw read_error(path, problem);
  for (unsigned m = 0; m < scene->mNumMeshes; ++m)
    if (scene->mMeshes[m] != nullptr && (scene->mMeshes[m]->HasBones() || scene->mMeshes[m]->mNumAnimMeshes > 0)) {
      log.warn(fmt::format("{}: bones and shape keys are left out; the mesh is taken in its rest shape", path));
      break;
    }
  return SceneMerger(*scene, path).merge();
}

}  // namespace softreel::detail
