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
    return std::move(lines_);
  }

 private:
  void note(bool differs, const char* field, const char* reason) {
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

  const Shot& shot_;
  std::vector<std::string> lines_;
};

}  // namespace

std::vector<std::string> find_unused_fields(const Shot& shot) {
  return UnusedFields(shot).find();
}

}  // namespace softreel
