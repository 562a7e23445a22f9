/// Glue in a shot: what is read, written again, and refused.
#include "tests/tool/shot/shot_files.h"

namespace softreel {
namespace {

class GlueOfAShot : public ShotFiles {
 protected:
  static std::string two_bodies(const std::string& glue, const std::string& more = "") {
    write("x.ply", "");
    return "schema = 1\n[body.hat]\nmesh = \"x.ply\"\n" + more + "[body.head]\nmesh = \"x.ply\"\n[[glue]]\n" + glue;
  }
};

TEST_F(GlueOfAShot, IsReadAndWrittenAgain) {
  const Shot shot =
      load(two_bodies("bodies = [\"hat\", \"head\"]\ndistance = 0.02\nclose = 12\nmax_force = 5\n"
                      "select = { sphere = { center = [0, 1, 0], radius = 0.5 } }\n"
                      "stiffness = [{ frame = 1, value = 0 }, { frame = 9, value = 300 }]\n"
                      "active = [[1, 40], [50, 60]]\n[[glue]]\nbodies = [\"head\", \"hat\"]\ndistance = 1\n"));
  for (const Shot& s : {shot, load(to_toml(shot))}) {
    ASSERT_EQ(s.glues.size(), 2U);
    const GlueSettings& glue = s.glues[0];
    EXPECT_EQ(glue.bodies, (std::vector<std::string>{"hat", "head"}));
    EXPECT_EQ(glue.distance, 0.02);
    EXPECT_EQ(glue.close, 12);
    EXPECT_EQ(glue.max_force, 5);
    EXPECT_EQ(glue.stiffness.at(9), 300);
    EXPECT_EQ(glue.active.size(), 2U);
    EXPECT_TRUE(std::holds_alternative<SelectSphere>(glue.select.terms.at(0).shape));
    EXPECT_TRUE(s.glues[1].stiffness.keys.empty()) << "firm";
    EXPECT_TRUE(std::holds_alternative<SelectAll>(s.glues[1].select.terms.at(0).shape));
  }
}

TEST_F(GlueOfAShot, NamesWhatIsWrongAndWhatIsAccepted) {
  const std::string glue = "bodies = [\"hat\", \"head\"]\ndistance = 0.02\n";
  const struct {
    std::string text;
    std::vector<std::string> parts;
  } cases[] = {
      {two_bodies("bodies = [\"hat\", \"haed\"]\ndistance = 1\n"),
       {"s.toml:7:18: glue[0].bodies[1] = \"haed\"", "no body of this name", "hat, head", "Did you mean 'head'?"}},
      {two_bodies("bodies = [\"hat\", \"hat\"]\ndistance = 1\n"), {"glue[0].bodies", "glued to itself"}},
      {two_bodies("bodies = [\"hat\"]\ndistance = 1\n"), {"the list has 1 names", "the names of two bodies"}},
      {two_bodies("bodies = [\"hat\", \"head\"]\n"), {"glue[0].distance", "must be given"}},
      {two_bodies("bodies = [\"hat\", \"head\"]\ndistance = 0\n"), {"glue[0].distance = 0", "above 0"}},
      {two_bodies(glue + "stifness = 3\n"), {"glue[0].stifness", "Did you mean 'stiffness'?"}},
      {two_bodies(glue + "[solver]\nerror = \"1%\"\n"),
       {"glue[0].bodies", "solver.error chooses", "give the bodies tets"}},
      {two_bodies(glue, "rotation = \"none\"\n"), {"\"hat\" and body \"head\"", "same rotation"}},
      {two_bodies(glue + "close = 5\n[shot]\nmode = \"static\"\nindependent = true\n"),
       {"glue[0].close = 5", "shot.independent"}},
  };
  for (const auto& [text, parts] : cases) {
    const std::string said = message(text);
    for (const std::string& part : parts) EXPECT_NE(said.find(part), std::string::npos) << part << "\nin\n" << said;
  }
}

}  // namespace
}  // namespace softreel
