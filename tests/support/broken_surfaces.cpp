#include "tests/support/broken_surfaces.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <utility>

#include "tests/support/surfaces.h"

namespace softreel::test {
namespace {

constexpr double kBallVolume = 4.0 / 3.0 * std::numbers::pi;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using Random = std::mt19937;

bool one_in(Random& random, unsigned n) {
  return random() % n == 0;
}

SurfaceMesh ball(double radius = 1, const Vec3& center = Vec3::Zero()) {
  return make_sphere(radius, 12, center);
}

SurfaceMesh block(const Vec3& half, const Vec3& center) {
  return make_box(half, 1, center);
}

void flip(Triangle& t) {
  std::swap(t[1], t[2]);
}

SurfaceMesh flipped(SurfaceMesh mesh) {
  for (Triangle& t : mesh.triangles) flip(t);
  return mesh;
}

Vec3 centroid(const SurfaceMesh& mesh, const Triangle& t) {
  Vec3 sum = Vec3::Zero();
  for (const Index v : t) sum += mesh.positions[static_cast<std::size_t>(v)];
  return sum / 3;
}

/// Without the triangles for which `gone` holds.
SurfaceMesh without(SurfaceMesh mesh, const std::function<bool(const Vec3&)>& gone) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return gone(centroid(mesh, t)); });
  return mesh;
}

SurfaceMesh with(SurfaceMesh mesh, const SurfaceMesh& other) {
  append(mesh, other);
  return mesh;
}

SurfaceMesh moved(SurfaceMesh mesh, double factor, const Vec3& shift) {
  for (Vec3& p : mesh.positions) p = factor * p + shift;
  return mesh;
}

/// Every triangle with corners of its own, each rounded by up to `noise`.
SurfaceMesh soup(const SurfaceMesh& mesh, double noise) {
  Random random(5);
  std::uniform_real_distribution<double> off(-noise, noise);
  SurfaceMesh result;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<Index>(result.positions.size());
    for (const Index v : t)
      result.positions.push_back(mesh.positions[static_cast<std::size_t>(v)] +
                                 (noise > 0 ? Vec3(off(random), off(random), off(random)) : Vec3(Vec3::Zero())));
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

/// A wavy sheet of 1 x 1 m.
SurfaceMesh sheet() {
  constexpr Index n = 20;
  SurfaceMesh mesh;
  for (Index i = 0; i <= n; ++i)
    for (Index j = 0; j <= n; ++j) {
      const double x = static_cast<double>(i) / n, z = static_cast<double>(j) / n;
      mesh.positions.push_back({x, 0.05 * std::sin(6 * x) * std::cos(4 * z), z});
    }
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const Index a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  return mesh;
}

/// A strip with half a turn, 0.6 m wide on a circle of 1 m.
SurfaceMesh moebius() {
  constexpr Index n = 60;
  SurfaceMesh mesh;
  for (Index i = 0; i < n; ++i)
    for (const double s : {-0.3, -0.1, 0.1, 0.3}) {
      const double a = 2 * std::numbers::pi * i / n, r = 1 + s * std::cos(0.5 * a);
      mesh.positions.push_back({r * std::cos(a), s * std::sin(0.5 * a), r * std::sin(a)});
    }
  const auto vertex = [](Index i, Index k) { return i == n ? 3 - k : 4 * i + k; };
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < 3; ++k) {
      mesh.triangles.push_back({vertex(i, k), vertex(i + 1, k), vertex(i + 1, k + 1)});
      mesh.triangles.push_back({vertex(i, k), vertex(i + 1, k + 1), vertex(i, k + 1)});
    }
  return mesh;
}

