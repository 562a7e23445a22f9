// In a crowded cell trees find what one finds one by one.
#include "core/tetmesh/cells/cell_triangles.h"

#include <random>
#include <set>

#include <gtest/gtest.h>

#include "core/tetmesh/surface/surface_parts.h"

namespace softreel {
namespace {

/// Small triangles all over the unit cube, and the cuts of the cell of a lattice of 2 m that holds its middle.
struct Crowd {
  std::mt19937 random{7};
  SurfaceMesh mesh;
  LatticeSurface surface;
  BccCell cell;
  std::vector<CellCut> cuts;

  Crowd() {
    for (Index t = 0; t < 4000; ++t) {
      const Vec3 place = point();
      for (int k = 0; k < 3; ++k) mesh.positions.push_back(place + 0.1 * point());
      mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    surface = make_lattice_surface(mesh, find_parts(mesh), {Vec3(0.1, 0.2, 0.3), 2});
    cell = cell_at(Vec3(0.4, 0.3, 0.2));
    for (const CellCut& cut : cut_cells(surface, Threads(1)))
      if (cut.cell == cell_key(cell)) cuts.push_back(cut);
  }

  Vec3 point() {
    std::uniform_real_distribution<double> coordinate(0, 1);
    return {coordinate(random), coordinate(random), coordinate(random)};
  }
  Vec3 point_in_cell() {
    for (;;)
      if (const Vec3 p = point(); in_cell(cell_weights(cell, p))) return p;
  }
};

TEST(CellTriangles, MeetsWithALineWhatAllTogetherDo) {
  Crowd crowd;
  CellTriangles triangles(crowd.surface, crowd.cell, crowd.cuts);
  ASSERT_GT(crowd.cuts.size(), 400U);
  std::size_t hits = 0, visits = 0;
  for (int line = 0; line < 100; ++line) {
    const Vec3 from = crowd.point_in_cell(), along = crowd.point_in_cell() - from;
    const auto is_met = [&](std::size_t cut) {
      const double t = triangles.meet(cut, from, along);
      return t > 0 && t < 1;
    };
    std::set<std::size_t> expected, found;
    for (std::size_t i = 0; i < crowd.cuts.size(); ++i)
      if (is_met(i)) expected.insert(i);
    triangles.visit_along(from, along, 1, [&](std::size_t i) {
      ++visits;
      if (is_met(i)) found.insert(i);
    });
    EXPECT_EQ(found, expected);
    hits += expected.size();
  }
  EXPECT_GT(hits, 100U);
  EXPECT_LT(visits, 100 * crowd.cuts.size() / 4);
}

TEST(CellTriangles, VisitsTheNearestOfAPointInOrder) {
  Crowd crowd;
  CellTriangles triangles(crowd.surface, crowd.cell, crowd.cuts);
  for (int query = 0; query < 100; ++query) {
    const Vec3 p = crowd.point_in_cell();
    const auto distance = [&](std::size_t cut) {
      const CellTriangles::Polygon& x = triangles.polygons()[cut];
      double least = (x[0] - p).norm();
      for (std::size_t k = 2; k < x.size(); ++k)
        least = std::min(least, (nearest_on_triangle(p, x[0], x[k - 1], x[k]) - p).norm());
      return least;
    };
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < crowd.cuts.size(); ++i)
      if (distance(i) < distance(nearest)) nearest = i;
    std::vector<std::size_t> visited;
    triangles.visit_nearest(p, 1e-7, [&](std::size_t i) { visited.push_back(i); });
    EXPECT_TRUE(std::is_sorted(visited.begin(), visited.end()));
    EXPECT_EQ(std::count(visited.begin(), visited.end(), nearest), 1);
    EXPECT_LT(visited.size(), 50U);
  }
}

}  // namespace
}  // namespace softreel
