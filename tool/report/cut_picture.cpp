#include "tool/report/cut_picture.h"

#include <array>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/report/cut_colors.h"

namespace softreel {
namespace {

std::array<Vec3, 4> corners_of(const TetMesh& mesh, Index element) {
  std::array<Vec3, 4> x;
  const Tet& tet = mesh.tets[static_cast<std::size_t>(element)];
  for (std::size_t k = 0; k < 4; ++k) x[k] = mesh.nodes[static_cast<std::size_t>(tet[k])];
  return x;
}

/// The outer surface first, then the tints from the worst to the best.
std::vector<MotionMesh> cut_meshes(const TetMesh& mesh, const MeshCut& cut) {
  Bounds box;
  for (const CutFace& face : cut.faces)
    for (const Index node : face.nodes) box.add(mesh.nodes[static_cast<std::size_t>(node)]);
  const StudioPlace place(box);
  std::vector<MotionMesh> meshes{studio_mesh("outer", outer_color(), outer_line_color(), kCutLineWidth)};
  for (std::size_t k = 0; k < kAngleTints; ++k)
    meshes.push_back(studio_mesh("cut", angle_tint_color(k), cut_line_color(), kCutLineWidth));
  for (const CutFace& face : cut.faces) {
    std::array<Vec3f, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = place(mesh.nodes[static_cast<std::size_t>(face.nodes[k])]);
    add_triangle(meshes[face.outer ? 0 : 1 + angle_tint(corners_of(mesh, face.element))], p[0], p[1], p[2]);
  }
  return meshes;
}

}  // namespace

void check_cut_picture(const PictureOptions& options) {
  check_cut(options.cut);
  check_picture(options);
}

std::string draw_cut_picture(const TetMesh& mesh, const PictureOptions& options, const Threads& threads) {
  const CutSpace space = cut_space({&mesh});
  const CutPlane plane = cut_plane(options.cut, space.box, space.center);
  const MeshCut cut = cut_mesh(mesh, plane);
  if (cut.kept == 0)
    throw input_error(
        fmt::format("--cut {}: no element lies behind the plane.\n  Accepted: a plane that leaves a part "
                    "of the mesh. Move it, or look from the other side.",
                    options.cut));
  draw_in_studio(cut_meshes(mesh, cut), plane.normal, options, threads);
  return fmt::format(
      "{}: {} of {} elements; at the cut tinted by their smallest dihedral angle, from red (0 degrees) to sand (60)",
      options.path, cut.kept, mesh.tets.size());
}

}  // namespace softreel
