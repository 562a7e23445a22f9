/// The tetrahedra of moving bodies behind a plane, as meshes of a scene.
#pragma once

#include <string>
#include <vector>

#include "render/scene/scene.h"
#include "tool/report/cut_plane.h"

namespace softreel {

/// Bodies cut at rest: the same elements are there in every frame, so that none appears or vanishes while it moves.
class BodyCuts {
 public:
  /// One plane through all bodies; shares of the box and the middle are those of all together. cut: as --cut has it.
  /// meshes: kept by pointer. Throws input_error for no plane, or one that nothing lies behind.
  BodyCuts(std::vector<const TetMesh*> meshes, const std::string& cut);

  /// Adds what is seen of a body, with a line along every edge: the faces of its boundary, and those that the cut lays
  /// bare. Each face has one colour. Nothing where the body lies before the plane.
  ///
  /// nodes: deformed, m. heat: per element, place in the colour map; empty: boundary blue, the cut tinted by the
  /// smallest dihedral angle of the deformed element. width: pixels of the picture, for the lines.
  void add_meshes(std::size_t body, const std::vector<Vec3>& nodes, const std::vector<float>& heat, int width,
                  std::vector<MotionMesh>& meshes) const;

  /// Whether an element lies behind the plane.
  bool keeps(std::size_t body, Index element) const;

 private:
  std::vector<const TetMesh*> meshes_;
  CutPlane plane_;
  std::vector<MeshCut> cuts_;  ///< per body
};

}  // namespace softreel
