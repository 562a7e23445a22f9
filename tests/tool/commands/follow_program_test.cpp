/// Constraints from the scene through the built program: animated nodes and surfaces, point caches, weights, grabbing.
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/types.h"
#include "tests/support/gltf_scene.h"
#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

/// A ball on a pinned sole in four frames of a third of a second, with `more` constraints.
std::string ball_shot(const std::string& more) {
  return R"(schema = 1
[shot]
name = "ball"
fps = 3
frames = [1, 4]
[body.ball]
mesh = "sphere.obj"
tets = 700
[[body.ball.pin]]
select = { box = { min = [0, 0, 0], max = [1, 0.1, 1] }, unit = "box" }
[output]
movie = false
)" + more;
}

constexpr const char* kTop = "select = { box = { min = [0, 0.93, 0], max = [1, 1, 1] }, unit = \"box\" }\n";

class Follow : public ::testing::Test {
 protected:
  void start(const std::string& name, const std::string& more) {
    folder_ = new_folder("follow_" + name);
    write_text(folder_ + "/sphere.obj", sphere_obj(12));
    write_text(folder_ + "/shot.toml", ball_shot(more));
    write_jaw(folder_);
  }

  /// Positions of all vertices by frame and vertex.
  std::vector<std::vector<Vec3>> export_frames(const std::string& options = "", const std::string& out = "out") {
    const Outcome outcome = run(
        fmt::format("softreel export {0}/shot.toml --format pc2 --quiet --output {0}/{1} {2}", folder_, out, options));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return positions(fmt::format("{}/{}/ball.ball.pc2", folder_, out));
  }

  static std::vector<std::vector<Vec3>> positions(const std::string& path) {
    const std::string bytes = read_text(path);
    std::int32_t points = 0, samples = 0;
    std::memcpy(&points, bytes.data() + 16, 4);
    std::memcpy(&samples, bytes.data() + 28, 4);
    std::vector<std::vector<Vec3>> frames(static_cast<std::size_t>(samples));
    std::size_t at = 32;
    for (auto& frame : frames)
      for (std::int32_t p = 0; p < points; ++p, at += 12) {
        Eigen::Vector3f position;
        std::memcpy(position.data(), bytes.data() + at, 12);
        frame.push_back(position.cast<double>());
      }
    return frames;
  }

  json simulate(const std::string& options = "") {
    const Outcome outcome =
        run(fmt::format("softreel simulate {0}/shot.toml --output {0}/out --quiet --json {1}", folder_, options));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out)["simulation"];
  }

  /// What `check` says of a shot that it must refuse.
  std::string refusal(const std::string& more) {
    write_text(folder_ + "/shot.toml", ball_shot(more));
    const Outcome outcome = run(fmt::format("softreel check {}/shot.toml", folder_));
    EXPECT_EQ(outcome.status, 2) << outcome.out << outcome.err;
    return outcome.err;
  }

  static void expect_parts(const std::string& message, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << part << "\n" << message;
  }

  std::string folder_;
};

std::string pin_on_top(const std::string& follow) {
  return fmt::format("[[body.ball.pin]]\n{}follow = {{ {} }}\n", kTop, follow);
}

TEST_F(Follow, ANodeThatTurnsCarriesPinnedPointsExactly) {
  start("node", pin_on_top("file = \"jaw.gltf\", node = \"jaw\", start = 2, speed = 1.5"));
  const auto frames = export_frames();
  ASSERT_EQ(frames.size(), 4u);
  const Vec3 top(0, 1, 0), center(0, 1, 0.5);
  EXPECT_LT((frames[0][0] - top).norm(), 1e-6) << "the clip has not begun";
  EXPECT_LT((frames[1][0] - top).norm(), 1e-6) << "it begins";
  const Vec3 q = top - center;  // a quarter turn about x takes y to z, and z to -y
  EXPECT_LT((frames[3][0] - (center + Vec3(q.x(), -q.z(), q.y()))).norm(), 2e-6) << "its end, after two frames";
  EXPECT_GT((frames[2][0] - top).norm(), 0.2);
}

TEST_F(Follow, AnotherFileContentIsAnotherSimulationFromWhereItDiffers) {
  start("content", pin_on_top("file = \"jaw.gltf\", node = \"jaw\", start = 2"));
  EXPECT_EQ(simulate()["computed"], 4);
  EXPECT_EQ(simulate()["computed"], 0);
  const std::string other = folder_ + "/other";
  std::filesystem::create_directory(other);
  write_jaw(folder_, "jaw", "another name");  // the same motion
  EXPECT_EQ(simulate()["computed"], 0);
  std::string text = read_text(folder_ + "/jaw.gltf");
  const std::string jaw = "\"translation\": [0, 0, 0.5]";
  text.replace(text.find(jaw), jaw.size(), "\"translation\": [0, 0, 0.4]");
  write_text(folder_ + "/jaw.gltf", text);
  EXPECT_EQ(simulate()["computed"], 3) << "all but the first frame, at rest";
  const Outcome status = run(fmt::format("softreel status {0}/shot.toml --output {0}/out", folder_));
  EXPECT_EQ(status.status, 0) << status.err;
}

