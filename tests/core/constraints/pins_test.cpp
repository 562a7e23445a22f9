#include "core/constraints/pins.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "tests/core/dynamics/dynamics_support.h"

namespace softreel {
namespace {

struct Body {
  TetMesh mesh = testing::kuhn_bar({3, 1, 1}, Vec3(3, 1, 1));
  Embedding embedding = testing::embed_nodes(mesh);
};

TEST(NodePins, HoldEveryNodeOfTheTetrahedraThatCarryTheirPoints) {
  const Body body;
  const PinnedNodes pinned = NodePins({testing::make_pin({0, 5})}, body.embedding, body.mesh).at(1);
  std::vector<std::uint8_t> expected(body.mesh.nodes.size(), 0);
  for (const std::size_t point : {0u, 5u})
    for (const Index node : body.mesh.tets[static_cast<std::size_t>(body.embedding.elements[point])])
      expected[static_cast<std::size_t>(node)] = 1;
  EXPECT_EQ(pinned.held, expected);
  EXPECT_EQ(pinned.count, std::count(expected.begin(), expected.end(), 1));
  EXPECT_TRUE(pinned.conflict.empty());
}

TEST(NodePins, CarryRestNodesByTheirTransform) {
  const Body body;
  Transform transform;
  transform.translate = Vec3(1, 2, 3);
  transform.rotate.z() = 0.5;
  const PinnedNodes pinned = NodePins({testing::make_pin({0}, transform)}, body.embedding, body.mesh).at(1);
  for (std::size_t i = 0; i < pinned.held.size(); ++i) {
    if (pinned.held[i] != 0) {
      EXPECT_EQ(pinned.targets[i], transform.apply(body.mesh.nodes[i]));
    }
  }
}

TEST(NodePins, HoldOnlyWhileActive) {
  const Body body;
  Pin pin = testing::make_pin({0});
  pin.active = {{2, 3}, {5, 5}};
  const NodePins pins({pin}, body.embedding, body.mesh);
  for (const double frame : {1.0, 1.99, 3.01, 4.0, 5.5}) EXPECT_EQ(pins.at(frame).count, 0) << frame;
  for (const double frame : {2.0, 2.5, 3.0, 5.0}) EXPECT_EQ(pins.at(frame).count, 4) << frame;
}

TEST(NodePins, MayShareNodesWhereTheyAgree) {
  const Body body;
  Transform turn;
  turn.rotate.y() = 1;
  const NodePins pins({testing::make_pin({0}, turn), testing::make_pin({0, 1}, turn)}, body.embedding, body.mesh);
  EXPECT_TRUE(pins.at(1).conflict.empty());
  EXPECT_TRUE(pins.find_conflict().empty());
}

TEST(NodePins, NameBothPinsThatDisagree) {
  const Body body;
  Pin still = testing::make_pin({0}), mover = still;
  mover.name = "body.bar.pin[1] (shots/a.toml:31)";
  Transform away;
  away.translate.x() = 1e-3;
  mover.track = {{{1, {}, Ease::Linear}, {8, away, Ease::Linear}}};
  const NodePins pins({still, mover}, body.embedding, body.mesh);
  EXPECT_TRUE(pins.at(1).conflict.empty());
  for (const std::string& conflict : {pins.at(4).conflict, pins.find_conflict()})
    for (const char* part : {"body.bar.pin[0]", "body.bar.pin[1] (shots/a.toml:31)", "node 0", "Accepted", "Select"})
      EXPECT_NE(conflict.find(part), std::string::npos) << conflict;
}

TEST(NodePins, AreComparedAtWholeFramesBetweenTheirKeys) {
  // Where eases differ, pins agree at both keys and at the half.
  const Body body;
  Transform away;
  away.translate.x() = 1e-3;
  const auto conflict = [&](double last) {
    Pin smooth = testing::make_pin({0}), linear = smooth;
    smooth.track = {{{1, {}, Ease::Smooth}, {last, away, Ease::Smooth}}};
    linear.track = {{{1, {}, Ease::Linear}, {last, away, Ease::Linear}}};
    return NodePins({smooth, linear}, body.embedding, body.mesh).find_conflict();
  };
  EXPECT_NE(conflict(25).find("at frame 9"), std::string::npos) << conflict(25);
  EXPECT_EQ(conflict(2), "") << "no step need end between them";
}

TEST(NodePins, MayDisagreeAtDifferentTimes) {
  const Body body;
  Transform away;
  away.translate.x() = 1;
  Pin first = testing::make_pin({0}), second = testing::make_pin({0}, away);
  first.active = {{1, 10}};
  second.active = {{11, 20}};
  EXPECT_TRUE(NodePins({first, second}, body.embedding, body.mesh).find_conflict().empty());
}

}  // namespace
}  // namespace softreel
