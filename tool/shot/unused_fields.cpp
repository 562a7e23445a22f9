#include "tool/shot/unused_fields.h"

#include <fmt/format.h>

namespace softreel {
namespace {

class UnusedFields {
 public:
  explicit UnusedFields(const Shot& shot) : shot_(shot) {}

  std::vector<std::string> find() {
    of_simulation();
    of_camera();
    of_surroundings();
    of_pictures();
    for (const auto& [name, material] : shot_.materials) of_textures(name, material.textures);
    return std::move(lines_);
  }

 private:
  void note(bool differs, const std::string& field, const char* reason) {
    if (differs) lines_.push_back(fmt::format("{}: {} has no effect: {}.", shot_.path, field, reason));
  }

  void of_simulation() {
    const ShotSettings& settings = shot_.settings;
    const SolverParams& solver = shot_.solver;
    if (settings.mode == SimulationMode::Static) {
      const char* reason = "a static shot is in balance at every frame (shot.mode = \"static\")";
      note(settings.start != StartState::Rest, "shot.start", reason);
      note(solver.step_error > 0, "solver.step_error", reason);
      note(settings.preroll > 0 && settings.independent, "shot.preroll", "no frame knows another (shot.independent)");
      return;
    }
    note(settings.independent, "shot.independent", "it is of static shots, and shot.mode = \"dynamic\"");
    if (solver.integrator == Integrator::Newmark) return;
    const char* reason = "it is of solver.integrator = \"newmark\"";
    note(solver.newmark.beta != NewmarkParams().beta, "solver.newmark_beta", reason);
    note(solver.newmark.gamma != NewmarkParams().gamma, "solver.newmark_gamma", reason);
  }

  void of_camera() {
    const CameraSettings& camera = shot_.camera;
    const CameraSettings plain;
    note(camera.f_number == 0 && !camera.focus_distance.keys.empty(), "camera.focus_distance",
         "everything is sharp (camera.f_number = 0)");
    if (camera.mode == CameraMode::Place) {
      const char* reason = "it frames the bodies, and the camera is placed (camera.position)";
      note(camera.azimuth_deg != plain.azimuth_deg, "camera.azimuth_deg", reason);
      note(camera.elevation_deg != plain.elevation_deg, "camera.elevation_deg", reason);
      note(camera.margin != plain.margin, "camera.margin", reason);
      note(camera.shift != plain.shift, "camera.shift", reason);
      return;
    }
    const char* reason = "camera.mode = \"frame\" finds its own place";
    note(!camera.position.keys.empty(), "camera.position", reason);
    note(!camera.target.keys.empty(), "camera.target", reason);
  }

  void of_surroundings() {
    const Environment &environment = shot_.environment, plain;
    const bool has_image = !shot_.environment_image.empty();
    if (shot_.sky || has_image) {
      const char* reason = shot_.sky ? "environment.sky is there instead" : "environment.image is there instead";
      note(shot_.sky && has_image, "environment.image", reason);
      note(environment.zenith != plain.zenith, "environment.zenith", reason);
      note(environment.horizon != plain.horizon, "environment.horizon", reason);
      note(environment.nadir != plain.nadir, "environment.nadir", reason);
    }
    if (!shot_.ground) return;
    const Ground &ground = *shot_.ground, flat;
    note(ground.style == GroundStyle::Plane && ground.sweep != flat.sweep, "ground.sweep",
         "it is of ground.style = \"sweep\"");
    note(ground.checker == 0 && ground.checker_color != flat.checker_color, "ground.checker_color",
         "there is no pattern (ground.checker = 0)");
  }

  void of_pictures() {
    note(shot_.render.heat.quantity == HeatQuantity::None && shot_.render.heat.range, "render.heat_range",
         "no quantity is shown (render.heat)");
    note(shot_.render.params.channels.bits != 0 && !shot_.output.exr, "render.channels",
         "they are of EXR files (output.exr = false)");
  }

  void of_textures(const std::string& name, const TextureSettings& textures) {
    const TextureSettings plain;
    const std::string field = "material." + name + ".";
    const char* reason = "the material has no such texture";
    if (!textures.any()) {
      note(textures.scale != plain.scale, field + "texture_scale", reason);
      note(textures.offset != plain.offset, field + "texture_offset", reason);
      note(textures.wrap != plain.wrap, field + "texture_wrap", reason);
    }
    note(textures.normal.empty() && textures.normal_strength != plain.normal_strength, field + "normal_strength",
         reason);
    note(textures.bump.empty() && textures.bump_height != plain.bump_height, field + "bump_height", reason);
  }

  const Shot& shot_;
  std::vector<std::string> lines_;
};

}  // namespace

std::vector<std::string> find_unused_fields(const Shot& shot) {
  return UnusedFields(shot).find();
}

}  // namespace softreel
