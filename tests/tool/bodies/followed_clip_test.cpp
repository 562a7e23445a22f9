/// What is said of clips, and what is kept of files that several constraints follow.
#include "tool/bodies/followed_clip.h"

#include <cstring>

#include "core/base/error.h"
#include "tests/core/mesh/mesh_files.h"
#include "tool/bodies/followed_files.h"

namespace softreel {
namespace {

/// Frames of a film from frame 1 on.
constexpr ClipTiming kFilm{1, 24, 1};

/// "hand" under "arm", which a clip moves by 1 m from one second to another, with so many keys.
SceneAnimation moving_arm(double begin, double end, int keys) {
  SceneAnimation scene;
  scene.nodes = {{"arm", -1, {}}, {"hand", 0, {}}, {"lamp", -1, {}}};
  NodeChannel channel;
  for (int k = 0; k < keys; ++k) {
    const double share = static_cast<double>(k) / (keys - 1);
    channel.translation.seconds.push_back(begin + share * (end - begin));
    channel.translation.values.emplace_back(share, 0, 0);
  }
  scene.clips = {{"wave", end, {channel}, {}}};
  return scene;
}

FollowedClip follow(const SceneAnimation& scene, Index node, const std::string& file) {
  return {file, scene, scene.clips[0], {}, SceneNodes(scene, &scene.clips[0], {node})};
}

void expect_parts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << part << "\n" << message;
}

TEST(StraightCurveWarning, IsOfKeysFurtherApartThanBakedOnes) {
  const std::string fbx = "a.fbx", gltf = "a.glb";
  const SceneAnimation drawn = moving_arm(0, 1, 3), baked = moving_arm(0, 1, 25);
  expect_parts(straight_curve_warning(follow(drawn, 1, fbx), 24),
               {"a.fbx", "clip 'wave'", "translation of node 'arm'", "0 to 0.5 s", "Bake"});
  EXPECT_EQ(straight_curve_warning(follow(baked, 1, fbx), 24), "");
  EXPECT_EQ(straight_curve_warning(follow(baked, 1, fbx), 120), "") << "baked for film, shown in many frames";
  EXPECT_EQ(straight_curve_warning(follow(drawn, 2, fbx), 24), "") << "nothing moves the lamp";
  EXPECT_EQ(straight_curve_warning(follow(drawn, 1, gltf), 24), "") << "glTF says what its curves are";
}

TEST(StraightCurveWarning, IsNotOfValuesThatStand) {
  const std::string fbx = "a.fbx";
  SceneAnimation still = moving_arm(0, 1, 3);
  for (Vec3& value : still.clips[0].nodes[0].translation.values) value = Vec3(1, 2, 3);
  EXPECT_EQ(straight_curve_warning(follow(still, 1, fbx), 24), "");
}

TEST(StillClipWarning, NamesTheStartThatBringsTheClipIntoTheShot) {
  const std::string file = "a.glb";
  const SceneAnimation late = moving_arm(1001.0 / 24, 1096.0 / 24, 96);
  expect_parts(still_clip_warning(follow(late, 1, file), kFilm, 1, 96),
               {"a.glb", "clip 'wave'", "frames 1 to 96", "41.71 to 45.67 s", "start = -1000 "});
  EXPECT_EQ(still_clip_warning(follow(late, 1, file), {-1000, 24, 1}, 1, 96), "");
  EXPECT_NE(still_clip_warning(follow(late, 1, file), {-2000, 24, 1}, 1, 96), "") << "it is over";
  EXPECT_EQ(still_clip_warning(follow(moving_arm(0, 1, 2), 1, file), kFilm, 1, 1), "") << "it begins in the only frame";
  EXPECT_EQ(still_clip_warning(follow(late, 2, file), kFilm, 1, 96), "") << "the lamp has no keys";
}

TEST(RequireOwnNames, RefusesNamesThatCouldBeOfSeveralNodes) {
  const std::string file = "a.glb";
  SceneAnimation scene = moving_arm(0, 1, 2);
  scene.nodes.push_back({"lamp", 1, {}});
  EXPECT_NO_THROW(require_own_names(follow(scene, 1, file))) << "nothing is asked of the lamps";
  EXPECT_NO_THROW(require_own_names(follow(scene, 3, file))) << "the clip moves neither";
  SceneMesh mesh;
  mesh.name = "sleeve";
  mesh.node = 1;
  mesh.joints = {{2, {}}};
  scene.meshes = {mesh};
  const FollowedClip sleeve{file, scene, scene.clips[0], {0}, SceneNodes(scene, &scene.clips[0], {1, 2})};
  try {
    require_own_names(sleeve);
    ADD_FAILURE() << "it hangs on one of two lamps";
  } catch (const Error& error) {
    expect_parts(error.what(), {"a.glb", "a joint of mesh 'sleeve'", "'lamp'", "Accepted", "Rename"});
  }
  scene.nodes[2].name = "arm";
  EXPECT_THROW(require_own_names(follow(scene, 1, file)), Error) << "the clip moves one of two arms";
}

/// A point cache of three points in two samples.
std::string three_points() {
  const auto bytes = [](auto value) { return std::string(reinterpret_cast<const char*>(&value), sizeof value); };
  std::string text("POINTCACHE2\0", 12);
  text += bytes(std::int32_t{1}) + bytes(std::int32_t{3}) + bytes(0.0f) + bytes(1.0f) + bytes(std::int32_t{2});
  for (int k = 0; k < 18; ++k) text += bytes(static_cast<float>(k * k));
  return text;
}

TEST(FollowedFiles, ReadAPointCacheOnce) {
  const testing::TemporaryFolder folder;
  LoadedBody body;
  body.surface.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  body.surface.triangles = {{0, 1, 2}};
  FollowSettings settings;
  settings.file = folder.write("points.pc2", three_points());
  FollowedFiles files;
  const FollowedMotion& first = files.motion({}, settings, body, Log{});
  folder.write("points.pc2", "no longer a cache");
  EXPECT_EQ(files.motion({}, settings, body, Log{}).pose(1.5), first.pose(1.5));
}

}  // namespace
}  // namespace softreel
