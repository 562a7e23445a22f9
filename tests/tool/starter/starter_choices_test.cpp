// What is chosen for meshes whose right answer is known: which way is up, what stands and what lies, what is held.
#include "tool/starter/starter_choices.h"

#include <atomic>
#include <cmath>

#include <fmt/format.h>

#include "tests/tool/shot/shot_files.h"

namespace softreel {
namespace {

class StarterChoices : public ShotFiles {
 protected:
  static StarterBody choose(const std::string& mesh, const StarterWishes& wishes = few()) {
    const Log log;
    const Threads threads(1);
    StageTimes times;
    const Cache cache("", Cache::Storing::Wanted, log);
    const std::atomic<bool> cancelled{false};
    return choose_body(mesh, "body", wishes, {threads, log, times, cache, cancelled});
  }
  static StarterWishes few() {
    StarterWishes wishes;
    wishes.tets = 600;
    return wishes;
  }

  /// A box as OBJ, from 0 to these sizes, its sides cut into n x n quads, with the groups "low" and "high" of z.
  static std::string box(double x, double y, double z, const Vec3& origin = Vec3::Zero()) {
    std::string vertices, faces;
    int count = 0;
    const auto quad = [&](const Vec3& o, const Vec3& u, const Vec3& v) {
      constexpr int n = 4;
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
          const Vec3 p = origin + o + u * i / n + v * j / n;
          vertices += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
        }
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const int a = count + i * (n + 1) + j + 1;
          faces += fmt::format("f {} {} {} {}\n", a, a + n + 1, a + n + 2, a + 1);
        }
      count += (n + 1) * (n + 1);
    };
    const Vec3 X(x, 0, 0), Y(0, y, 0), Z(0, 0, z), O(0, 0, 0);
    quad(O, Y, X), quad(Z, X, Y), quad(O, X, Z), quad(Y, Z, X), quad(O, Z, Y), quad(X, Y, Z);
    return vertices + faces;
  }
  /// A cone on a flat base of radius r in the plane z = 0, its tip at height h.
  static std::string cone(double r, double h) {
    constexpr int n = 24;
    std::string text = fmt::format("v 0 0 0\nv 0 0 {}\n", h);
    for (int i = 0; i < n; ++i)
      text += fmt::format("v {} {} 0\n", r * std::cos(2 * M_PI * i / n), r * std::sin(2 * M_PI * i / n));
    for (int i = 0; i < n; ++i) text += fmt::format("f 1 {1} {0}\nf 2 {0} {1}\n", i + 3, (i + 1) % n + 3);
    return text;
  }
  /// A ball with edges of all angles, as of a coarse scan.
  static std::string rough_ball() {
    constexpr int rows = 8, columns = 16, last = 2 + (rows - 1) * columns;
    std::string text = "v 0 0 0.5\n";
    for (int k = 1; k < last - 1; ++k) {
      const double polar = M_PI * (1 + (k - 1) / columns) / rows, turn = 2 * M_PI * ((k - 1) % columns) / columns;
      const double r = 0.5 * (1 + 0.04 * std::sin(2.4 * k));
      text += fmt::format("v {} {} {}\n", r * std::sin(polar) * std::cos(turn), r * std::sin(polar) * std::sin(turn),
                          r * std::cos(polar));
    }
    text += "v 0 0 -0.5\n";
    for (int j = 0; j < columns; ++j) {
      const int next = (j + 1) % columns, low = last - columns;
      text += fmt::format("f 1 {} {}\nf {} {} {}\n", 2 + j, 2 + next, last, low + next, low + j);
      for (int first = 2; first < low; first += columns)
        text += fmt::format("f {0} {1} {2}\nf {0} {2} {3}\n", first + j, first + columns + j, first + columns + next,
                            first + next);
    }
    return text;
  }
};

TEST_F(StarterChoices, SomethingTallStandsOnItsBaseAndIsAMetreHigh) {
  write("tall.obj", box(200, 900, 300, {1000, -5000, 70}));
  const StarterBody body = choose("tall.obj");
  EXPECT_TRUE(body.stands);
  EXPECT_EQ(body.settings.up, UpAxis::Y);
  const Bounds box = used_bounds(body.loaded.surface);
  EXPECT_NEAR(box.size().y(), 1.0, 1e-9);
  EXPECT_NEAR(box.min.y(), 0.0, 1e-9);
  for (const Index v : select_points(body.held.select, body.loaded.surface))
    EXPECT_LT(body.loaded.surface.positions[static_cast<std::size_t>(v)].y(), 0.25);
  for (const Index v : select_points(body.pulled.select, body.loaded.surface))
    EXPECT_GT(body.loaded.surface.positions[static_cast<std::size_t>(v)].y(), 0.75);
  EXPECT_NEAR(body.volume, 2.0 / 9 * 3.0 / 9, 0.02);
  EXPECT_EQ(body.loose_pieces, 0);
}

