/// One shot on its way through the stages: bodies loaded at once, filled and simulated when a frame asks for it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tool/bodies/body_stage.h"
#include "tool/bodies/dial_stage.h"
#include "tool/bodies/glue_stage.h"
#include "tool/bodies/run_context.h"
#include "tool/bodies/simulate_stage.h"
#include "tool/cache/cache_use.h"
#include "tool/shot/shot.h"

namespace softreel {

struct HeatSource;

/// The surface of a body at the times of the shutter; one time where there is no motion blur.
struct SkinnedBody {
  struct Time {
    std::vector<Vec3> positions;  ///< as surface.positions, m
    std::vector<Vec3> normals;    ///< per vertex, or as FilledBody::creases has them; empty if not asked for
    std::vector<Vec3> nodes;      ///< of the tetrahedra, m; empty if not asked for
  };
  std::vector<Time> times;           ///< times.back() is the frame itself
  std::vector<Vec3> next_positions;  ///< at the next frame, if asked for
  std::vector<double> heat;          ///< per vertex, the quantity asked for, at the frame itself
  std::vector<double> strain;        ///< per vertex, at the frame itself, if asked for
  std::vector<Grab> pull_grabs;      ///< what pulls hold at the frame, per pull; empty where nothing grabs
};

/// What is wanted of each frame.
struct SkinRequest {
  bool normals = true;
  double shutter = 0;  ///< share of a frame, ending at the frame
  int segments = 1;    ///< straight pieces while the shutter is open
  /// The next frame too; of the shot's last one, where it would be if it went on as from the frame before, or stays if
  /// there is none.
  bool next = false;
  HeatQuantity heat = HeatQuantity::None;
  bool strain = false;
  bool nodes = false;    ///< of the tetrahedra
  bool creases = false;  ///< normals with the hard edges of bodies that have them; else all are smooth
};

/// Takes a body's surface at one time of the shutter.
using TakeSkin = std::function<void(SkinnedBody::Time)>;

/// What becomes of an error dial that was not turned yet.
enum class DialUse {
  Turn,   ///< pilots run
  LookUp  ///< nothing is run: keys are those of default sizes, for commands that only look
};

/// Reading keys and loaded bodies is thread-safe; all else belongs to one thread at a time.
class ShotRun {
 public:
  /// Loads the bodies, resolves their selections, turns the error dial if there is one, and finds all keys; nothing
  /// else is filled or simulated yet. shot and context are kept by reference.
  ShotRun(const Shot& shot, const RunContext& context, DialUse dial = DialUse::Turn);
  ~ShotRun();

  const Shot& shot() const { return shot_; }
  const RunContext& context() const { return context_; }
  std::size_t body_count() const { return bodies_.size(); }
  /// The shot as the body is simulated: with what the error dial chose for it.
  const Shot& resolved(std::size_t body) const;
  const BodySettings& settings(std::size_t body) const { return resolved(body).bodies[body]; }
  /// What the error dial chose; none where it is off or was not turned.
  const std::optional<BodyDial>& dial(std::size_t body) const;
  /// Empty where it is off.
  const StageKey& dial_key(std::size_t body) const;
  const LoadedBody& loaded(std::size_t body) const;
  const BodySimulation& simulation(std::size_t body) const;
  /// The tetrahedra of a body; null if no frame asked for them.
  const FilledBody* filled(std::size_t body) const;

  /// Everything that the bodies' surfaces at a frame depend on.
  StageKey surfaces_key(int frame, const SkinRequest& request) const;
  /// What the cache keeps for the bodies at these frames, tetrahedra included.
  std::vector<CacheItem> items(int first, int last) const;

  /// Computes the frame of all bodies, or reads it.
  void simulate(int frame);
  /// The bodies' surfaces at a frame.
  std::vector<SkinnedBody> skin(int frame, const SkinRequest& request);
  SkinnedBody skin_body(std::size_t body, int frame, const SkinRequest& request);
  /// The times of skin_body in order, each as soon as it is there, so that only one need be held. `take` may not ask
  /// for frames.
  void skin_times(std::size_t body, int frame, const SkinRequest& request, const TakeSkin& take);
  /// A quantity at the vertices of a body's surface at a frame.
  std::vector<double> heat(std::size_t body, int frame, HeatQuantity quantity);
  /// The same in the elements of a body.
  std::vector<double> element_heat(std::size_t body, int frame, HeatQuantity quantity);
  /// Everything that this quantity depends on, at the frames of the whole shot.
  StageKey all_frames_key() const;
  /// Summed over the bodies; of frames up to `last`.
  SimulationCounts counts(int last) const;

 private:
  struct Body;
  void resolve(std::size_t index, BodyConstraints constraints, DialUse use);
  void join_glued();
  /// Simulates and fills the body if it is not yet.
  HeatSource heat_source(Body& body, std::size_t index, int frame);

  std::vector<Vec3> previous_nodes(Body& body, int frame, const SkinRequest& request) const;
  void skin_times(Body& body, int frame, const SkinRequest& request, const std::vector<Vec3>& previous,
                  const TakeSkin& take) const;
  std::vector<Vec3> next_positions(Body& body, int frame, const std::vector<Vec3>& positions,
                                   const std::vector<Vec3>& previous_nodes);

  const Shot& shot_;
  const RunContext& context_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<std::unique_ptr<GlueGroup>> groups_;  ///< of bodies that glue joins
};

/// Node positions at a time in [-1, 0] frames before a frame, on the straight lines between sub-steps. `steps`: node
/// positions at equally spaced times from the previous frame to this one, at least one.
std::vector<Vec3> positions_between(const std::vector<const std::vector<Vec3>*>& steps, double time);

}  // namespace softreel