/// A tube of radius `radius` round the lemniscate (sin a, sin a cos a) in the plane y = 0, which crosses itself at
/// right angles in the origin.
SurfaceMesh crossed_tube(double radius) {
  constexpr Index around = 160, across = 24;
  SurfaceMesh mesh;
  for (Index i = 0; i < around; ++i)
    for (Index j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
      const Vec3 center(std::sin(a), 0, std::sin(a) * std::cos(a)), along(std::cos(a), 0, std::cos(2 * a));
      const Vec3 side = along.cross(Vec3::UnitY()).normalized();
      mesh.positions.push_back(center + radius * (std::cos(b) * side + std::sin(b) * Vec3::UnitY()));
    }
  const auto vertex = [&](Index i, Index j) { return (i % around) * across + j % across; };
  for (Index i = 0; i < around; ++i)
    for (Index j = 0; j < across; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)});
    }
  return mesh;
}

/// Every fourth triangle is cut in two at the middle of a side; its neighbour across the side is not.
SurfaceMesh with_t_junctions(SurfaceMesh mesh) {
  const std::size_t count = mesh.triangles.size();
  for (std::size_t t = 0; t < count; t += 4) {
    const auto [a, b, c] = mesh.triangles[t];
    const auto middle = static_cast<Index>(mesh.positions.size());
    mesh.positions.push_back(
        0.5 * (mesh.positions[static_cast<std::size_t>(a)] + mesh.positions[static_cast<std::size_t>(b)]));
    mesh.triangles[t] = {a, middle, c};
    mesh.triangles.push_back({middle, b, c});
  }
  return mesh;
}

using List = std::vector<BrokenSurface>;

void add(List& list, const char* name, SurfaceMesh mesh, double volume, double tolerance = 0.04, Index pieces = 1) {
  list.push_back({name, std::move(mesh), 0.2, 0, volume, tolerance, pieces, ""});
}

void refuse(List& list, const char* name, SurfaceMesh mesh, const char* says) {
  list.push_back({name, std::move(mesh), 0.2, 0, 0, 0, 0, says});
}

void add_holes(List& list) {
  Random random(1);
  const auto cap = [](double height) { return std::numbers::pi * height * height * (3 - height) / 3; };
  SurfaceMesh one = ball();
  one.triangles.erase(one.triangles.begin() + 300);
  add(list, "SmallHole", std::move(one), kBallVolume);
  add(list, "ManySmallHoles", without(ball(), [&](const Vec3&) { return one_in(random, 20); }), kBallVolume);
  // What closes a large hole is not known: about a flat lid.
  add(list, "LargeHole", without(ball(), [](const Vec3& p) { return p.x() > 0.7; }), kBallVolume - cap(0.3), 0.1);
  add(list, "MissingBase", without(ball(), [](const Vec3& p) { return p.y() < -0.3; }), kBallVolume - cap(0.7), 0.1);
}

void add_faces(List& list) {
  Random random(2);
  add(list, "AllFlipped", flipped(ball()), kBallVolume);
  SurfaceMesh some = ball(), half = ball(), doubled = ball(), doubled_flipped = ball(), flat = ball();
  for (Triangle& t : some.triangles)
    if (one_in(random, 8)) flip(t);
  for (Triangle& t : half.triangles)
    if (centroid(half, t).x() > 0) flip(t);
  for (const Triangle& t : ball().triangles) {
    if (one_in(random, 4)) doubled.triangles.push_back(t);
    if (one_in(random, 4)) doubled_flipped.triangles.push_back({t[0], t[2], t[1]});
    if (one_in(random, 4)) flat.triangles.push_back({t[0], t[0], t[1]});
  }
  add(list, "SomeFlipped", std::move(some), kBallVolume);
  add(list, "HalfFlipped", std::move(half), kBallVolume);
  add(list, "DuplicateFaces", std::move(doubled), kBallVolume);
  add(list, "DuplicateFacesTurned", std::move(doubled_flipped), kBallVolume);
  add(list, "DegenerateFaces", std::move(flat), kBallVolume);
  // Slivers: the gap of a T-junction closed by a triangle without area, and without one.
  SurfaceMesh slivers = with_t_junctions(ball());
  for (std::size_t t = 0, middle = ball().positions.size(); middle < slivers.positions.size(); t += 4, ++middle) {
    const Triangle whole = ball().triangles[t];
    slivers.triangles.push_back({whole[0], whole[1], static_cast<Index>(middle)});
  }
  add(list, "FacesWithoutArea", std::move(slivers), kBallVolume);
  add(list, "TJunctions", with_t_junctions(ball()), kBallVolume);
  SurfaceMesh fin = ball();
  const auto tip = static_cast<Index>(fin.positions.size());
  fin.positions.push_back(2 * fin.positions[0]);
  fin.triangles.push_back({fin.triangles[0][0], fin.triangles[0][1], tip});
  add(list, "FinOfOneTriangle", std::move(fin), kBallVolume, 0.15);
}

