#include "tests/tool/shot/shot_files.h"
#include "tool/shot/shot_load.h"

namespace softreel {
namespace {

using SetOverrides = ShotFiles;

TEST_F(SetOverrides, AreSplitAtTheFirstEqualsSign) {
  const Override one = parse_override(" body.mesh = a=b.ply ");
  EXPECT_EQ(one.path, "body.mesh");
  EXPECT_EQ(one.value, "a=b.ply");
  EXPECT_THROW(parse_override("body.tets"), Error);
  EXPECT_THROW(parse_override("=3"), Error);
}

TEST_F(SetOverrides, TakeEveryTypeOfValue) {
  const Shot shot =
      load(body(""), {"shot.fps=12.5", "shot.frames=[3, 9]", "output.png=false", "shot.name=quick",
                      "shot.mode=\"static\"", "gravity.acceleration=[0, 0, -1]", "output.directory=a b/c"});
  EXPECT_EQ(shot.settings.fps, 12.5);
  EXPECT_EQ(shot.settings.first_frame, 3);
  EXPECT_EQ(shot.settings.last_frame, 9);
  EXPECT_FALSE(shot.output.png);
  EXPECT_EQ(shot.settings.name, "quick");
  EXPECT_EQ(shot.settings.mode, SimulationMode::Static);
  EXPECT_EQ(shot.gravity, Vec3(0, 0, -1));
  EXPECT_EQ(shot.output.directory, "a b/c");
}

TEST_F(SetOverrides, TakeWordsThatLookLikeDatesAsText) {
  EXPECT_EQ(load(body(""), {"shot.name=2024-01-31"}).settings.name, "2024-01-31");
}

TEST_F(SetOverrides, AddressTheOnlyBodyOrANamedOne) {
  EXPECT_EQ(load(body(""), {"body.tets=77"}).bodies[0].tets, 77);
  EXPECT_EQ(load(body(""), {"body.a.tets=78"}).bodies[0].tets, 78);
  EXPECT_EQ(load(kFullShot, {"body.first_by_name.tets=79"}).bodies[1].tets, 79);
  EXPECT_EQ(load("[body.\"a.b\"]\nmesh = \"x\"\n", {"body.\"a.b\".tets=80"}).bodies[0].tets, 80);
}

TEST_F(SetOverrides, ReachIntoLists) {
  const Shot shot = load(kFullShot, {"body.second_by_name.pin[0].keys[1].translate=[7, 8, 9]",
                                     "body.second_by_name.pin[0].keys[1].scale[2]=5", "light[1].power=3"});
  EXPECT_EQ(shot.bodies[0].pins[0].keys.keys[1].value.translate, Vec3(7, 8, 9));
  EXPECT_EQ(shot.bodies[0].pins[0].keys.keys[1].value.scale, Vec3(1, 2, 5));
  EXPECT_EQ(shot.lights[1].power.at(1), 3);
}

TEST_F(SetOverrides, MakeTablesThatAreNotThere) {
  const Shot shot = load(body(""), {"ground.height=0.5", "material.default.density=500"});
  EXPECT_EQ(shot.ground.value().height, 0.5f);
  EXPECT_EQ(shot.materials.at("default").physics.density, 500);
}

TEST_F(SetOverrides, TakeThePlaceOfAlternativesInOrder) {
  const Shot edge = load(body("tets = 5\nfit = 1\n"), {"body.edge=0.5", "body.scale=2"});
  EXPECT_EQ(edge.bodies[0].tets, 0);
  EXPECT_EQ(edge.bodies[0].edge, 0.5);
  EXPECT_EQ(edge.bodies[0].fit, 0);
  EXPECT_EQ(load(body(""), {"body.edge=0.5", "body.tets=6"}).bodies[0].tets, 6);
  EXPECT_EQ(load(body(""), {"body.tets=5", "body.tets=6"}).bodies[0].tets, 6);
}

TEST_F(SetOverrides, ReplaceThePresets) {
  write("one.toml", "[render]\nsamples = 1\n");
  write("two.toml", "[render]\nsamples = 2\n");
  EXPECT_EQ(load("use = [\"one.toml\"]\n" + body(""), {"use=[\"two.toml\"]"}).render.params.samples, 2);
}

TEST_F(SetOverrides, LieAboveTheQualityAndThatAboveTheShot) {
  write("below.toml", "[render]\nwidth = 1\nmax_bounces = 1\nshutter = 0.1\nsamples = 1\n");
  write("finer.toml", "use = [\"below.toml\"]\n[render]\nwidth = 2\nshutter = 0.2\n[body.a]\nedge = 0.5\n");
  const std::string text = body("tets = 5\n") + "[render]\nwidth = 3\nmax_bounces = 3\nheight = 3\n";
  const Shot shot = load(text, {"render.width=4", "quality=finer.toml"});
  EXPECT_EQ(shot.render.params.width, 4) << "--set wins, wherever it stands";
  EXPECT_EQ(shot.render.params.height, 3) << "the quality says nothing of it";
  EXPECT_EQ(shot.render.params.max_bounces, 1) << "what a quality uses lies above the shot with it";
  EXPECT_EQ(shot.render.params.samples, 1);
  EXPECT_EQ(shot.bodies[0].edge, 0.5);
  EXPECT_EQ(shot.bodies[0].tets, 0) << "edge and tets exclude each other";
  const std::string said = message(text, {"quality=none.toml"});
  EXPECT_NE(said.find("--quality none.toml: "), std::string::npos) << said;
  EXPECT_NE(said.find("draft, final, preview, or the path of a file"), std::string::npos) << said;
  write("wrong.toml", "[render]\nwidht = 3\n");
  EXPECT_NE(message(text, {"quality=wrong.toml"}).find("wrong.toml:2:"), std::string::npos);
  write("other.toml", "[render]\nwidth = 1\n[body.b]\nedge = 0.5\n");
  const std::string other = message(text, {"quality=other.toml"});
  EXPECT_NE(other.find("other.toml:3:1: body.b"), std::string::npos) << other;
  EXPECT_NE(other.find("Accepted: a."), std::string::npos) << other;
  write("misspelt.toml", "[material.skinn]\nsubsurface = 0\n");
  const std::string misspelt = message(text + "[material.skin]\ndensity = 900\n", {"quality=misspelt.toml"});
  for (const char* part : {"misspelt.toml:1:", "material.skinn", "Did you mean 'skin'?"})
    EXPECT_NE(misspelt.find(part), std::string::npos) << misspelt;
  const std::string bodiless = message("[render]\nwidth = 3\n", {"quality=draft"});
  EXPECT_TRUE(bodiless.starts_with("s.toml:")) << "where the body is to be added: " << bodiless;
}

TEST_F(SetOverrides, OfTheLibrarysQualitiesChangePicturesOnly) {
  const std::string text = body("tets = 5\n") + "[solver]\nsubsteps = 7\n";
  const Shot plain = load(text);
  for (const char* name : {"draft", "preview", "final"}) {
    Shot shot = load(text, {std::string("quality=") + name});
    EXPECT_NE(to_toml(shot), to_toml(plain)) << name;
    shot.render = plain.render;
    EXPECT_EQ(to_toml(shot), to_toml(plain)) << name;
  }
}

/// An override that leads nowhere and parts of its message.
struct WrongOverride {
  const char* set;
  std::vector<const char*> parts;
};

TEST_F(SetOverrides, SayWhatIsWrongWithThem) {
  const std::vector<WrongOverride> cases{
      {"body.tetz=3", {"--set: body.tetz = 3", "neither a body nor a field", "Did you mean 'tets'?"}},
      {"body.b.tets=3", {"--set: body.b.tets = 3", "neither a body nor a field of a body named b"}},
      {"body.a.tetz=3", {"--set: body.a.tetz = 3", "no field of this name", "Did you mean 'tets'?"}},
      {"rendr.width=3", {"--set: rendr", "no field of this name", "Did you mean 'render'?"}},
      {"render.widht=3", {"--set: render.widht = 3", "Did you mean 'width'?"}},
      {"render.width=0", {"--set: render.width = 0", "out of range", "Accepted: 1 to 32768 (pixels)"}},
      {"material.gell.density=3", {"there is no material named gell", "Accepted: gel", "Did you mean 'gel'?"}},
      {"light[2].power=3", {"light has 1 entries", "positions 0 to 0"}},
      {"body.pin[0].active=[1, 2]", {"body.a.pin has 0 entries", "no position"}},
      {"light.power=3", {"light is a list", "light[0]"}},
      {"shot.fps.x=3", {"shot.fps is a whole number", "Shorten the path."}},
      {"shot..fps=3", {"its path cannot be read"}},
      {"light[x].power=3", {"its path cannot be read"}},
      {"light[0=3", {"its path cannot be read"}},
      {"light[99999999999999999999]=3", {"its path cannot be read"}},
      {"shot.frames=[1, 2", {"neither TOML nor a bare word", "double quotes"}},
      {"shot.name=", {"neither TOML nor a bare word"}},
      {"shot.fps=1\nx = 2", {"neither TOML nor a bare word"}},
      {"shot.fps=fast", {"--set: shot.fps = \"fast\"", "it is text, not a number"}},
  };
  const std::string text = body("[shot]\nfps = 24\n[[light]]\ntype = \"area\"\n[material.gel]\n");
  for (const WrongOverride& wrong : cases) {
    const std::string said = message(text, {wrong.set});
    for (const char* part : wrong.parts)
      EXPECT_NE(said.find(part), std::string::npos) << "no '" << part << "' in:\n" << said;
    EXPECT_NE(said.find("Accepted: "), std::string::npos) << said;
  }
}

/// What is wrong may be what the file says or what the option put there.
TEST_F(SetOverrides, AreNamedBesideThePlaceOfTheTableThatTheyChange) {
  const std::string text = body("[[light]]\ntype = \"area\"\n[[light]]\ntype = \"area\"\n");
  const Shot shot = load(text, {"light[1].power=3"});
  EXPECT_EQ(to_string(shot.lights[0].origin).find("--set"), std::string::npos);
  EXPECT_TRUE(to_string(shot.lights[1].origin).ends_with(" with --set")) << to_string(shot.lights[1].origin);
}

TEST_F(SetOverrides, AskWhichOfSeveralBodiesIsMeant) {
  const std::string said = message(kFullShot, {"body.tets=3"});
  EXPECT_NE(said.find("the shot has 4 bodies"), std::string::npos) << said;
  EXPECT_NE(said.find("Name the body: body.second_by_name.tets"), std::string::npos) << said;
}

}  // namespace
}  // namespace softreel
