/// What the program says when something is wrong: one clear message and the right exit status.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;

struct Mistake {
  const char* name;
  const char* arguments;  ///< {0} is the folder
  int status;
  std::vector<const char*> said;
};

void PrintTo(const Mistake& mistake, std::ostream* out) {
  *out << mistake.arguments;
}

class Mistakes : public ::testing::TestWithParam<Mistake> {};

TEST_P(Mistakes, AreSaidOnceWithTheRightStatus) {
  const Mistake& mistake = GetParam();
  const std::string folder = shot_folder("mistake");
  write_text(folder + "/garbage.obj", "this is no mesh\n");
  write_text(folder + "/unknown.toml", sphere_shot("[rendr]\nsamples = 3\n"));
  write_text(folder + "/syntax.toml", "schema = 1\n[shot\n");
  const Outcome outcome = run(fmt::format(fmt::runtime(mistake.arguments), folder));
  EXPECT_EQ(outcome.status, mistake.status) << outcome.err;
  for (const char* part : mistake.said)
    EXPECT_NE((outcome.err + outcome.out).find(part), std::string::npos) << part << "\nin: " << outcome.err;
  const auto first = outcome.err.find("softreel: ");
  EXPECT_EQ(outcome.err.find("softreel: ", first + 1), std::string::npos) << "two messages: " << outcome.err;
}

