// Every message: its place, its field, its value, what is wrong, what is accepted, what to do next.
#include "tests/tool/shot/shot_files.h"

namespace softreel {
namespace {

using ShotMessage = ShotFiles;

/// A shot that cannot be read and parts that its message must have.
struct Wrong {
  const char* lines;  ///< inside the table of body a (lines 3 and on), and after it
  std::vector<const char*> parts;
};

void expect_parts(const std::string& message, const std::vector<const char*>& parts) {
  for (const char* part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << "no '" << part << "' in:\n" << message;
  EXPECT_NE(message.find("Accepted: "), std::string::npos) << message;
}

TEST_F(ShotMessage, HasItsFiveParts) {
  EXPECT_EQ(message(body("tets = -3\n")),
            "s.toml:3:8: body.a.tets = -3 is wrong because it is out of range.\n"
            "  Accepted: 1 to 500000000. Correct it, or leave the field out for its default: 20000.");
}

TEST_F(ShotMessage, NamesUnknownFieldsAndTheNearestKnown) {
  const std::vector<Wrong> cases{
      {"  materail = 3\n", {"s.toml:3:3: body.a.materail = 3", "no field of this name", "Did you mean 'material'?"}},
      {"[camra]\nmode = 1\n", {"s.toml:3:2: camra", "no field of this name", "Did you mean 'camera'?"}},
      {"[render]\nsample = 3\n", {"s.toml:4:1: render.sample = 3", "Did you mean 'samples'?"}},
      {"[[body.a.pin]]\nselect = { boxx = 3 }\n",
       {"s.toml:4:12: body.a.pin[0].select.boxx = 3", "Did you mean 'box'?"}},
      {"[[body.a.pin]]\nselect = { all = true }\nkeys = [{ frame = 1, rotate = [0, 0, 0] }]\n",
       {"s.toml:5:22: body.a.pin[0].keys[0].rotate", "Accepted: frame, translate, rotate_deg"}},
      {"zzzzzzzz = 1\n", {"s.toml:3:1: body.a.zzzzzzzz = 1", "Remove it, or use one of these."}},
  };
  for (const Wrong& wrong : cases) expect_parts(message(body(wrong.lines)), wrong.parts);
}

TEST_F(ShotMessage, SaysWhichKindOfValueIsWrong) {
  const std::vector<Wrong> cases{
      {"fit = \"tall\"\n", {"s.toml:3:7: body.a.fit = \"tall\"", "it is text, not a number", "above 0 (m)"}},
      {"tets = 2.5\n", {"s.toml:3:8: body.a.tets = 2.5", "it is not a whole number"}},
      {"tets = true\n", {"it is true or false, not a whole number"}},
      {"material = 3\n", {"s.toml:3:12: body.a.material = 3", "it is a whole number, not text"}},
      {"material = \"\"\n", {"body.a.material = \"\"", "it is empty"}},
      {"up = \"w\"\n", {"s.toml:3:6: body.a.up = \"w\"", "it is none of the choices", "\"x\", \"y\" or \"z\""}},
      {"translate = 3\n", {"body.a.translate = 3", "it is a whole number, not a list of 3 numbers"}},
      {"translate = [1, 2]\n", {"s.toml:3:13: body.a.translate = [1, 2]", "the list has 2 values, not 3"}},
      {"translate = [1, 2, \"x\"]\n", {"s.toml:3:20: body.a.translate[2] = \"x\"", "it is text, not a number"}},
      {"fit = nan\n", {"body.a.fit = nan", "it is not finite"}},
      {"fit = inf\n", {"body.a.fit = inf", "it is not finite"}},
      {"fit = 1979-05-27\n", {"body.a.fit = 1979-05-27", "it is a date, not a number"}},
      {"pin = 3\n", {"s.toml:3:7: body.a.pin = 3", "it is a whole number", "a list of tables"}},
      {"[output]\npng = 1\n", {"s.toml:4:7: output.png = 1", "not true or false"}},
      {"[render]\n[render.width]\n", {"render.width = {}", "it is a table, not a whole number"}},
      {"[solver]\nrotation = \"consistant\"\n", {"s.toml:4:12:", "Did you mean \"consistent\"?"}},
  };
  for (const Wrong& wrong : cases) expect_parts(message(body(wrong.lines)), wrong.parts);
  expect_parts(message("body = 3\n"), {"s.toml:1:8: body = 3", "it is a whole number"});
  expect_parts(message("[body]\na = 3\n"), {"s.toml:2:5: body.a = 3", "it is a whole number"});
}

TEST_F(ShotMessage, RefusesFieldsThatExcludeEachOther) {
  const std::vector<Wrong> cases{
      {"edge = 0.1\ntets = 5\n", {"s.toml:3:8: body.a.edge = 0.1", "tets is given too (s.toml:4:8)", "not both"}},
      {"fit = 1\nscale = 2\n", {"s.toml:4:9: body.a.scale = 2", "fit is given too (s.toml:3:7)"}},
      {"[[body.a.region]]\nselect = { all = true }\nmaterial = \"default\"\nstiffness = 2\n",
       {"s.toml:6:13: body.a.region[0].stiffness = 2", "material is given too"}},
  };
  for (const Wrong& wrong : cases) expect_parts(message(body(wrong.lines)), wrong.parts);
}

TEST_F(ShotMessage, RefusesFramesAndKeysOutOfOrder) {
  const std::string pin = "[[body.a.pin]]\nselect = { all = true }\n";
  expect_parts(message(body("[shot]\nframes = [5, 4]\n")),
               {"s.toml:4:10: shot.frames = [5, 4]", "it ends before it begins", "Exchange the two frames."});
  expect_parts(message(body("[shot]\nframes = [5]\n")), {"it is not a list of two frames"});
  expect_parts(message(body(pin + "active = [5, 4]\n")), {"s.toml:5:10: body.a.pin[0].active = [5, 4]", "ends before"});
  expect_parts(message(body(pin + "active = []\n")), {"it would never be active"});
  expect_parts(message(body(pin + "active = [[1, 2], [3]]\n")), {"s.toml:5:19: body.a.pin[0].active[1] = [3]"});
  expect_parts(message(body(pin + "keys = []\n")), {"s.toml:5:8: body.a.pin[0].keys = []", "the list has no key"});
  expect_parts(message(body(pin + "keys = [{ frame = 2 }, { frame = 1 }]\n")),
               {"s.toml:5:24: body.a.pin[0].keys[1]", "its frame 1 does not come after the frame 2", "Sort the keys"});
  expect_parts(message(body(pin + "keys = [{ frame = 2 }, { frame = 2 }]\n")), {"its frame 2 does not come after"});
  expect_parts(message(body(pin + "keys = [{ translate = [0, 0, 0] }]\n")),
               {"s.toml:5:9: body.a.pin[0].keys[0].frame = (nothing)", "it must be given"});
  expect_parts(message(body("[camera]\nfocal_length_mm = [{ frame = 1 }]\n")),
               {"s.toml:4:20: camera.focal_length_mm[0].value = (nothing)"});
  expect_parts(message(body("[camera]\nfocal_length_mm = []\n")), {"camera.focal_length_mm = []", "no key"});
  expect_parts(message(body("[golden]\nframes = [3, 3]\n")), {"s.toml:4:14: golden.frames[1] = 3"});
}

TEST_F(ShotMessage, RefusesKeysThatAreNotFinite) {
  const std::string pin = "[[body.a.pin]]\nselect = { all = true }\n",
                    pull = "[[body.a.pull]]\nselect = { all = true }\n";
  const auto refused = [&](const std::string& lines, const std::string& field, const std::string& bad) {
    const std::string named = field + " = " + bad;
    expect_parts(message(body(lines)), {named.c_str(), "it is not finite"});
  };
  for (const std::string bad : {"nan", "inf", "-inf"}) {
    refused(pin + "keys = [{ frame = 1 }, { frame = 2, translate = [0, " + bad + ", 0] }]\n",
            "s.toml:5:53: body.a.pin[0].keys[1].translate[1]", bad);
    refused(pin + "keys = [{ frame = " + bad + " }]\n", "s.toml:5:19: body.a.pin[0].keys[0].frame", bad);
    refused(pull + "stiffness = [{ frame = 1, value = " + bad + " }]\n", "body.a.pull[0].stiffness[0].value", bad);
    refused("[camera]\nfocal_length_mm = [{ frame = 3, value = " + bad + " }]\n", "camera.focal_length_mm[0].value",
            bad);
  }
}

TEST_F(ShotMessage, NamesWhatIsMissing) {
  expect_parts(message("[body.a]\n"), {"s.toml:1:1: body.a.mesh = (nothing)", "it must be given", "Add a line mesh"});
  expect_parts(message("[shot]\nfps = 24\n"), {"body.NAME", "it must be given"});
  expect_parts(message(""), {"s.toml:1:1: body.NAME"});
  expect_parts(message(body("[[body.a.pin]]\n")), {"s.toml:3:1: body.a.pin[0].select = (nothing)"});
  expect_parts(message(body("[[body.a.pull]]\nselect = { all = true }\n")), {"body.a.pull[0].stiffness = (nothing)"});
  expect_parts(message(body("[[light]]\n")), {"light[0].type = (nothing)", "\"sphere\" or \"sun\""});
  expect_parts(message(body("[camera]\nmode = \"place\"\ntarget = [0, 0, 0]\n")), {"needs a position", "Add position"});
  expect_parts(message(body("[[body.a.region]]\nselect = { all = true }\n")), {"it changes nothing"});
}

TEST_F(ShotMessage, NamesTheNearestMaterial) {
  const std::string materials = "[material.rubber]\n[material.gel]\n";
  expect_parts(message(body("material = \"ruber\"\n" + materials)),
               {"s.toml:3:12: body.a.material = \"ruber\"", "no material of this name", "Accepted: gel, rubber",
                "Did you mean 'rubber'?"});
  expect_parts(message(body("material = \"gel\"\n[[body.a.region]]\nselect = { all = true }\nmaterial = \"gell\"\n" +
                            materials)),
               {"s.toml:6:12: body.a.region[0].material = \"gell\"", "Did you mean 'gel'?"});
  expect_parts(message(body(materials)), {"s.toml:1:1: body.a.material = (nothing)", "gel, rubber"});
}

TEST_F(ShotMessage, RefusesWhatHasNoMeaning) {
  const std::string pin = "[[body.a.pin]]\nselect = ";
  expect_parts(message(body(pin + "{ unit = \"box\" }\n")), {"s.toml:4:10:", "it has no shape"});
  expect_parts(message(body(pin + "{ all = true, group = \"x\" }\n")), {"it has several shapes"});
  expect_parts(message(body(pin + "[]\n")), {"the list is empty"});
  expect_parts(message(body(pin + "{ box = { min = [0, 1, 0], max = [1, 0, 1] } }\n")),
               {"its min is above its max", "a min that is not above the max"});
  expect_parts(message(body(pin + "{ plane = { point = [0, 1, 0], normal = [0, 0, 0] } }\n")),
               {"no length", "of any length above 0"});
  expect_parts(message(body("[[light]]\ntype = \"sun\"\npower = 3\n")),
               {"s.toml:5:9: light[0].power = 3", "a sun has no such field"});
  expect_parts(message(body("[[light]]\ntype = \"area\"\nangle_deg = 3\n")), {"an area light has no such field"});
  expect_parts(message(body("[[light]]\ntype = \"sun\"\ndirection = [0, 0, 0]\n")), {"its direction has no length"});
  expect_parts(message(body("[[light]]\ntype = \"area\"\ncenter = [1, 0, 0]\naim = [1, 0, 0]\n")), {"its own center"});
  expect_parts(message("[body.\"a/b\"]\nmesh = \"x\"\n"), {"s.toml:1:1: body.\"a/b\"", "files are named after"});
  expect_parts(message(body("[shot]\nname = \"a/b\"\n")), {"shot.name = \"a/b\"", "files are named after it"});
}

TEST_F(ShotMessage, SaysWhichValuesOfTheSolverDoNotGoTogether) {
  const std::vector<Wrong> cases{
      {"[solver]\nnewmark_gamma = 0.6\n",
       {"s.toml:4:17: solver.newmark_gamma = 0.6", "twice newmark_beta = 0.25 is below newmark_gamma = 0.6",
        "Accepted: 2 newmark_beta at least newmark_gamma", "Say newmark_beta = 0.3"}},
      {"[solver]\nnewmark_gamma = 0.9\nnewmark_beta = 0.3\n", {"s.toml:5:16: solver.newmark_beta = 0.3"}},
      {"[solver]\nsubsteps = 9\nstep_error = 1e-3\nmax_substeps = 8\n",
       {"s.toml:6:16: solver.max_substeps = 8", "at least 9 and at most 8 steps", "Raise max_substeps"}},
      {"[solver]\nsubsteps = 2000\nstep_error = 1e-3\n",
       {"s.toml:4:12: solver.substeps = 2000", "Accepted: max_substeps not below substeps"}},
  };
  for (const Wrong& wrong : cases) expect_parts(message(body(wrong.lines)), wrong.parts);
  EXPECT_EQ(message(body("[solver]\nsubsteps = 2000\nmax_substeps = 1\n")), "") << "there is no error control";
}

TEST_F(ShotMessage, PlacesMistakesOfTomlItself) {
  expect_parts(message("[body.a]\nmesh = \"a.ply\"\ntets = = 3\n"), {"s.toml:3:8: this is no TOML: "});
  expect_parts(message("[body.a]\nmesh = \"a.ply\"\nmesh = \"b.ply\"\n"), {"s.toml:3:", "mesh"});
}

TEST_F(ShotMessage, TellsOfFilesThatCannotBeRead) {
  try {
    load_shot("shots/x.toml", {});
    FAIL();
  } catch (const Error& error) {
    expect_parts(error.what(), {"shots/x.toml: cannot be read: No such file or directory.", "Check the spelling"});
  }
  std::filesystem::create_directory("folder.toml");
  try {
    load_shot("folder.toml", {});
    FAIL();
  } catch (const Error& error) {
    expect_parts(error.what(), {"folder.toml: cannot be read: Is a directory."});
  }
}

TEST_F(ShotMessage, RefusesShotsOfANewerProgram) {
  expect_parts(message("schema = 2\n" + body("")), {"s.toml:1:10: schema = 2", "written for a newer softreel",
                                                    "Accepted: 1 to 1", "Use a newer softreel."});
  expect_parts(message("schema = 0\n" + body("")), {"schema = 0", "out of range"});
  expect_parts(message("schema = \"one\"\n" + body("")), {"schema = \"one\"", "text, not a whole number"});
}

TEST_F(ShotMessage, ShowsAllProblemsOfOneShot) {
  const std::string text = message(body("fit = -1\ntetz = 3\n[render]\nwidth = 0\n"));
  expect_parts(text, {"s.toml:3:7: body.a.fit", "s.toml:4:1: body.a.tetz", "s.toml:6:9: render.width"});
}

TEST_F(ShotMessage, CutsLongValues) {
  const std::string text = message(body("fit = \"" + std::string(5000, 'x') + "\"\n"));
  EXPECT_LT(text.size(), 400u);
}

}  // namespace
}  // namespace softreel
