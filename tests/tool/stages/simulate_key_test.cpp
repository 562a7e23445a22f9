/// Which edits change which keys: the promises of design sec. 1.
#include "tool/stages/simulate_key.h"

#include <functional>

#include <gtest/gtest.h>

namespace softreel {
namespace {

Shot simple_shot() {
  Shot shot;
  shot.settings.first_frame = 1;
  shot.settings.last_frame = 60;
  return shot;
}

/// One tetrahedron under one pin that moves from frame 48 to 60.
BodyModel simple_model() {
  BodyModel model;
  model.mesh.tets = {{0, 1, 2, 3}};
  model.materials = {ElementMaterial{}};
  Pin pin;
  pin.points = {0};
  pin.track.keys = {{1, {}, Ease::Smooth}, {48, {}, Ease::Smooth}, {60, {Vec3(0, 1, 0)}, Ease::Smooth}};
  model.pins = {pin};
  return model;
}

/// Keys of all frames.
std::vector<StageKey> chain(const Shot& shot, const BodyModel& model) {
  std::vector<StageKey> keys;
  StageKey previous = simulation_base_key(shot, model, "filled");
  for (int frame = shot.settings.first_frame; frame <= shot.settings.last_frame; ++frame) {
    previous = frame_key(shot, model, previous, frame, frame == shot.settings.first_frame);
    keys.push_back(previous);
  }
  return keys;
}

/// First frame whose key an edit changes; 0 if none.
int first_changed(const std::function<void(Shot&, BodyModel&)>& edit) {
  Shot shot = simple_shot();
  BodyModel model = simple_model();
  const std::vector<StageKey> before = chain(shot, model);
  edit(shot, model);
  const std::vector<StageKey> after = chain(shot, model);
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i)
    if (before[i] != after[i]) return static_cast<int>(i) + 1;
  return 0;
}

TEST(FrameKey, AnEditedKeyChangesNoFrameBeforeItsSegment) {
  EXPECT_EQ(first_changed([](Shot&, BodyModel& m) { m.pins[0].track.keys[2].value.translate.x() = 1; }), 49);
}

TEST(FrameKey, AnEditThatChangesNoValueChangesNothing) {
  EXPECT_EQ(first_changed([](Shot&, BodyModel& m) { m.pins[0].track.keys.erase(m.pins[0].track.keys.begin()); }), 0);
  EXPECT_EQ(first_changed([](Shot&, BodyModel& m) { m.pins[0].track.keys[0].ease = Ease::Constant; }), 0);
  EXPECT_EQ(first_changed([](Shot&, BodyModel& m) { m.pins[0].name = "another"; }), 0);
  EXPECT_EQ(first_changed([](Shot&, BodyModel& m) {
              for (auto& key : m.pins[0].track.keys) key.value.pivot = Vec3(1, 2, 3);
            }),
            0)
      << "nothing turns about the pivot";
}

TEST(FrameKey, WhatIsSwitchedOffHasNoValue) {
  EXPECT_EQ(first_changed([](Shot&, BodyModel& m) { m.pins[0].active = {{1, 30}}; }), 31);
}

TEST(FrameKey, ALongerShotKeepsItsFrames) {
  EXPECT_EQ(first_changed([](Shot& s, BodyModel&) { s.settings.last_frame = 90; }), 0);
}

TEST(FrameKey, LooksChangeNothing) {
  EXPECT_EQ(first_changed([](Shot& s, BodyModel&) {
              s.render.params.samples = 512;
              s.output.exr = true;
              s.camera.azimuth_deg = 0;
              s.materials["x"].appearance.roughness = 0;
              s.threads = 7;
              s.solver.force_tolerance = 1e-9;  // of statics; this shot is dynamic and starts at rest
            }),
            0);
}

TEST(FrameKey, PhysicsChangesEveryFrame) {
  EXPECT_EQ(first_changed([](Shot& s, BodyModel&) { s.solver.substeps = 3; }), 1);
  EXPECT_EQ(first_changed([](Shot& s, BodyModel&) { s.settings.fps = 25; }), 1);
  EXPECT_EQ(first_changed([](Shot& s, BodyModel&) { s.solver.rotation = RotationMethod::Energy; }), 1);
  EXPECT_EQ(first_changed([](Shot&, BodyModel& m) { m.materials[0].density = 900; }), 1);
  EXPECT_EQ(first_changed([](Shot&, BodyModel& m) { m.gravity.y() = -1.62; }), 1);
  EXPECT_EQ(first_changed([](Shot&, BodyModel& m) { m.pins[0].points = {0, 1}; }), 1);
}

}  // namespace
}  // namespace softreel