/// A block of 1 x 0.4 x 1 m on four legs of 0.6 m, whose sections are a share of the block's.
std::string table(double share) {
  const double w = std::sqrt(share) / 2;
  std::string text;
  int first = 1;
  const auto add = [&](const Vec3& low, const Vec3& high) {
    for (int k = 0; k < 8; ++k)
      text += fmt::format("v {} {} {}\n", (k & 1) != 0 ? high.x() : low.x(), (k & 2) != 0 ? high.y() : low.y(),
                          (k & 4) != 0 ? high.z() : low.z());
    for (const auto& f : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
      text += fmt::format("f {} {} {} {}\n", first + f[0], first + f[1], first + f[2], first + f[3]);
    first += 8;
  };
  add(Vec3(0, 0.6, 0), Vec3(1, 1, 1));
  for (const double x : {0.0, 1 - w})
    for (const double z : {0.0, 1 - w}) add(Vec3(x, 0, z), Vec3(x + w, 0.7, z + w));
  return text;
}

TEST_F(StarterChoices, ThinLegsAreFound) {
  write("tall.obj", box(2, 9, 3));
  EXPECT_NEAR(choose("tall.obj").leg_share, 1, 1e-9);
  write("table.obj", table(0.25));
  const double legs = choose("table.obj").leg_share;
  EXPECT_NEAR(legs, 0.25 / (0.6 * 0.25 + 0.4), 0.06);
}

TEST_F(StarterChoices, SomethingLongLiesAndIsHeldAtOneEndAboveTheGround) {
  write("long.obj", box(1, 0.8, 10));
  const StarterBody body = choose("long.obj");
  EXPECT_FALSE(body.stands);
  const Bounds box = used_bounds(body.loaded.surface);
  EXPECT_NEAR(box.size().z(), 1.0, 1e-6);
  EXPECT_GT(box.min.y(), 0.1) << "it cannot hang";
  for (const Index v : select_points(body.held.select, body.loaded.surface))
    EXPECT_LT(body.loaded.surface.positions[static_cast<std::size_t>(v)].z(), box.center().z());
  for (const Index v : select_points(body.pulled.select, body.loaded.surface))
    EXPECT_GT(body.loaded.surface.positions[static_cast<std::size_t>(v)].z(), box.center().z());
}

TEST_F(StarterChoices, AFlatBaseBelowZSaysThatZPointsUp) {
  write("printed.obj", cone(0.4, 1));
  EXPECT_EQ(choose("printed.obj").settings.up, UpAxis::Z);
  write("cube.obj", box(1, 1, 1));
  EXPECT_EQ(choose("cube.obj").settings.up, UpAxis::Y) << "a base on either side tells nothing";
  StarterWishes wish = few();
  wish.up = "x";
  EXPECT_EQ(choose("printed.obj", wish).settings.up, UpAxis::X);
}

TEST_F(StarterChoices, EdgesAreHardWhereFlatOrRoundPartsMeet) {
  write("cube.obj", box(1, 1, 1));
  EXPECT_EQ(choose("cube.obj").settings.crease_deg, 40);
  write("bar.obj", box(1, 0.8, 10));
  EXPECT_EQ(choose("bar.obj").settings.crease_deg, 40);
  write("cone.obj", cone(0.4, 1));
  EXPECT_EQ(choose("cone.obj").settings.crease_deg, 40) << "round, on a flat base";
  StarterWishes wishes = few();
  wishes.tets = 4000;
  for (const char* name : {"octopus", "creature"}) {
    const std::string mesh = fmt::format("{}/assets/{}.ply", SOFTREEL_SOURCE_DIR, name);
    EXPECT_EQ(choose(mesh, wishes).settings.crease_deg, 180) << name;
  }
}

TEST_F(StarterChoices, WhatIsRoughAllOverIsSmooth) {
  write("rough.obj", rough_ball());
  EXPECT_EQ(choose("rough.obj").settings.crease_deg, 180) << "a tenth of its edges is sharp, more are nearly so";
}

TEST_F(StarterChoices, GroupsThatTellAreHeldAndPulled) {
  const std::string mesh = std::string(SOFTREEL_SOURCE_DIR) + "/assets/octopus.ply";
  StarterWishes wishes = few();
  wishes.tets = 4000;
  const StarterBody body = choose(mesh, wishes);
  EXPECT_EQ(std::get<SelectGroup>(body.held.select.terms.at(0).shape).name, "soles");
  wishes.pull_groups = {"eyes"};
  EXPECT_EQ(std::get<SelectGroup>(choose(mesh, wishes).pulled.select.terms.at(0).shape).name, "eyes");
  wishes.pull_groups = {"eye"};
  EXPECT_THROW(choose(mesh, wishes), Error);
}

TEST_F(StarterChoices, PiecesThatNothingHoldsAreCounted) {
  std::string two = box(1, 1, 1);
  std::string upper = box(0.5, 0.5, 0.5, {0.25, 2, 0.25});
  // The second box's faces count from the vertices of the first.
  std::string moved;
  for (std::size_t at = 0; at < upper.size();) {
    const std::size_t end = upper.find('\n', at) + 1;
    std::string line = upper.substr(at, end - at);
    if (line.starts_with("f ")) {
      int a, b, c, d;
      ASSERT_EQ(std::sscanf(line.c_str(), "f %d %d %d %d", &a, &b, &c, &d), 4);
      line = fmt::format("f {} {} {} {}\n", a + 150, b + 150, c + 150, d + 150);
    }
    moved += line;
    at = end;
  }
  write("two.obj", two + moved);
  const StarterBody body = choose("two.obj");
  EXPECT_EQ(body.pieces, 2);
  EXPECT_EQ(body.loose_pieces, 1);
}

TEST_F(StarterChoices, AnOpenSheetIsGivenAThickness) {
  std::string sheet;
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 10; ++j) sheet += fmt::format("v {} {} 0\n", i * 0.1, j * 0.1);
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j)
      sheet += fmt::format("f {} {} {} {}\n", i * 11 + j + 1, i * 11 + j + 12, i * 11 + j + 13, i * 11 + j + 2);
  write("sheet.obj", sheet);
  const StarterBody body = choose("sheet.obj");
  EXPECT_GT(body.settings.thickness, 0);
  EXPECT_GT(body.tets, 0u);
}

TEST_F(StarterChoices, WhatEnclosesNothingIsRefused) {
  write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_THROW(choose("line.obj"), Error);
}

}  // namespace
}  // namespace softreel
