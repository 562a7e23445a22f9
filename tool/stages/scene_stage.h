/// From a shot and its bodies' surfaces at one frame to the scene that is rendered or previewed.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "render/scene/scene.h"
#include "tool/cache/key.h"
#include "tool/shot/keyed_look.h"
#include "tool/shot/shot.h"
#include "tool/stages/heat_map.h"
#include "tool/stages/material_textures.h"
#include "tool/stages/shot_camera.h"
#include "tool/stages/shot_run.h"

namespace softreel {

/// Builds scenes, and their keys without building them. Keys may be asked for by any thread, scenes by one at a time.
class SceneStage {
 public:
  /// Finds the framing camera from the bodies at rest; reads the bytes of the environment image and of the textures,
  /// but does not decode them before a scene needs it. run is kept by reference. Throws input_error.
  explicit SceneStage(ShotRun& run);

  /// Throws input_error where keys take the camera or a light to where there is no picture, at any frame of the shot.
  void require_looks() const;
  /// Decodes the environment image and the textures that are not decoded yet. Throws input_error.
  void load_images();
  /// The scene of a frame; loads the images first. Keys of lights and materials are at their values.
  Scene at(int frame, const std::vector<SkinnedBody>& bodies);

  /// Key of the picture of a frame, of what the shot says and what the surfaces depend on: known before they are.
  StageKey trace_key(int frame) const;
  /// The same for a preview, which knows no samples, bounces and motion blur.
  StageKey preview_key(int frame) const;
  /// Key of the picture of a scene: everything its pixels depend on, and nothing that led to it. Frames that look the
  /// same have the same one.
  StageKey content_key(int frame, const Scene& scene) const;

  /// The range of the shot's heat: the given one, or what find_heat_range finds, which the first call may have to
  /// simulate the whole shot for. Any thread may ask once a scene was made; before, only the one that makes them.
  HeatRange heat_range() const;
  /// Draws the legend of the shot's heat on a picture, if the shot shows any. Warns once if it has no room for letters.
  /// Any thread.
  void draw_legend(DisplayImage& image) const;
  /// Of the picture of a frame.
  Camera camera(double frame) const;
  /// Of the pictures that scenes load, textures and surroundings, by their headers. Throws input_error.
  double count_texels() const;

 private:
  bool shows_heat() const { return run_.shot().render.heat.quantity != HeatQuantity::None; }
  /// All of a scene but the surfaces and the picture of the surroundings.
  struct Look {
    Camera camera;
    std::vector<Camera> camera_motion;
    FrameLights lights;
    Environment environment;
    std::optional<Daylight> day;
    std::vector<Appearance> appearances;  ///< per body
  };
  Look look(int frame) const;
  Appearance appearance(std::size_t body, int frame) const;
  void add_coloring(KeyHasher& key) const;
  void add_look(KeyHasher& key, const Look& look) const;
  void add_tracing(KeyHasher& key, const std::vector<Camera>& camera_motion) const;
  std::vector<Camera> camera_motion(int frame) const;
  Camera next_camera(int frame) const;
  void start_scenes();
  void warn_far_from_origin() const;

  ShotRun& run_;
  MaterialTextures textures_;
  mutable std::mutex range_mutex_;
  mutable std::optional<HeatRange> found_range_;
  mutable std::once_flag small_legend_;  ///< whether it was warned of
  std::shared_ptr<const EnvironmentImage> environment_image_;
  std::optional<Daylight> drawn_day_;  ///< the sky of environment_image_, where the shot has one
  StageKey environment_checksum_;      ///< of the image file; empty without one
  Bounds rest_bounds_;
  std::vector<std::shared_ptr<const std::vector<Vec3f>>> rest_positions_;  ///< per body
  StageKey coloring_key_;                                                  ///< empty where every body has one look
};

/// What a request for skinned surfaces must hold for the shot's motion blur.
SkinRequest skin_request(const RenderSettings& settings);
/// The same for one moment, as a preview draws it.
SkinRequest still_request(const RenderSettings& settings);

}  // namespace softreel
