/// Points that follow animated nodes and surfaces, and where grabbed points are taken.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/constraints/followed_node.h"
#include "core/constraints/followed_surface.h"
#include "core/constraints/pins.h"
#include "core/constraints/targets.h"
#include "core/mesh/point_cache.h"
#include "tests/core/dynamics/dynamics_support.h"

namespace softreel {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;
constexpr double kRoundOff = 1e-12;

/// A node that stands at (1, 0, 0) and turns by 90 degrees about z from second 0 to second 1.
SceneAnimation turning_node() {
  SceneAnimation scene;
  scene.nodes.push_back({"arm", -1, {Mat3::Identity(), Vec3(1, 0, 0)}});
  NodeChannel channel;
  channel.node = 0;
  channel.translation = {{0}, {Vec3(1, 0, 0)}};
  channel.rotation = {{0, 1}, {Quaternion::Identity(), Quaternion(Eigen::AngleAxisd(kQuarter, Vec3::UnitZ()))}};
  scene.clips.push_back({"turn", 1, {channel}, {}});
  return scene;
}

/// One frame a second from frame 10 on.
constexpr ClipTiming kFromTen{10, 1, 1};

TEST(FollowedNode, CarriesPointsByAQuarterTurnAboutItsPlace) {
  const SceneAnimation scene = turning_node();
  const FollowedNode node(scene, scene.clips[0], 0, kFromTen, std::nullopt, {});
  const LocalMotion before = node.motions({}, 3).front(), end = node.motions({}, 11).front();
  const Vec3 p(3, 0.5, -2);
  EXPECT_EQ(before.apply(p), p) << "the first key holds";
  EXPECT_LT((end.apply(p) - Vec3(0.5, 2, -2)).norm(), kRoundOff);
  EXPECT_EQ(node.motions({}, 99).front(), end);
  EXPECT_NE(node.pose(10.5), node.pose(11));
}

TEST(FollowedNode, MovesRelativeToItsReferenceFrame) {
  const SceneAnimation scene = turning_node();
  const FollowedNode node(scene, scene.clips[0], 0, kFromTen, 11.0, {});
  const Vec3 p(3, 0.5, -2);
  EXPECT_LT((node.motions({}, 11).front().apply(p) - p).norm(), kRoundOff);
  EXPECT_LT((node.motions({}, 10).front().apply(p) - Vec3(1.5, -2, -2)).norm(), kRoundOff) << "a quarter turn back";
}

TEST(FollowedNode, IsPlacedLikeTheBody) {
  const SceneAnimation scene = turning_node();
  Placement placement;  // twice the size, z up to y up, moved
  placement.linear << 2, 0, 0, 0, 0, 2, 0, -2, 0;
  placement.offset = Vec3(0, 7, 0);
  const FollowedNode placed(scene, scene.clips[0], 0, kFromTen, std::nullopt, placement);
  const FollowedNode in_file(scene, scene.clips[0], 0, kFromTen, std::nullopt, {});
  const Vec3 p(3, 0.5, -2);
  EXPECT_LT(
      (placed.motions({}, 10.7).front().apply(placement(p)) - placement(in_file.motions({}, 10.7).front().apply(p)))
          .norm(),
      kRoundOff);
}

TEST(SceneNodes, PoseOnlyThoseAboveTheWantedWithTheBitsOfTheWholeScene) {
  SceneAnimation scene = turning_node();
  const Affine aside{Mat3(Eigen::AngleAxisd(0.3, Vec3::UnitX())), Vec3(0.1, 0.7, -0.3)};
  for (int k = 0; k < 5; ++k) scene.nodes.push_back({"other", k - 1, aside});
  scene.nodes.push_back({"hand", 0, aside});
  scene.nodes.push_back({"finger", 6, aside});
  const SceneNodes nodes(scene, &scene.clips[0], {7});
  EXPECT_EQ(nodes.numbers(), std::vector<Index>({0, 6, 7}));
  const std::vector<Index> every{0, 1, 2, 3, 4, 5, 6, 7};
  for (const double seconds : {-1.0, 0.3, 2.0}) {
    const std::vector<Affine> whole = SceneNodes(scene, &scene.clips[0], every).at(seconds);
    EXPECT_EQ(nodes.at(seconds), std::vector<Affine>({whole[0], whole[6], whole[7]}));
  }
  EXPECT_EQ(SceneNodes(scene, nullptr, {7}).at(0).back(), SceneNodes(scene, nullptr, every).at(0).back());
}

TEST(FollowedNode, RefusesAReferenceWithoutExtent) {
  SceneAnimation scene = turning_node();
  scene.nodes[0].rest.linear.setZero();
  EXPECT_THROW(FollowedNode(scene, scene.clips[0], 0, kFromTen, std::nullopt, {}), Error);
}

/// Two triangles that form the unit square in z = 0; the second sample is the square under `map`.
template <typename Map>
std::unique_ptr<AnimatedVertices> moving_square(const Map& map) {
  PointCache cache;
  cache.points = 4;
  cache.seconds = {0, 1};
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (const Vec3& p : corners) cache.positions.push_back(p.cast<float>());
  for (const Vec3& p : corners) cache.positions.push_back(map(p).template cast<float>());
  return std::make_unique<CachedVertices>(std::move(cache));
}

template <typename Map>
FollowedSurface follow_square(const Map& map, FollowedSurface::Binding binding) {
  auto vertices = moving_square(map);
  std::vector<Vec3> rest = vertices->rest();
  return {std::move(vertices), std::move(rest), {{0, 1, 2}, {0, 2, 3}}, binding, {0, 1, 1}, {}};
}

Vec3 turned_and_doubled(const Vec3& p) {
  return Vec3(-2 * p.y(), 2 * p.x(), 2 * p.z()) + Vec3(5, 0, 1);
}

TEST(FollowedSurface, CarriesPointsOnAndOffItAsItsTrianglesMove) {
  const FollowedSurface surface = follow_square(turned_and_doubled, FollowedSurface::Binding::Nearest);
  const std::vector<Vec3> points{{0.3, 0.6, 0}, {0.9, 0.1, 0.4}, {0, 0, 0}};
  const std::vector<FollowTie> ties = surface.tie(points, {});
  const std::vector<LocalMotion> rest = surface.motions(ties, -2), moved = surface.motions(ties, 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT((rest[i].apply(points[i]) - points[i]).norm(), kRoundOff);
    EXPECT_LT((moved[i].apply(points[i]) - turned_and_doubled(points[i])).norm(), 1e-6) << "point " << i;
  }
  EXPECT_NEAR(surface.farthest_from(points, ties), 0.4, kRoundOff) << "of the second point";
}

TEST(FollowedSurface, CarriesVerticesByNumberToWhereTheFileHasThem) {
  const auto torn = [](const Vec3& p) { return Vec3(p.x() * p.x() - 3 * p.y(), p.y() + 0.25 * p.x(), 7 * p.x()); };
  const FollowedSurface surface = follow_square(torn, FollowedSurface::Binding::Vertex);
  const std::vector<Vec3> rest{{1, 1, 0}, {0, 1, 0}};
  const std::vector<Index> numbers{2, 3};
  const std::vector<FollowTie> ties = surface.tie(rest, numbers);
  for (std::size_t i = 0; i < rest.size(); ++i)
    EXPECT_EQ(surface.motions(ties, 1)[i].apply(rest[i]), torn(rest[i]).cast<float>().cast<double>());
}

TEST(FollowedSurface, RefusesASurfaceWithoutArea) {
  const auto flat = [] {
    auto vertices = moving_square([](const Vec3& p) { return p; });
    std::vector<Vec3> line(4, Vec3::Zero());
    return FollowedSurface(std::move(vertices), line, {{0, 1, 2}}, FollowedSurface::Binding::Nearest, {0, 1, 1}, {});
  };
  EXPECT_THROW(flat(), Error);
}

TEST(GuidedPoints, OfAGrabAreWhereItTookThemUntilTheKeysMove) {
  Transform turned;
  turned.translate = Vec3(1, 0, 0);
  turned.rotate.z() = kQuarter;
  turned.pivot = Vec3(0.5, 0.5, 0.5);
  const Track<Transform> track{{{1, turned, Ease::Linear}, {5, turned, Ease::Linear}, {6, {}, Ease::Linear}}};
  const std::vector<Vec3> rest{{1, 2, 3}, {0.1, 0.2, 0.3}}, taken{{7, 8, 9}, {0.7, 0.1, 1.0 / 3}};
  const Grab grab{0, 2, taken};
  EXPECT_EQ(guided_points({track, nullptr, {}}, rest, 4, grab), taken) << "to the last bit";
}

TEST(GuidedPoints, OfAGrabMoveAsTheKeysDoSince) {
  Transform first, last;
  first.rotate.z() = kQuarter;
  last.rotate.z() = 2 * kQuarter;
  last.translate = Vec3(0, 0, 3);
  const Track<Transform> track{{{1, first, Ease::Linear}, {2, last, Ease::Linear}}};
  const std::vector<Vec3> rest{Vec3(9, 9, 9)};  // plays no part
  const std::vector<Vec3> moved = guided_points({track, nullptr, {}}, rest, 2, {0, 1, {Vec3(1, 2, 0)}});
  EXPECT_LT((moved[0] - Vec3(-2, 1, 3)).norm(), kRoundOff);
}

TEST(GuidedPoints, OfAGrabFollowWhatTheyHangOn) {
  const FollowedSurface surface = follow_square(turned_and_doubled, FollowedSurface::Binding::Nearest);
  const std::vector<Vec3> rest{{0.3, 0.6, 0}};
  const std::vector<FollowTie> ties = surface.tie(rest, {});
  const Track<Transform> none{{{0, {}, Ease::Smooth}}};
  const Vec3 taken(0.3, 0.5, 0.25);  // away from where the surface has it
  const std::vector<Vec3> moved = guided_points({none, &surface, ties}, rest, 1, {0, 0, {taken}});
  EXPECT_LT((moved[0] - turned_and_doubled(taken)).norm(), 1e-6);
}

TEST(NodePins, OfAFollowedNodeCarryTheirPointsExactly) {
  const TetMesh mesh = testing::kuhn_bar({3, 1, 1}, Vec3(3, 1, 1));
  const SceneAnimation scene = turning_node();
  const FollowedNode node(scene, scene.clips[0], 0, kFromTen, std::nullopt, {});
  Pin pin = testing::make_pin({0, 5});
  pin.follow = &node;
  const PinnedNodes pinned = NodePins({pin}, testing::embed_nodes(mesh), mesh).at(11);
  ASSERT_GT(pinned.count, 0);
  for (std::size_t i = 0; i < pinned.held.size(); ++i) {
    if (pinned.held[i] == 0) continue;
    const Vec3& p = mesh.nodes[i];
    EXPECT_LT((pinned.targets[i] - Vec3(1 - p.y(), p.x() - 1, p.z())).norm(), kRoundOff);
  }
}

/// A strip along x, bent to an arc of radius 1 by its second sample; fine beside the tetrahedra of these tests.
Vec3 bent(const Vec3& p) {
  return {std::sin(p.x()), p.y(), 1 - std::cos(p.x())};
}

FollowedSurface follow_bent_strip(double width) {
  constexpr int kRows = 1024;
  PointCache cache;
  cache.points = 2 * (kRows + 1);
  cache.seconds = {0, 1};
  std::vector<Vec3> rest;
  std::vector<Triangle> triangles;
  for (Index row = 0; row <= kRows; ++row)
    for (const double y : {0.0, width}) rest.emplace_back(static_cast<double>(row) / kRows, y, 0);
  for (Index v = 0; v < 2 * kRows; v += 2) {
    triangles.push_back({v, v + 1, v + 2});
    triangles.push_back({v + 1, v + 3, v + 2});
  }
  for (const bool moved : {false, true})
    for (const Vec3& p : rest) cache.positions.push_back((moved ? bent(p) : p).cast<float>());
  return {std::make_unique<CachedVertices>(std::move(cache)),
          std::move(rest),
          std::move(triangles),
          FollowedSurface::Binding::Nearest,
          {0, 1, 1},
          {}};
}

/// How far the middles of a bar's faces at z = 0, pinned to the strip, are from where the arc has them.
double distance_from_arc(int cells) {
  const double h = 1.0 / cells;
  const TetMesh mesh = testing::kuhn_bar({cells, 1, 1}, Vec3(1, h, h));
  Embedding embedding;
  std::vector<Vec3> points;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    std::array<double, 4> weights{};
    Vec3 middle = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3& node = mesh.nodes[static_cast<std::size_t>(mesh.tets[e][k])];
      if (node.z() > 0.5 * h) continue;
      weights[k] = 1.0 / 3;
      middle += weights[k] * node;
    }
    if (std::count(weights.begin(), weights.end(), 0.0) != 1) continue;
    embedding.elements.push_back(static_cast<Index>(e));
    embedding.weights.push_back(weights);
    points.push_back(middle);
  }
  const FollowedSurface strip = follow_bent_strip(h);
  std::vector<Index> numbers(points.size());
  std::iota(numbers.begin(), numbers.end(), Index{0});
  Pin pin = testing::make_pin(numbers);
  pin.follow = &strip;
  pin.ties = strip.tie(points, numbers);
  const PinnedNodes pinned = NodePins({pin}, embedding, mesh).at(1);
  double farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vec3 point = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k)
      point += embedding.weights[i][k] *
               pinned.targets[static_cast<std::size_t>(mesh.tets[static_cast<std::size_t>(embedding.elements[i])][k])];
    farthest = std::max(farthest, (point - bent(points[i])).norm());
  }
  return farthest;
}

TEST(NodePins, OfABendingSurfaceAreOffByTheSecondOrderOfTheirTetrahedra) {
  const double coarse = distance_from_arc(10), fine = distance_from_arc(20);
  EXPECT_GT(coarse, 1e-5);
  EXPECT_LT(coarse, 0.1 * 0.1);
  EXPECT_GT(coarse / fine, 3) << coarse << " " << fine;
}

}  // namespace
}  // namespace softreel
