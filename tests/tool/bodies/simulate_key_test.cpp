/// Which edits change which keys: the promises of design sec. 1.
#include "tool/bodies/simulate_key.h"

#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/bcc_bar.h"

namespace softreel {
namespace {

Shot simple_shot() {
  Shot shot;
  shot.settings.first_frame = 1;
  shot.settings.last_frame = 60;
  return shot;
}

/// One pin that moves from frame 48 to 60.
BodyConstraints simple_constraints() {
  Pin pin;
  pin.points = {0};
  pin.track.keys = {{1, {}, Ease::Smooth}, {48, {}, Ease::Smooth}, {60, {Vec3(0, 1, 0)}, Ease::Smooth}};
  return {{pin}, {}};
}

/// First frame whose key an edit changes; 0 if none.
int first_changed(const std::function<void(Shot&, BodyConstraints&)>& edit) {
  Shot shot = simple_shot();
  BodyConstraints constraints = simple_constraints();
  const std::vector<StageKey> before = simulation_keys(shot, shot.solver, constraints, "filled", "materials");
  edit(shot, constraints);
  const std::vector<StageKey> after = simulation_keys(shot, shot.solver, constraints, "filled", "materials");
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i)
    if (before[i] != after[i]) return static_cast<int>(i) + 1;
  return 0;
}

TEST(FrameKey, AnEditedKeyChangesNoFrameBeforeItsSegment) {
  EXPECT_EQ(first_changed([](Shot&, BodyConstraints& m) { m.pins[0].track.keys[2].value.translate.x() = 1; }), 49);
}

TEST(FrameKey, AnEditThatChangesNoValueChangesNothing) {
  EXPECT_EQ(first_changed([](Shot&, BodyConstraints& m) { m.pins[0].track.keys.erase(m.pins[0].track.keys.begin()); }),
            0);
  EXPECT_EQ(first_changed([](Shot&, BodyConstraints& m) { m.pins[0].track.keys[0].ease = Ease::Constant; }), 0);
  EXPECT_EQ(first_changed([](Shot&, BodyConstraints& m) { m.pins[0].name = "another"; }), 0);
  EXPECT_EQ(first_changed([](Shot&, BodyConstraints& m) {
              for (auto& key : m.pins[0].track.keys) key.value.pivot = Vec3(1, 2, 3);
            }),
            0)
      << "nothing turns about the pivot";
}

TEST(FrameKey, WhatIsSwitchedOffHasNoValue) {
  EXPECT_EQ(first_changed([](Shot&, BodyConstraints& m) { m.pins[0].active = {{1, 30}}; }), 31);
}

TEST(FrameKey, GlueThatBindsAnewInAnotherRangeChangesTheFramesFromThereOn) {
  const auto keys = [](std::vector<FrameRange> active) {
    BodyConstraints constraints = simple_constraints();
    constraints.glues.emplace_back().active = std::move(active);
    return simulation_keys(simple_shot(), {}, constraints, "filled", "materials");
  };
  const std::vector<StageKey> one = keys({{1, 60}}), two = keys({{1, 10}, {11, 60}});
  EXPECT_EQ(one, keys({})) << "always";
  EXPECT_EQ(one[9], two[9]);
  EXPECT_NE(one[10], two[10]);
}

/// Stored states hold the frames since which something is grabbed or sticks.
TEST(FrameKey, OfAShotThatBeginsAtAnotherFrameIsTheSameUnlessSomethingGrabsOrSticks) {
  const auto last_key = [](int shift, bool grab, bool glue) {
    Shot shot = simple_shot();
    BodyConstraints constraints = simple_constraints();
    constraints.pins[0].grab = grab;
    if (glue) constraints.glues.emplace_back();
    shot.settings.first_frame += shift;
    shot.settings.last_frame += shift;
    for (Key<Transform>& key : constraints.pins[0].track.keys) key.frame += shift;
    return simulation_keys(shot, shot.solver, constraints, "filled", "materials").back();
  };
  EXPECT_EQ(last_key(0, false, false), last_key(1000, false, false));
  EXPECT_NE(last_key(0, true, false), last_key(1000, true, false));
  EXPECT_NE(last_key(0, false, true), last_key(1000, false, true));
}

/// A pull from frame 10 to 20 by a stiffness whose keys are given.
StageKey key_with_pull(std::vector<Key<double>> stiffness, FrameRange range, Integrator integrator) {
  Shot shot = simple_shot();
  shot.solver.integrator = integrator;
  BodyConstraints constraints = simple_constraints();
  Pull& pull = constraints.pulls.emplace_back();
  pull.track.keys = {{1, {}, Ease::Smooth}};
  pull.stiffness.keys = std::move(stiffness);
  pull.active = {range};
  return simulation_keys(shot, shot.solver, constraints, "filled", "materials").back();
}

TEST(FrameKey, KnowsWherePullsJumpAndNotWhereTheyHaveNoStrength) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2, Integrator::Newmark}) {
    const std::vector<Key<double>> none{{1, 0, Ease::Linear}};
    EXPECT_EQ(key_with_pull(none, {10, 20}, integrator), key_with_pull(none, {12, 30}, integrator));
    // Comes from nothing at frame 12, and goes back to it by frame 18, wherever between it is switched.
    const std::vector<Key<double>> swell{
        {12, 0, Ease::Linear}, {14, 50, Ease::Linear}, {16, 50, Ease::Linear}, {18, 0, Ease::Linear}};
    EXPECT_EQ(key_with_pull(swell, {10, 20}, integrator), key_with_pull(swell, {12, 18}, integrator));
    // Switched on at 13 it jumps there, which Euler, who has no memory, need not know: the values are the same.
    EXPECT_EQ(key_with_pull(swell, {10, 20}, integrator) == key_with_pull(swell, {13, 20}, integrator),
              integrator == Integrator::Euler);
  }
}

