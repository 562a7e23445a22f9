#include "tests/support/broken_surfaces.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "tests/support/damaged_shapes.h"
#include "tests/support/surfaces.h"

namespace softreel::test {
namespace {

constexpr double kBallVolume = 4.0 / 3.0 * std::numbers::pi;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using Maker = std::function<SurfaceMesh()>;
using List = std::vector<BrokenSurface>;

void add(List& list, const char* name, Maker mesh, double volume, double tolerance = 0.04, Index pieces = 1) {
  list.push_back({name, std::move(mesh), 0.2, 0, volume, tolerance, pieces, ""});
}

void refuse(List& list, const char* name, Maker mesh, const char* says) {
  list.push_back({name, std::move(mesh), 0.2, 0, 0, 0, 0, says});
}

/// Gives the last one a size of its own.
void sized(List& list, double edge, double thickness = 0) {
  list.back().edge = edge;
  list.back().thickness = thickness;
}

void add_holes(List& list) {
  const auto cap = [](double height) { return std::numbers::pi * height * height * (3 - height) / 3; };
  const auto one_missing = [] {
    SurfaceMesh mesh = ball();
    mesh.triangles.erase(mesh.triangles.begin() + 300);
    return mesh;
  };
  add(list, "SmallHole", one_missing, kBallVolume);
  add(
      list, "ManySmallHoles", [] { return with_many_holes(ball()); }, kBallVolume);
  // What closes a large hole is not known: about a flat lid.
  add(
      list, "LargeHole", [] { return without(ball(), [](const Vec3& p) { return p.x() > 0.7; }); },
      kBallVolume - cap(0.3), 0.1);
  add(
      list, "MissingBase", [] { return without(ball(), [](const Vec3& p) { return p.y() < -0.3; }); },
      kBallVolume - cap(0.7), 0.1);
}

void add_faces(List& list) {
  const auto finned = [] {
    SurfaceMesh mesh = ball();
    const auto tip = static_cast<Index>(mesh.positions.size());
    mesh.positions.push_back(2 * mesh.positions[0]);
    mesh.triangles.push_back({mesh.triangles[0][0], mesh.triangles[0][1], tip});
    return mesh;
  };
  const auto with_some_more = [](Triangle (*made_from)(const Triangle&)) {
    return [made_from] { return with_some(ball(), made_from); };
  };
  add(
      list, "AllFlipped", [] { return flipped(ball()); }, kBallVolume);
  add(
      list, "SomeFlipped", [] { return some_flipped(ball(), 8); }, kBallVolume);
  add(
      list, "HalfFlipped", [] { return half_flipped(ball()); }, kBallVolume);
  add(list, "DuplicateFaces", with_some_more([](const Triangle& t) { return t; }), kBallVolume);
  add(list, "DuplicateFacesTurned", with_some_more([](const Triangle& t) {
        return Triangle{t[0], t[2], t[1]};
      }),
      kBallVolume);
  add(list, "DegenerateFaces", with_some_more([](const Triangle& t) {
        return Triangle{t[0], t[0], t[1]};
      }),
      kBallVolume);
  add(
      list, "FacesWithoutArea", [] { return with_slivers(ball()); }, kBallVolume);
  add(
      list, "TJunctions", [] { return with_t_junctions(ball()); }, kBallVolume);
  add(list, "FinOfOneTriangle", finned, kBallVolume, 0.15);
}

/// Edges of three faces and more, and surfaces that meet themselves in a vertex of the file.
void add_non_manifold(List& list) {
  add(list, "InnerWall", walled, 2, 0.06);
  // Welded at the waist, about one edge of the lattice thick.
  add(list, "HourglassOfOneWaistVertex", hourglass, 16.0 / 3, 0.06);
  sized(list, 0.1);
}

SurfaceMesh three_shells() {
  return with(with(ball(), flipped(ball(0.75))), ball(0.4));
}

/// Cubes of 1 m side by side: the other is `shift` away.
Maker two_cubes(const Vec3& shift) {
  return [shift] { return with(block(Vec3::Constant(0.5), Vec3::Zero()), block(Vec3::Constant(0.5), shift)); };
}

/// A ball and another.
Maker two_balls(double radius, const Vec3& center = Vec3::Zero()) {
  return [=] { return with(ball(), ball(radius, center)); };
}

/// A ball with a hollow in its middle.
Maker hollow_ball(double radius) {
  return [=] { return with(ball(), flipped(ball(radius))); };
}

void add_parts(List& list) {
  // Two unit balls 0.8 apart share a lens of pi (4 + d) (2 - d)^2 / 12.
  const double lens = std::numbers::pi * 4.8 * 1.2 * 1.2 / 12;
  add(list, "OverlappingBalls", two_balls(1, Vec3(0.8, 0, 0)), 2 * kBallVolume - lens, 0.06);
  // Two bars of which two pairs of sides lie in common planes.
  add(list, "OverlappingFaces", two_cubes(Vec3(0.5, 0, 0)), 1.5, 0.06);
  constexpr double radius = 0.2, length = 6.0972235;  // of the lemniscate; where it crosses itself, two cylinders do
  add(
      list, "CrossedTube", [] { return crossed_tube(radius); },
      std::numbers::pi * radius * radius * length - 16.0 / 3 * radius * radius * radius, 0.06);
  sized(list, 0.08);
  add(list, "Cavity", hollow_ball(0.5), kBallVolume * (1 - 0.125));
  add(list, "ShellInShell", two_balls(0.5), kBallVolume);
  constexpr double kThreeShells = kBallVolume * (1 - 0.421875 + 0.064);
  add(list, "ThreeShells", three_shells, kThreeShells, 0.04, 2);
  sized(list, 0.1);
  add(
      list, "ThreeShellsInsideOut", [] { return flipped(three_shells()); }, kThreeShells, 0.04, 2);
  sized(list, 0.1);
  add(list, "TwoPieces", two_balls(0.6, Vec3(3, 0, 0)), kBallVolume * 1.216, 0.04, 2);
  add(list, "SharedFace", two_cubes(Vec3(1, 0, 0)), 2, 0.06);
  // What hangs by a corner or an edge is welded there, about one edge of the lattice thick.
  add(list, "SharedEdge", two_cubes(Vec3(1, 1, 0)), 2, 0.12);
  add(list, "SharedCorner", two_cubes(Vec3(1, 1, 1)), 2, 0.08);
  refuse(list, "TinyPart", two_balls(0.01, Vec3(1.6, 0, 0)), "part 2 of 2");
  refuse(list, "ThinShell", hollow_ball(0.97), "too thin for the lattice");
}

void add_soups(List& list) {
  add(
      list, "Soup", [] { return soup(ball(), 0); }, kBallVolume);
  add(
      list, "RoundedSoup", [] { return soup(ball(), 3e-6); }, kBallVolume);
  add(
      list, "LooseSoup", [] { return soup(ball(), 3e-3); }, kBallVolume);
  add(
      list, "TurnedSoup", [] { return some_flipped(soup(ball(), 0), 2); }, kBallVolume);
}

void add_sheets(List& list) {
  const auto two_sided = [] { return with(sheet(), flipped(sheet())); };
  refuse(list, "OpenSheet", sheet, "thickness");
  refuse(list, "FinelyFilledSheet", sheet, "open sheet");
  sized(list, 0.05);
  add(
      list, "OpenBowl", [] { return without(ball(), [](const Vec3& p) { return p.y() > 0; }); }, 0.5 * kBallVolume,
      0.1);
  refuse(list, "OneSidedSheet", moebius, "thickness");
  add(list, "ThickSheet", sheet, 0.2 * 1.02, 0.08);
  sized(list, 0.1, 0.2);
  // Twice round: the middle line is 2 pi long, the strip is longer by its turn.
  add(list, "ThickOneSidedSheet", moebius, 0.2 * 0.6 * 2 * std::numbers::pi, 0.1);
  sized(list, 0.1, 0.2);
  refuse(list, "TwoSidedSheet", two_sided, "thickness");
  add(list, "ThickTwoSidedSheet", two_sided, 0.2 * 1.02, 0.08);
  sized(list, 0.1, 0.2);
  add(
      list, "ThickSheetInMicrometres", [] { return moved(sheet(), 1e-6, Vec3::Zero()); }, 0.2 * 1.02 * 1e-18, 0.08);
  sized(list, 1e-7, 2e-7);
  refuse(
      list, "BallOverGround", [] { return with(ball(), moved(sheet(), 20, Vec3(-10, -1.5, -10))); }, "open sheet");
  refuse(
      list, "FlatBox", [] { return block(Vec3(0.5, 0, 0.5), Vec3::Zero()); }, "flat");
  const auto triangle = [] {
    SurfaceMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
  };
  refuse(list, "OneTriangle", triangle, "flat");
  refuse(
      list, "NoTriangle", [] { return SurfaceMesh{}; }, "no triangles");
}

/// What is thinner than an edge of the lattice becomes about an edge thick and hangs together, if it belongs to a body
/// that is not; a body that is so thin everywhere is refused with the edge that it takes.
void add_thin(List& list) {
  constexpr double kThickened = 0.2;  // m: an edge
  const auto plate = [](double width, double depth) {
    return [=] { return block(Vec3(width, 0.03, depth), Vec3(0.013, 0.027, 0.011)); };
  };
  const auto limbs = [] {
    return with(with(ball(), block(Vec3(0.7, 0.04, 0.04), Vec3(1.5, 0.05, 0.03))),
                block(Vec3(0.04, 0.7, 0.04), Vec3(0.07, 1.5, 0.02)));
  };
  refuse(list, "ThinPlate", plate(1, 1), "an edge of about 0.057 m or less");
  refuse(list, "ThinRod", plate(1.5, 0.03), "an edge of about 0.03 m or less");
  refuse(
      list, "SmallerThanTheEdge", [] { return ball(0.05); }, "too thin for the lattice");
  add(list, "LimbsThinnerThanTheEdge", limbs, kBallVolume + 2 * 1.2 * kThickened * kThickened, 0.06);
  list.back().thin_volume = kBallVolume + 2 * 1.2 * 0.08 * 0.08;
  add(
      list, "WallThinnerThanTheEdge", [=] { return with(ball(), plate(1.5, 1.5)()); },
      kBallVolume + (9 - std::numbers::pi) * kThickened, 0.12);
  list.back().thin_volume = kBallVolume + (9 - std::numbers::pi) * 0.06;
  add(list, "SpeckOnABall", two_balls(0.05, Vec3(0, 1, 0)), kBallVolume);
}

/// Triangles of 1 mm beside those of 0.3 m.
SurfaceMesh mixed_sizes() {
  return with(make_sphere(1, 6, Vec3::Zero()), make_sphere(0.3, 200, Vec3(1, 0, 0)));
}

void add_scales(List& list) {
  const auto scaled = [&](const char* name, double factor, const Vec3& shift) {
    add(
        list, name, [=] { return moved(ball(), factor, shift); }, kBallVolume * factor * factor * factor);
    sized(list, 0.2 * factor);
  };
  scaled("Micrometres", 1e-6, Vec3::Zero());
  scaled("Megametres", 1e6, Vec3::Zero());
  scaled("FarFromTheOrigin", 1, Vec3(1e5, 1e5, -1e5));
  scaled("MillimetresFarFromTheOrigin", 1e-3, Vec3(1e2, 0, 0));
  const auto far_and_torn = [] {
    return moved(without(ball(), [](const Vec3& p) { return p.x() > 0.95; }), 1e-6, Vec3(1, 0, 0));
  };
  add(list, "MicrometresTornFarFromTheOrigin", far_and_torn, kBallVolume * 1e-18);
  sized(list, 2e-7);
  const double d = 1, r = 0.3;  // a lens of two balls, radii 1 and r, d apart
  const double lens =
      std::numbers::pi * std::pow(1 + r - d, 2) * (d * d + 2 * d * r - 3 * r * r + 2 * d + 6 * r - 3) / (12 * d);
  add(list, "MixedTriangleSizes", mixed_sizes, kBallVolume * 1.027 - lens, 0.06);
  const auto with_unused = [] {
    SurfaceMesh mesh = ball();
    mesh.positions.push_back(Vec3::Constant(1e9));
    mesh.positions.push_back(Vec3::Constant(kNaN));
    return mesh;
  };
  const auto without_numbers = [] {
    SurfaceMesh mesh = ball();
    mesh.positions[100][1] = kNaN;
    mesh.positions[200][0] = std::numeric_limits<double>::infinity();
    return mesh;
  };
  add(list, "FarUnusedVertices", with_unused, kBallVolume);
  add(list, "VerticesWithoutNumbers", without_numbers, kBallVolume);
}

}  // namespace

std::vector<BrokenSurface> broken_surfaces() {
  List list;
  add_holes(list);
  add_faces(list);
  add_non_manifold(list);
  add_parts(list);
  add_soups(list);
  add_sheets(list);
  add_thin(list);
  add_scales(list);
  return list;
}

}  // namespace softreel::test