TEST_F(Follow, StatusNamesASceneOfWhichOnlyTheBufferChanged) {
  start("buffer", pin_on_top("file = \"jaw.gltf\", node = \"jaw\""));
  const auto softreel = [&](const std::string& command) {
    const Outcome outcome = run(
        fmt::format("softreel {1} {0}/shot.toml --output {0}/out --set render.width=32 --set render.height=18 --set "
                    "render.samples=1",
                    folder_, command));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out;
  };
  softreel("render --quiet");
  std::string buffer = read_text(folder_ + "/jaw.bin");
  const std::array<float, 4> turn{0.5f, 0, 0, 0.8660254f};
  std::memcpy(buffer.data() + buffer.size() - sizeof turn, turn.data(), sizeof turn);
  write_text(folder_ + "/jaw.bin", buffer);
  const json status = json::parse(softreel("status --json"));
  std::string because;
  for (const json& stage : status["stages"])
    if (stage["stage"] == "pictures") because = stage["because"].dump();
  EXPECT_NE(because.find("content of "), std::string::npos) << because;
  EXPECT_NE(because.find("jaw.gltf"), std::string::npos) << because;
}

TEST_F(Follow, ASkinnedMeshTakesAPinnedPointAlong) {
  start("mesh",
        "[[body.ball.pin]]\nselect = { nearest = { point = [0, 2, 0] } }\nfollow = { file = \"strip.gltf\", mesh = "
        "\"body_skin\", speed = 2, placement = \"scene\" }\n");
  write_strip(folder_);
  // The ball's top is at the strip's upper end, which turns about (0, 1, 0) by 30 degrees a frame.
  const auto frames = export_frames("--set \"body.translate=[0, 1, 0]\" --set solver.substeps=4");
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const double angle = static_cast<double>(f) * std::numbers::pi / 6;
    const Vec3 at(-std::sin(angle), std::cos(angle), 0);  // exported in the file's own place, 1 m lower
    EXPECT_LT((frames[f][0] - at).norm(), 3e-6) << "frame " << f + 1;
  }
}

TEST_F(Follow, APointCacheOfTheMeshIsFollowedByVertex) {
  start("cache", "[body.ball.dummy]\n");
  write_text(folder_ + "/shot.toml",
             ball_shot("[[body.ball.pin]]\nselect = { all = true }\nactive = [1, 4]\nkeys = [{ frame = 1, ease = "
                       "\"linear\" }, { frame = 4, translate = [0.5, 0.25, 0], rotate_deg = [0, 0, 90] }]\n"));
  std::string text = read_text(folder_ + "/shot.toml");
  const std::string sole =
      "[[body.ball.pin]]\nselect = { box = { min = [0, 0, 0], max = [1, 0.1, 1] }, unit = \"box\" }\n";
  text.erase(text.find(sole), sole.size());
  write_text(folder_ + "/shot.toml", text);
  const auto moved = export_frames();
  const std::size_t keys = text.find("active = [1, 4]");
  text.replace(keys, text.find("]\n", text.find("keys")) + 1 - keys, "follow = { file = \"out/ball.ball.pc2\" }");
  write_text(folder_ + "/shot.toml", text);
  const auto followed = export_frames("", "again");
  for (std::size_t f = 0; f < moved.size(); ++f)
    for (std::size_t v = 0; v < moved[f].size(); ++v) ASSERT_LT((moved[f][v] - followed[f][v]).norm(), 3e-6) << f;
}

TEST_F(Follow, AGrabResumesInTheMiddleWithTheSameBits) {
  start("grab",
        fmt::format("[[body.ball.pin]]\n{}active = [2, 4]\ngrab = true\nfollow = {{ file = \"jaw.gltf\", node = "
                    "\"jaw\" }}\n",
                    kTop));
  const auto whole = export_frames("", "whole");
  export_frames("--frames 1-3", "parts");
  const auto resumed = export_frames("", "parts");
  ASSERT_EQ(whole.size(), resumed.size());
  for (std::size_t f = 0; f < whole.size(); ++f) EXPECT_EQ(whole[f], resumed[f]) << f;
  const double free_move = (whole[1][0] - whole[0][0]).norm();
  EXPECT_GT(free_move, 0) << "it sags before it is grabbed";
}