TEST(FrameKey, ALongerShotKeepsItsFrames) {
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.settings.last_frame = 90; }), 0);
}

TEST(FrameKey, LooksChangeNothing) {
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) {
              s.render.params.samples = 512;
              s.output.exr = true;
              s.camera.azimuth_deg = 0;
              s.materials["x"].appearance.roughness = 0;
              s.threads = 7;
              s.solver.max_newton_iterations = 9;     // of statics; this shot is dynamic and starts at rest
              s.solver.max_substeps = 64;             // of error control, which is off
              s.solver.newmark.beta = 0.3;            // of another integrator
              s.solver.linearize = Linearize::Start;  // what "auto" is for this one
            }),
            0);
}

TEST(FrameKey, RecoveryMattersInDynamicsOnly) {
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.solver.recovery = false; }), 1);
  Shot shot = simple_shot();
  shot.settings.mode = SimulationMode::Static;
  const auto keys = simulation_keys(shot, shot.solver, simple_constraints(), "filled", "materials");
  shot.solver.recovery = false;
  EXPECT_EQ(simulation_keys(shot, shot.solver, simple_constraints(), "filled", "materials"), keys);
}

TEST(FrameKey, KnowsTheRotationsOfTheBodyItself) {
  Shot shot = simple_shot();
  BodySettings body;
  const auto keys = [&] {
    return simulation_keys(shot, solver_of(shot, body), simple_constraints(), "filled", "materials");
  };
  const auto of_the_shot = keys();
  body.rotation = RotationMethod::None;
  const auto of_the_body = keys();
  EXPECT_NE(of_the_body.front(), of_the_shot.front());
  shot.solver.rotation = RotationMethod::Paper;
  EXPECT_EQ(keys(), of_the_body) << "the body has its own";
}

TEST(FrameKey, IndependentFramesKnowNothingOfEachOther) {
  Shot shot = simple_shot();
  shot.settings.mode = SimulationMode::Static;
  shot.settings.independent = true;
  const auto keys = simulation_keys(shot, shot.solver, simple_constraints(), "filled", "materials");
  EXPECT_EQ(keys[10], keys[40]) << "the pin is where it was";
  EXPECT_NE(keys[10], keys[55]);
  shot.settings.independent = false;
  const auto chained = simulation_keys(shot, shot.solver, simple_constraints(), "filled", "materials");
  EXPECT_NE(chained[10], chained[40]) << "the frame starts from the one before";
}

TEST(FrameKey, MaterialsOfRegionsCountWhereverTheirNumbersChange) {
  LoadedBody loaded;
  loaded.surface.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  loaded.surface.triangles = {{0, 1, 2}};
  Shot shot;
  shot.materials["flesh"];
  BodySettings body;
  body.material = "flesh";
  body.regions.resize(1);
  body.regions[0].select.terms = {{SelectSphere{Vec3::Zero(), 0.5}, SelectionUnit::Meter}};
  body.regions[0].stiffness = 4.0;
  const auto key = [&] {
    KeyHasher hasher("materials");
    add_materials(hasher, shot, body, loaded);
    return hasher.key();
  };
  const StageKey before = key();
  shot.materials["flesh"].appearance.roughness = 0.1f;
  EXPECT_EQ(key(), before) << "looks are no physics";
  shot.materials["flesh"].physics.density = 900;
  const StageKey heavier = key();
  EXPECT_NE(heavier, before);
  body.regions[0].stiffness = 5.0;
  const StageKey stiffer = key();
  EXPECT_NE(stiffer, heavier);
  body.regions[0].select.terms = {{SelectSphere{Vec3::Zero(), 0.75}, SelectionUnit::Meter}};
  EXPECT_NE(key(), stiffer) << "the surface points are the same, the elements need not be";
}

TEST(FrameKey, KnowsTheConstraintsAtEveryTimeThatErrorControlMayLookAt) {
  // The pin is off but for a moment between two sub-steps, which only shorter steps can meet.
  EXPECT_EQ(first_changed([](Shot&, BodyConstraints& m) { m.pins[0].active = {{1, 20.2}, {20.3, 60}}; }), 0);
  Shot shot = simple_shot();
  shot.solver.step_error = 1e-3;
  BodyConstraints constraints = simple_constraints();
  const auto before = simulation_keys(shot, shot.solver, constraints, "filled", "materials");
  constraints.pins[0].active = {{1, 20.2}, {20.3, 60}};
  const auto after = simulation_keys(shot, shot.solver, constraints, "filled", "materials");
  EXPECT_EQ(before[19], after[19]);
  EXPECT_NE(before[20], after[20]);
}

