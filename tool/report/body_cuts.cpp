#include "tool/report/body_cuts.h"

#include <array>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "tool/report/cut_colors.h"
#include "tool/report/studio.h"

namespace softreel {
namespace {

const Vec3& at(const std::vector<Vec3>& nodes, Index node) {
  return nodes[static_cast<std::size_t>(node)];
}

/// The faces of one kind.
struct Faces {
  const TetMesh& mesh;
  const std::vector<Vec3>& nodes;
  const std::vector<float>& heat;

  MotionMesh empty_mesh(bool outer, int width) const {
    const float line_width = kCutLineWidth * static_cast<float>(width) / 1600;
    return studio_mesh("", outer_color(), outer || !heat.empty() ? outer_line_color() : cut_line_color(), line_width);
  }
  void add(const CutFace& face, MotionMesh& mesh_of_kind) const {
    std::array<Vec3f, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = at(nodes, face.nodes[k]).cast<float>();
    add_triangle(mesh_of_kind, p[0], p[1], p[2]);
    SurfaceColoring& coloring = mesh_of_kind.coloring;
    if (!heat.empty())
      coloring.heat.insert(coloring.heat.end(), 3, heat[static_cast<std::size_t>(face.element)]);
    else if (!face.outer)
      coloring.colors.insert(coloring.colors.end(), 3, tint(face.element));
  }
  Vec3f tint(Index element) const {
    std::array<Vec3, 4> corners;
    const Tet& tet = mesh.tets[static_cast<std::size_t>(element)];
    for (std::size_t k = 0; k < 4; ++k) corners[k] = at(nodes, tet[k]);
    return angle_tint_color(angle_tint(corners));
  }
};

}  // namespace

BodyCuts::BodyCuts(std::vector<const TetMesh*> meshes, const std::string& cut) : meshes_(std::move(meshes)) {
  const CutSpace space = cut_space(meshes_);
  plane_ = cut_plane(cut, space.box, space.center);
  std::int64_t kept = 0;
  for (const TetMesh* mesh : meshes_) {
    cuts_.push_back(cut_mesh(*mesh, plane_));
    kept += cuts_.back().kept;
  }
  if (kept == 0)
    throw input_error(
        fmt::format("--cut {}: no element of a body at rest lies behind the plane.\n  Accepted: a plane that leaves a "
                    "part of the bodies. Move it, or look from the other side.",
                    cut));
}

void BodyCuts::add_meshes(std::size_t body, const std::vector<Vec3>& nodes, const std::vector<float>& heat, int width,
                          std::vector<MotionMesh>& meshes) const {
  const Faces faces{*meshes_[body], nodes, heat};
  CHECK(nodes.size() == faces.mesh.nodes.size());
  if (!heat.empty()) CHECK(heat.size() == faces.mesh.tets.size());
  for (const bool outer : {true, false}) {
    MotionMesh of_kind = faces.empty_mesh(outer, width);
    for (const CutFace& face : cuts_[body].faces)
      if (face.outer == outer) faces.add(face, of_kind);
    if (!of_kind.triangles.empty()) meshes.push_back(std::move(of_kind));
  }
}

bool BodyCuts::keeps(std::size_t body, Index element) const {
  return is_behind(*meshes_[body], element, plane_);
}

}  // namespace softreel