const Mistake kMistakes[] = {
    {"MissingShot", "softreel render {0}/none.toml", 2, {"none.toml", "No such file"}},
    {"SyntaxError", "softreel render {0}/syntax.toml", 2, {"syntax.toml:2:"}},
    {"MissingMesh", "softreel render {0}/shot.toml --output {0}/out --set body.mesh=none.obj", 2, {"none.obj"}},
    {"UnreadableMesh",
     "softreel render {0}/shot.toml --output {0}/out --set body.mesh={0}/garbage.obj",
     2,
     {"garbage.obj"}},
    {"MeshIsAFolder", "softreel render {0}/shot.toml --output {0}/out --set body.mesh={0}", 2, {"folder"}},
    {"UnknownField", "softreel check {0}/unknown.toml", 2, {"unknown.toml:", "rendr", "render"}},
    {"UnknownFieldOfSet", "softreel check {0}/shot.toml --set render.sample=3", 2, {"sample", "samples"}},
    {"WrongType", "softreel check {0}/shot.toml --set 'render.samples=\"many\"'", 2, {"render.samples", "many"}},
    {"OutOfRange",
     "softreel check {0}/shot.toml --set material.soft.poisson_ratio=0.5",
     2,
     {"poisson_ratio", "0.5", "Accepted"}},
    {"EmptySelection",
     "softreel check {0}/shot.toml --set 'body.ball.pin[0].select={{sphere={{center=[9,9,9],radius=0.1}}}}'",
     2,
     {"pin[0]", "no point"}},
    {"UnknownGroup",
     "softreel check {0}/shot.toml --set 'body.ball.pin[0].select={{group=\"spere\"}}'",
     2,
     {"spere", "sphere"}},
    {"ReversedFramesOfShot", "softreel check {0}/shot.toml --set 'shot.frames=[9, 2]'", 2, {"frames", "9"}},
    {"ReversedFrames", "softreel render {0}/shot.toml --frames 3-2", 2, {"--frames", "reversed"}},
    {"FramesOutside", "softreel render {0}/shot.toml --frames 3-9", 2, {"--frames", "1-4"}},
    {"FramesNoNumbers", "softreel render {0}/shot.toml --frames all", 2, {"--frames", "all"}},
    {"OutputIsAFile", "softreel render {0}/shot.toml --output {0}/sphere.obj/out", 1, {"sphere.obj", "--output"}},
    {"NoDiskSpace", "ulimit -f 2; softreel render {0}/shot.toml --output {0}/out", 1, {"cannot be written"}},
    {"UnknownCommand", "softreel rendr {0}/shot.toml", 2, {"rendr", "Did you mean render?"}},
    {"UnknownOption", "softreel render {0}/shot.toml --frame 3", 2, {"--frame"}},
    {"NoCommand", "softreel", 2, {"subcommand"}},
    {"UnknownExportFormat", "softreel export {0}/shot.toml --format fbx", 2, {"fbx", "obj, ply, pc2"}},
    {"TetrahedraToUnknownFormat", "softreel tetrahedralize {0}/sphere.obj -o {0}/a.xyz", 2, {".xyz", ".vtu"}},
    {"ErrorBudgetNoNumber",
     "softreel tetrahedralize {0}/sphere.obj -o {0}/a.vtu --error 1x",
     2,
     {"--error 1x", "Accepted", "0.3%"}},
    {"ErrorBudgetAndCount",
     "softreel tetrahedralize {0}/sphere.obj -o {0}/a.vtu --error 0.3% --tets 200",
     2,
     {"--tets", "--error"}},
    {"PictureToUnknownFormat",
     "softreel tetrahedralize {0}/sphere.obj -o {0}/a.vtu --picture {0}/a.jpg",
     2,
     {"--picture", "\".jpg\"", "Accepted: .png"}},
    {"PictureOfNoSize",
     "softreel inspect {0}/sphere.obj --picture {0}/a.png --picture-size huge",
     2,
     {"--picture-size huge", "1600x1200"}},
    {"CutThatIsNoPlane",
     "softreel tetrahedralize {0}/sphere.obj -o {0}/a.vtu --picture {0}/a.png --cut w=0.5",
     2,
     {"--cut w=0.5", "Accepted", "x=0.3"}},
    {"CutWithoutPicture", "softreel tetrahedralize {0}/sphere.obj -o {0}/a.vtu --cut x", 2, {"--cut", "--picture"}},
    {"CutOfASurface",
     "softreel inspect {0}/sphere.obj --picture {0}/a.png --cut x",
     2,
     {"--cut x", "is a surface", "tetrahedralize"}},
    {"ErrorBudgetOfEmbedded",
     "softreel tetrahedralize {0}/sphere.obj -o {0}/a.vtu --mode embedded --error 0.3%",
     2,
     {"embedded", "error", "Accepted"}},
    {"UnknownMode", "softreel tetrahedralize {0}/sphere.obj -o {0}/a.vtu --mode exact", 2, {"--mode", "conforming"}},
    {"InspectMissing", "softreel inspect {0}/none.ply", 2, {"none.ply"}},
    {"GoldenFrameOutside", "softreel golden {0}/shot.toml --set 'golden.frames=[9]'", 2, {"golden.frames", "9"}},
    {"NothingToMake",
     "softreel render {0}/shot.toml --output {0}/out --set output.png=false --set output.movie=true",
     2,
     {"output.png = false, but", "Accepted"}},
    {"NothingToMakeOfATurntable",
     "softreel render {0}/shot.toml --output {0}/out --turntable 2 --set output.png=false",
     2,
     {"output.png = false, but"}},
    {"NothingToPlan",
     "softreel render {0}/shot.toml --output {0}/out --dry-run --set output.png=false",
     2,
     {"output.png = false, but"}},
    {"NameOfAShotThatIsNoUtf8",
     "sed '/^name = /d' {0}/shot.toml > {0}/\"$(printf 'b\\377d')\".toml; softreel render {0}/b*d.toml --output "
     "{0}/out",
     2,
     {"the name of the shot is not UTF-8", "Rename"}},
    {"OutputThatIsNoUtf8",
     "softreel simulate {0}/shot.toml --output {0}/\"$(printf 'o\\377t')\"",
     2,
     {"the output folder is not UTF-8", "Rename"}},
    {"MeshOfANewShotThatIsNoUtf8",
     "cp {0}/sphere.obj {0}/\"$(printf 'm\\377sh')\".obj; softreel new {0}/m*sh.obj -o {0}/new.toml",
     2,
     {"the name of the mesh is not UTF-8", "Rename"}},
    {"EmptyFrames", "softreel render {0}/shot.toml --frames \"\"", 2, {"--frames: the value is empty", "Accepted"}},
    {"EmptyOutput", "softreel render {0}/shot.toml --output ''", 2, {"--output: the value is empty"}},
    {"EmptyCut", "softreel preview {0}/shot.toml --cut ''", 2, {"--cut: the value is empty"}},
    {"EmptyLogFile", "softreel check {0}/shot.toml --log-file ''", 2, {"--log-file: the value is empty"}},
    {"EmptyNew", "softreel new {0}/sphere.obj -o ''", 2, {"--output: the value is empty"}},
    {"EmptyUnit", "softreel export {0}/shot.toml --unit ''", 2, {"--unit: the value is empty"}},
    {"CacheLimitBelowZero",
     "softreel render {0}/shot.toml --cache-limit -1",
     2,
     {"--cache-limit: -1 is no size. Accepted: a number of GB from 0"}},
    {"MistypedOption",
     "softreel render {0}/shot.toml --frmes 1-2",
     2,
     {"render: not expected: --frmes 1-2.", "Did you mean --frames?", "softreel render --help"}},
    {"FrameBeyondAll", "softreel check {0}/shot.toml --set 'shot.frames=[1, 1000000000]'", 2, {"-1000000 to 1000000"}},
    {"PlaceThatTheShotDoesNotHave",
     "softreel explain body.nobody.tets --shot {0}/shot.toml",
     2,
     {"has no body.nobody", "Accepted: body.tets"}},
    {"SetWithoutValue", "softreel check {0}/shot.toml --set render.samples", 2, {"render.samples", "="}},
};