/// Edges of three faces and more, and surfaces that meet themselves in a vertex of the file.
void add_non_manifold(List& list) {
  const Vec3 half = Vec3::Constant(0.5);
  SurfaceMesh walled = block(half, Vec3(0, 0, 0));
  append(walled, block(half, Vec3(1, 0, 0)));
  std::size_t walls = 0;
  std::erase_if(walled.triangles, [&](const Triangle& t) { return centroid(walled, t).x() == 0.5 && ++walls > 2; });
  add(list, "InnerWall", std::move(walled), 2, 0.06);
  SurfaceMesh hourglass;
  hourglass.positions = {{0, 0, 0}};
  for (const double y : {-2.0, 2.0}) {
    const auto first = static_cast<Index>(hourglass.positions.size());
    for (const auto& [x, z] : {std::pair{-1.0, -1.0}, {-1.0, 1.0}, {1.0, 1.0}, {1.0, -1.0}})
      hourglass.positions.push_back({x, y, z});
    for (Index k = 0; k < 4; ++k) {
      Triangle side{0, first + k, first + (k + 1) % 4};
      if (y < 0) flip(side);
      hourglass.triangles.push_back(side);
    }
    for (const Index k : {1, 2}) {
      Triangle base{first, first + k + 1, first + k};
      if (y < 0) flip(base);
      hourglass.triangles.push_back(base);
    }
  }
  // Welded at the waist, about one edge of the lattice thick.
  add(list, "HourglassOfOneWaistVertex", std::move(hourglass), 16.0 / 3, 0.06);
  list.back().edge = 0.1;
}

void add_parts(List& list) {
  // Two unit balls 0.8 apart share a lens of pi (4 + d) (2 - d)^2 / 12.
  const double lens = std::numbers::pi * 4.8 * 1.2 * 1.2 / 12;
  add(list, "OverlappingBalls", with(ball(), ball(1, Vec3(0.8, 0, 0))), 2 * kBallVolume - lens, 0.06);
  // Two bars of which two pairs of sides lie in common planes.
  add(list, "OverlappingFaces",
      with(block(Vec3(0.5, 0.5, 0.5), Vec3::Zero()), block(Vec3(0.5, 0.5, 0.5), Vec3(0.5, 0, 0))), 1.5, 0.06);
  const double radius = 0.2, length = 6.0972235;  // of the lemniscate; where the tube crosses itself, two cylinders do
  add(list, "CrossedTube", crossed_tube(radius),
      std::numbers::pi * radius * radius * length - 16.0 / 3 * radius * radius * radius, 0.06);
  list.back().edge = 0.08;
  add(list, "Cavity", with(ball(), flipped(ball(0.5))), kBallVolume * (1 - 0.125));
  add(list, "ShellInShell", with(ball(), ball(0.5)), kBallVolume);
  add(list, "ThreeShells", with(with(ball(), flipped(ball(0.75))), ball(0.4)), kBallVolume * (1 - 0.421875 + 0.064),
      0.04, 2);
  list.back().edge = 0.1;
  list.push_back(list.back());
  list.back().name = "ThreeShellsInsideOut";
  list.back().mesh = flipped(std::move(list.back().mesh));
  add(list, "TwoPieces", with(ball(), ball(0.6, Vec3(3, 0, 0))), kBallVolume * 1.216, 0.04, 2);
  add(list, "SharedFace", with(block(Vec3(0.5, 0.5, 0.5), Vec3(0, 0, 0)), block(Vec3(0.5, 0.5, 0.5), Vec3(1, 0, 0))), 2,
      0.06);
  // What hangs by a corner or an edge is welded there, about one edge of the lattice thick.
  SurfaceMesh by_edge = block(Vec3(0.5, 0.5, 0.5), Vec3(0, 0, 0));
  append(by_edge, block(Vec3(0.5, 0.5, 0.5), Vec3(1, 1, 0)));
  add(list, "SharedEdge", std::move(by_edge), 2, 0.12);
  SurfaceMesh by_corner = block(Vec3(0.5, 0.5, 0.5), Vec3(0, 0, 0));
  append(by_corner, block(Vec3(0.5, 0.5, 0.5), Vec3(1, 1, 1)));
  add(list, "SharedCorner", std::move(by_corner), 2, 0.08);
  refuse(list, "TinyPart", with(ball(), ball(0.01, Vec3(1.6, 0, 0))), "part 2 of 2");
  refuse(list, "ThinShell", with(ball(), flipped(ball(0.97))), "too thin for the lattice");
}