TEST_F(Follow, WeightsSelectPointsAndScalePulls) {
  start("weights", "");
  std::string map;
  const std::size_t vertices = 2 + 11 * 24;
  for (std::size_t v = 0; v < vertices; ++v) map += v == 0 ? "1\n" : v <= 24 ? "0.5\n" : "0\n";
  write_text(folder_ + "/map.txt", map);
  write_text(folder_ + "/shot.toml",
             ball_shot("[[body.ball.pin]]\nselect = { weights = \"map.txt\", threshold = 0.6 }\n"
                       "[[body.ball.pull]]\nstiffness = 10\nweights = \"map.txt\"\n"));
  const Outcome outcome = run(fmt::format("softreel check {}/shot.toml", folder_));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_parts(outcome.out, {"pin[1]", ": 1 points", "pull[0]", ": 25 points"});
}

TEST_F(Follow, SaysWhatTheFileHasInsteadOfWhatIsMissing) {
  start("refusals", "");
  write_strip(folder_);
  write_morph(folder_);
  const auto pin = [&](const std::string& follow) { return refusal(pin_on_top(follow)); };
  expect_parts(pin("file = \"jaw.gltf\", node = \"yaw\""),
               {"shot.toml:15:10", "body.ball.pin[1].follow", "no node 'yaw'", "'head', 'jaw'", "Did you mean 'jaw'?"});
  expect_parts(pin("file = \"strip.gltf\", mesh = \"body_skim\""),
               {"no mesh 'body_skim'", "Did you mean 'body_skin'?"});
  expect_parts(pin("file = \"jaw.gltf\", node = \"jaw\", clip = \"opens\""),
               {"no clip 'opens'", "Did you mean 'open'?"});
  expect_parts(pin("file = \"jaw.gltf\", bind = \"vertex\""), {"moves 3 vertices, but the body has 266", "nearest"});
  expect_parts(pin("file = \"missing.glb\", node = \"jaw\""), {"missing.glb", "no such"});
  expect_parts(pin("file = \"sphere.obj\", node = \"jaw\""), {"holds no animation", "point cache"});
  expect_parts(pin("file = \"jaw.gltf\", node = \"jaw\", mesh = \"skull\""), {"it has node and mesh"});
  expect_parts(refusal(pin_on_top("file = \"jaw.gltf\", node = \"jaw\"") + "keys = [{ frame = 1 }]\n"),
               {"keys or follow, not both"});
  write_text(folder_ + "/shot.toml", ball_shot(fmt::format("[[body.ball.pin]]\n{}grab = true\n", kTop)));
  const Outcome independent =
      run(fmt::format("softreel check {}/shot.toml --set shot.mode=static --set shot.independent=true", folder_));
  EXPECT_EQ(independent.status, 2);
  expect_parts(independent.err, {"pin[1].grab = true", "shot.independent"});
}

TEST_F(Follow, RefusesNamesOfSeveralNodesAndSaysWhereAClipHoldsStill) {
  start("names", "");
  write_strip(folder_);
  std::string text = read_text(folder_ + "/strip.gltf");
  text.replace(text.find("\"upper\""), 7, "\"lower\"");
  write_text(folder_ + "/twins.gltf", text);
  expect_parts(refusal(pin_on_top("file = \"twins.gltf\", mesh = \"body_skin\"")),
               {"pin[1].follow", "a joint of mesh 'body_skin", "'lower'", "several nodes", "Rename"});
  write_text(folder_ + "/shot.toml", ball_shot(pin_on_top("file = \"jaw.gltf\", node = \"jaw\", start = -200")));
  const Outcome still = run(fmt::format("softreel check {}/shot.toml", folder_));
  EXPECT_EQ(still.status, 0) << still.err;
  expect_parts(still.err, {"jaw.gltf", "clip 'open'", "start = 1 would begin that at frame 1"});
}

TEST_F(Follow, SaysWhatIsWrongWithWeights) {
  start("bad_weights", "");
  write_text(folder_ + "/short.txt", "1\n0\n");
  const auto pull = [&](const std::string& weights) {
    return refusal("[[body.ball.pull]]\nstiffness = 10\nweights = " + weights + "\n");
  };
  expect_parts(pull("\"short.txt\""), {"shot.toml:13", "body.ball.pull[0].weights", "has 2 weights", "266 vertices"});
  expect_parts(pull("{ color = \"red\" }"), {"no vertex colours"});
  expect_parts(pull("{ attribute = \"goal\" }"), {"no PLY file"});
  expect_parts(pull("{ color = \"reed\" }"), {"Did you mean \"red\"?"});
  expect_parts(refusal("[[body.ball.pull]]\nstiffness = 10\n"), {"body.ball.pull[0].select = (nothing)"});
  std::string zeros;
  for (int v = 0; v < 266; ++v) zeros += "0\n";
  write_text(folder_ + "/zeros.txt", zeros);
  expect_parts(pull("\"zeros.txt\""), {"weights are 0", "Paint some"});
}

}  // namespace
}  // namespace softreel