INSTANTIATE_TEST_SUITE_P(Program, Mistakes, ::testing::ValuesIn(kMistakes),
                         [](const auto& mistake) { return std::string(mistake.param.name); });

TEST(ReadOnlyOutput, IsSaidWithTheFolder) {
  const std::string folder = shot_folder("readonly");
  const std::string locked = folder + "/locked";
  // Root may write anywhere: the program runs as nobody.
  const Outcome probe = run("setpriv --reuid 65534 --clear-groups test -x '" SOFTREEL_PROGRAM "'");
  if (probe.status != 0) GTEST_SKIP() << "cannot run the program as another user here: " << probe.err;
  run(fmt::format("mkdir {0}; chmod 555 {0}; chmod 755 {1} {1}/..", locked, folder));
  const Outcome outcome =
      run(fmt::format("setpriv --reuid 65534 --clear-groups '{}' render {}/shot.toml --output {}/out", SOFTREEL_PROGRAM,
                      folder, locked));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find(locked), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("Permission denied"), std::string::npos) << outcome.err;
}

TEST(FullDisk, KeepsTheFramesThatWereFinished) {
  const std::string folder = shot_folder("full");
  ASSERT_EQ(run(fmt::format("softreel render {0}/shot.toml --output {0}/out --frames 1-2 --quiet", folder)).status, 0);
  const std::string first = read_text(folder + "/out/ball.0001.png");
  EXPECT_EQ(run(fmt::format("ulimit -f 2; softreel render {0}/shot.toml --output {0}/out --quiet", folder)).status, 1);
  EXPECT_EQ(read_text(folder + "/out/ball.0001.png"), first);
  EXPECT_EQ(run(fmt::format("softreel render {0}/shot.toml --output {0}/out --quiet", folder)).status, 0);
  EXPECT_TRUE(exists(folder + "/out/ball.0004.png"));
}

TEST(Help, NamesEverySubcommandAndEndsWithStatusZero) {
  const Outcome outcome = run("softreel --help");
  EXPECT_EQ(outcome.status, 0);
  for (const char* command :
       {"render", "sheet", "simulate", "export", "preview", "golden", "batch", "check", "inspect", "tetrahedralize"}) {
    EXPECT_NE(outcome.out.find(command), std::string::npos) << command;
    EXPECT_EQ(run(fmt::format("softreel {} --help", command)).status, 0) << command;
  }
}

}  // namespace
}  // namespace softreel