void add_soups(List& list) {
  Random random(3);
  add(list, "Soup", soup(ball(), 0), kBallVolume);
  add(list, "RoundedSoup", soup(ball(), 3e-6), kBallVolume);
  add(list, "LooseSoup", soup(ball(), 3e-3), kBallVolume);
  SurfaceMesh turned = soup(ball(), 0);
  for (Triangle& t : turned.triangles)
    if (one_in(random, 2)) flip(t);
  add(list, "TurnedSoup", std::move(turned), kBallVolume);
}

void add_sheets(List& list) {
  refuse(list, "OpenSheet", sheet(), "thickness");
  refuse(list, "FinelyFilledSheet", sheet(), "open sheet");
  list.back().edge = 0.05;
  add(list, "OpenBowl", without(ball(), [](const Vec3& p) { return p.y() > 0; }), 0.5 * kBallVolume, 0.1);
  refuse(list, "OneSidedSheet", moebius(), "thickness");
  add(list, "ThickSheet", sheet(), 0.2 * 1.02, 0.08);
  list.back().edge = 0.1;
  list.back().thickness = 0.2;
  // Twice round: the middle line is 2 pi long, the strip is longer by its turn.
  add(list, "ThickOneSidedSheet", moebius(), 0.2 * 0.6 * 2 * std::numbers::pi, 0.1);
  list.back().edge = 0.1;
  list.back().thickness = 0.2;
  SurfaceMesh both_sides = sheet();
  append(both_sides, flipped(sheet()));
  refuse(list, "TwoSidedSheet", both_sides, "thickness");
  add(list, "ThickTwoSidedSheet", std::move(both_sides), 0.2 * 1.02, 0.08);
  list.back().edge = 0.1;
  list.back().thickness = 0.2;
  add(list, "ThickSheetInMicrometres", moved(sheet(), 1e-6, Vec3::Zero()), 0.2 * 1.02 * 1e-18, 0.08);
  list.back().edge = 1e-7;
  list.back().thickness = 2e-7;
  refuse(list, "BallOverGround", with(ball(), moved(sheet(), 20, Vec3(-10, -1.5, -10))), "open sheet");
  refuse(list, "FlatBox", block(Vec3(0.5, 0, 0.5), Vec3::Zero()), "flat");
  SurfaceMesh triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  refuse(list, "OneTriangle", std::move(triangle), "flat");
  refuse(list, "NoTriangle", SurfaceMesh{}, "no triangles");
}

