#include "core/mesh/box_tree.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace softreel {
namespace {

/// Small boxes and a few large ones.
std::vector<Bounds> some_boxes(std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 1), size(0, 0.05);
  std::vector<Bounds> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 low(place(random), place(random), place(random));
    const double large = i % 17 == 0 ? 10 : 1;
    boxes.push_back({low, low + large * Vec3(size(random), size(random), size(random))});
  }
  return boxes;
}

TEST(BoxTree, VisitsTheBoxesThatAreNearAndNoOther) {
  const std::vector<Bounds> boxes = some_boxes(500);
  const BoxTree tree(boxes);
  for (const double reach : {0.0, 0.02})
    for (const Bounds& box : some_boxes(100)) {
      std::vector<Index> visited, near;
      tree.visit_near(box, reach, [&](Index i) { visited.push_back(i); });
      for (std::size_t i = 0; i < boxes.size(); ++i)
        if (BoxTree::is_near(boxes[i], box, reach)) near.push_back(static_cast<Index>(i));
      std::sort(visited.begin(), visited.end());
      EXPECT_EQ(visited, near);
    }
}

TEST(BoxTree, FindsTheLastBoxAroundOneAskingFromTheEnd) {
  const std::vector<Bounds> boxes = some_boxes(500);
  const BoxTree tree(boxes);
  int found = 0;
  for (Index end = 0; end < 500; ++end) {
    const Bounds& box = boxes[static_cast<std::size_t>(end)];
    const auto accepts = [](Index i) { return i % 3 != 0; };
    Index expected = end;
    while (--expected >= 0)
      if (BoxTree::contains(boxes[static_cast<std::size_t>(expected)], box) && accepts(expected)) break;
    Index before = end;
    const Index around = tree.find_last_around(box, end, [&](Index i) {
      EXPECT_LT(i, before);
      before = i;
      return accepts(i);
    });
    EXPECT_EQ(around, expected);
    found += around >= 0 ? 1 : 0;
  }
  EXPECT_GT(found, 20);
  EXPECT_EQ(BoxTree({}).find_last_around(boxes[0], 0, [](Index) { return true; }), -1);
}

}  // namespace
}  // namespace softreel