TEST(Regions, TakeTetrahedraInsideTheBodyAndRefuseToTakeNone) {
  const TetMesh mesh = testing::kuhn_bar({4, 4, 4}, Vec3::Ones());
  LoadedBody loaded;
  loaded.surface.positions = mesh.nodes;
  loaded.surface.triangles = boundary_faces(mesh);
  Shot shot;
  shot.materials["flesh"].physics.youngs_modulus = 1e5;
  BodySettings body;
  body.material = "flesh";
  body.regions.resize(1);
  body.regions[0].stiffness = 50.0;
  // Its points are all inside: a bone.
  body.regions[0].select.terms = {{SelectSphere{Vec3::Constant(0.5), 0.2}, SelectionUnit::Meter}};
  KeyHasher key("materials");
  EXPECT_NO_THROW(add_materials(key, shot, body, loaded));
  EXPECT_NO_THROW(require_regions(body, loaded, mesh));
  double stiffest = 0;
  for (const ElementMaterial& material : element_materials(shot, body, loaded, mesh))
    stiffest = std::max(stiffest, material.youngs_modulus);
  EXPECT_EQ(stiffest, 50e5);
  // Takes a corner of the surface, and no tetrahedron.
  body.regions[0].select.terms = {{SelectSphere{Vec3::Zero(), 1e-3}, SelectionUnit::Meter}};
  EXPECT_THROW(require_regions(body, loaded, mesh), Error);
}

TEST(FrameKey, PhysicsChangesEveryFrame) {
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.solver.substeps = 3; }), 1);
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.settings.fps = 25; }), 1);
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.solver.integrator = Integrator::Newmark; }), 1);
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.solver.linearize = Linearize::Predictor; }), 1);
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.solver.step_error = 1e-3; }), 1);
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.solver.rest_tolerance = 0; }), 1);
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.solver.matrix_lag = 0; }), 1);
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.solver.keep_hierarchy = false; }), 1);
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.solver.force_tolerance = 1e-5; }), 1) << "of rest";
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.solver.rotation = RotationMethod::Energy; }), 1);
  EXPECT_EQ(first_changed([](Shot& s, BodyConstraints&) { s.gravity.y() = -1.62; }), 1);
  EXPECT_EQ(first_changed([](Shot&, BodyConstraints& m) { m.pins[0].points = {0, 1}; }), 1);
}

/// Moves by a given distance a frame until frame 30.
class Drift : public FollowedMotion {
 public:
  explicit Drift(double pace) : pace_(pace) {}
  std::vector<FollowTie> tie(std::span<const Vec3>, std::span<const Index>) const override { return {}; }
  std::vector<LocalMotion> motions(std::span<const FollowTie>, double frame) const override {
    return {{Mat3::Identity(), Vec3::Zero(), Vec3(0, pace_ * std::min(frame, 30.0), 0)}};
  }
  std::vector<double> pose(double frame) const override { return {motions({}, frame)[0].to.y()}; }
  std::uint64_t content() const override { return 0; }

 private:
  double pace_;
};

TEST(FrameKey, OfAGrabTellsRangesApart) {
  Shot shot = simple_shot();
  BodyConstraints one = simple_constraints();
  one.pins[0].active = {{1, 60}};
  one.pins[0].grab = true;
  BodyConstraints two = simple_constraints();
  two.pins[0].active = {{1, 20}, {20.5, 60}};  // at all whole frames, so without grab the same
  two.pins[0].grab = true;
  const auto keys = [&](const BodyConstraints& constraints) {
    return simulation_keys(shot, shot.solver, constraints, "filled", "materials");
  };
  EXPECT_EQ(keys(one)[19], keys(two)[19]);
  EXPECT_NE(keys(one)[20], keys(two)[20]);
  EXPECT_EQ(first_changed([](Shot&, BodyConstraints& m) { m.pins[0].grab = true; }), 1);
}

TEST(FrameKey, OfWhatIsFollowedIsThatOfItsPose) {
  Shot shot = simple_shot();
  const Drift slow(1), quick(2), none(0);
  const auto keys = [&](const FollowedMotion& motion) {
    BodyConstraints constraints = simple_constraints();
    constraints.pins[0].follow = &motion;
    constraints.pins[0].active = {{10, 60}};
    return simulation_keys(shot, shot.solver, constraints, "filled", "materials");
  };
  EXPECT_EQ(keys(slow)[8], keys(quick)[8]) << "frame 9: not active yet";
  EXPECT_NE(keys(slow)[9], keys(quick)[9]);
  EXPECT_EQ(keys(slow), keys(Drift(1)));
  EXPECT_NE(keys(none).back(), keys(slow).back());
}

}  // namespace
}  // namespace softreel