/// What is thinner than an edge of the lattice becomes about an edge thick and hangs together, if it belongs to a body
/// that is not; a body that is so thin everywhere is refused with the edge that it takes.
void add_thin(List& list) {
  constexpr double kThickened = 0.2;  // m: an edge
  refuse(list, "ThinPlate", block(Vec3(1, 0.03, 1), Vec3(0.013, 0.027, 0.011)), "an edge of about 0.057 m or less");
  refuse(list, "ThinRod", block(Vec3(1.5, 0.03, 0.03), Vec3(0.013, 0.027, 0.011)), "an edge of about 0.03 m or less");
  refuse(list, "SmallerThanTheEdge", ball(0.05), "too thin for the lattice");
  SurfaceMesh limbs = ball(), wall = ball(), specked = ball();
  append(limbs, block(Vec3(0.7, 0.04, 0.04), Vec3(1.5, 0.05, 0.03)));
  append(limbs, block(Vec3(0.04, 0.7, 0.04), Vec3(0.07, 1.5, 0.02)));
  add(list, "LimbsThinnerThanTheEdge", std::move(limbs), kBallVolume + 2 * 1.2 * kThickened * kThickened, 0.06);
  list.back().thin_volume = kBallVolume + 2 * 1.2 * 0.08 * 0.08;
  append(wall, block(Vec3(1.5, 0.03, 1.5), Vec3(0.013, 0.027, 0.011)));
  add(list, "WallThinnerThanTheEdge", std::move(wall), kBallVolume + (9 - std::numbers::pi) * kThickened, 0.12);
  list.back().thin_volume = kBallVolume + (9 - std::numbers::pi) * 0.06;
  append(specked, ball(0.05, Vec3(0, 1, 0)));
  add(list, "SpeckOnABall", std::move(specked), kBallVolume);
}

void add_scales(List& list) {
  const auto scaled = [&](const char* name, double factor, const Vec3& shift) {
    add(list, name, moved(ball(), factor, shift), kBallVolume * factor * factor * factor);
    list.back().edge = 0.2 * factor;
  };
  scaled("Micrometres", 1e-6, Vec3::Zero());
  scaled("Megametres", 1e6, Vec3::Zero());
  scaled("FarFromTheOrigin", 1, Vec3(1e5, 1e5, -1e5));
  scaled("MillimetresFarFromTheOrigin", 1e-3, Vec3(1e2, 0, 0));
  SurfaceMesh far_and_torn = moved(without(ball(), [&](const Vec3& p) { return p.x() > 0.95; }), 1e-6, Vec3(1, 0, 0));
  add(list, "MicrometresTornFarFromTheOrigin", std::move(far_and_torn), kBallVolume * 1e-18);
  list.back().edge = 2e-7;
  // Triangles of 1 mm beside those of 0.3 m.
  SurfaceMesh mixed = make_sphere(1, 6, Vec3::Zero());
  append(mixed, make_sphere(0.3, 200, Vec3(1, 0, 0)));
  const double d = 1, r = 0.3;  // a lens of two balls, radii 1 and r, d apart
  const double lens =
      std::numbers::pi * std::pow(1 + r - d, 2) * (d * d + 2 * d * r - 3 * r * r + 2 * d + 6 * r - 3) / (12 * d);
  add(list, "MixedTriangleSizes", std::move(mixed), kBallVolume * 1.027 - lens, 0.06);
  SurfaceMesh unused = ball();
  unused.positions.push_back(Vec3::Constant(1e9));
  unused.positions.push_back(Vec3::Constant(kNaN));
  add(list, "FarUnusedVertices", std::move(unused), kBallVolume);
  SurfaceMesh broken = ball();
  broken.positions[100][1] = kNaN;
  broken.positions[200][0] = std::numeric_limits<double>::infinity();
  add(list, "VerticesWithoutNumbers", std::move(broken), kBallVolume);
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
