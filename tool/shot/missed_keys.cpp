#include "tool/shot/missed_keys.h"

#include <algorithm>

#include <fmt/format.h>

namespace softreel {
namespace {

class MissedKeys {
 public:
  explicit MissedKeys(const Shot& shot) : shot_(shot), first_(shot.settings.first_frame - shot.settings.preroll) {}

  std::vector<std::string> find() {
    for (const BodySettings& body : shot_.bodies) of_body(body);
    for (std::size_t g = 0; g < shot_.glues.size(); ++g)
      look(fmt::format("glue[{}].stiffness", g), shot_.glues[g].stiffness);
    first_ = shot_.settings.first_frame;  // from here on what is seen, not what is simulated
    for (const auto& [name, material] : shot_.materials) of_material(name, material);
    of_camera();
    for (std::size_t k = 0; k < shot_.lights.size(); ++k) of_light(fmt::format("light[{}]", k), shot_.lights[k]);
    of_environment();
    return std::move(lines_);
  }

 private:
  template <typename T>
  void look(const std::string& field, const Track<T>& track) {
    const auto& keys = track.keys;
    const auto moves = [](const Key<T>& a, const Key<T>& b) { return a.value != b.value; };
    if (std::adjacent_find(keys.begin(), keys.end(), moves) == keys.end()) return;
    if (keys.back().frame >= first_) return;
    lines_.push_back(fmt::format("{}: {} stands still: its keys, frames {:g} to {:g}, lie before the shot's, {} to {}.",
                                 shot_.path, field, keys.front().frame, keys.back().frame, first_,
                                 shot_.settings.last_frame));
  }

  template <typename Constraint>
  void of_constraint(const std::string& field, const Constraint& constraint) {
    if (!constraint.follow) look(field + ".keys", constraint.keys);
  }

  void of_body(const BodySettings& body) {
    for (std::size_t k = 0; k < body.pins.size(); ++k)
      of_constraint(fmt::format("body.{}.pin[{}]", body.name, k), body.pins[k]);
    for (std::size_t k = 0; k < body.pulls.size(); ++k) {
      const std::string field = fmt::format("body.{}.pull[{}]", body.name, k);
      of_constraint(field, body.pulls[k]);
      look(field + ".stiffness", body.pulls[k].stiffness);
    }
  }

  void of_material(const std::string& name, const MaterialSettings& material) {
    for (const AppearanceTrack& track : material.tracks) {
      const std::string field = fmt::format("material.{}.{}", name, track.field);
      look(field, track.numbers);
      look(field, track.colors);
    }
  }

  void of_camera() {
    const CameraSettings& camera = shot_.camera;
    look("camera.position", camera.position);
    look("camera.target", camera.target);
    look("camera.focal_length_mm", camera.focal_length_mm);
    look("camera.focus_distance", camera.focus_distance);
  }

  void of_light(const std::string& field, const LightSettings& light) {
    look(field + ".center", light.center);
    look(field + ".aim", light.aim);
    look(field + ".power", light.power);
    look(field + ".direction", light.direction);
    look(field + ".irradiance", light.irradiance);
    look(field + ".color", light.color);
  }

  void of_environment() {
    look("environment.strength", shot_.environment_strength);
    look("environment.rotation_deg", shot_.environment_rotation_deg);
    if (!shot_.sky) return;
    look("environment.sky.turbidity", shot_.sky->turbidity);
    look("environment.sky.elevation_deg", shot_.sky->elevation_deg);
    look("environment.sky.azimuth_deg", shot_.sky->azimuth_deg);
  }

  const Shot& shot_;
  int first_;
  std::vector<std::string> lines_;
};

}  // namespace

std::vector<std::string> find_missed_keys(const Shot& shot) {
  return MissedKeys(shot).find();
}

}  // namespace softreel
