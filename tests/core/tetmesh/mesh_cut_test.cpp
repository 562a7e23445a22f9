#include "core/tetmesh/mesh_cut.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/bcc_bar.h"

namespace softreel {
namespace {

using testing::bcc_bar;
using testing::centroid;

const CutPlane kSlanted{Vec3(1.6, 1.1, 0.9), Vec3(2, 0.7, -0.4)};

/// The kept elements alone, by the definition of the cut.
TetMesh kept_part(const TetMesh& mesh, const CutPlane& plane) {
  TetMesh part{mesh.nodes, {}, {}};
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    if ((centroid(mesh, e) - plane.point).dot(plane.normal) <= 0) part.tets.push_back(mesh.tets[e]);
  return part;
}

Triangle sorted(Triangle triangle) {
  std::sort(triangle.begin(), triangle.end());
  return triangle;
}

/// Volume that the faces enclose, by the divergence theorem.
double enclosed_volume(const TetMesh& mesh, const std::vector<CutFace>& faces) {
  double volume = 0;
  for (const CutFace& face : faces) {
    const auto x = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(face.nodes[k])]; };
    volume += x(0).dot(x(1).cross(x(2))) / 6;
  }
  return volume;
}

TEST(CutMesh, FacesAreTheBoundaryOfWhatIsKeptAndEncloseItsVolume) {
  const TetMesh mesh = bcc_bar({4, 3, 3}, 1), part = kept_part(mesh, kSlanted);
  const MeshCut cut = cut_mesh(mesh, kSlanted);
  EXPECT_GT(cut.kept, 0);
  EXPECT_LT(cut.kept, static_cast<std::int64_t>(mesh.tets.size()));
  EXPECT_EQ(cut.kept, static_cast<std::int64_t>(part.tets.size()));
  const std::vector<Triangle> boundary = boundary_faces(part);
  ASSERT_EQ(cut.faces.size(), boundary.size());
  for (std::size_t f = 0; f < boundary.size(); ++f) EXPECT_EQ(cut.faces[f].nodes, boundary[f]);
  double volume = 0;
  for (const Tet& t : part.tets) {
    const auto x = [&](std::size_t k) { return part.nodes[static_cast<std::size_t>(t[k])]; };
    volume += tet_volume(x(0), x(1), x(2), x(3));
  }
  EXPECT_NEAR(enclosed_volume(mesh, cut.faces), volume, 1e-12 * volume);
}

TEST(CutMesh, EachFaceIsThereOnceAndOuterExactlyWhereTheWholeEnds) {
  const TetMesh mesh = bcc_bar({4, 3, 3}, 1);
  std::set<Triangle> whole, seen;
  for (const Triangle& face : boundary_faces(mesh)) whole.insert(sorted(face));
  std::size_t outer = 0;
  for (const CutFace& face : cut_mesh(mesh, kSlanted).faces) {
    EXPECT_TRUE(seen.insert(sorted(face.nodes)).second);
    EXPECT_EQ(face.outer, whole.contains(sorted(face.nodes)));
    const Tet& tet = mesh.tets[static_cast<std::size_t>(face.element)];
    for (const Index node : face.nodes) EXPECT_NE(std::find(tet.begin(), tet.end(), node), tet.end());
    outer += face.outer ? 1 : 0;
  }
  EXPECT_GT(outer, 0U);
  EXPECT_LT(outer, seen.size());
}

TEST(CutMesh, BothSidesOfAPlaneShareTheCutAndSplitTheBoundary) {
  const TetMesh mesh = bcc_bar({4, 3, 3}, 1);
  const MeshCut front = cut_mesh(mesh, kSlanted), back = cut_mesh(mesh, {kSlanted.point, -kSlanted.normal});
  EXPECT_EQ(front.kept + back.kept, static_cast<std::int64_t>(mesh.tets.size()));
  const auto cut_faces = [](const MeshCut& cut) {
    std::set<Triangle> faces;
    for (const CutFace& face : cut.faces)
      if (!face.outer) faces.insert(sorted(face.nodes));
    return faces;
  };
  EXPECT_EQ(cut_faces(front), cut_faces(back));
  const std::size_t outer = front.faces.size() + back.faces.size() - 2 * cut_faces(front).size();
  EXPECT_EQ(outer, boundary_faces(mesh).size());
}

TEST(CutMesh, APlaneBesideTheMeshKeepsAllOrNothing) {
  const TetMesh mesh = bcc_bar({2, 2, 2}, 1);
  const MeshCut all = cut_mesh(mesh, {Vec3(9, 0, 0), Vec3(1, 0, 0)});
  EXPECT_EQ(all.kept, static_cast<std::int64_t>(mesh.tets.size()));
  EXPECT_EQ(all.faces.size(), boundary_faces(mesh).size());
  EXPECT_TRUE(std::all_of(all.faces.begin(), all.faces.end(), [](const CutFace& face) { return face.outer; }));
  const MeshCut none = cut_mesh(mesh, {Vec3(-9, 0, 0), Vec3(1, 0, 0)});
  EXPECT_EQ(none.kept, 0);
  EXPECT_TRUE(none.faces.empty());
}

}  // namespace
}  // namespace softreel
