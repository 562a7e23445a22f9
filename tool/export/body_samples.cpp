#include "tool/export/body_samples.h"

#include "tool/shot/keyed_look.h"
#include "tool/stages/scene_stage.h"

namespace softreel {
namespace {

/// first, then second.
Placement composed(const Placement& first, const Placement& second) {
  return {second.linear * first.linear, second.linear * first.offset + second.offset};
}

Placement inverted(const Placement& placement) {
  const Mat3 inverse = placement.linear.inverse();
  return {inverse, -(inverse * placement.offset)};
}

/// Of entries 0 and 1 only, so that it adds no round-off.
Mat3 turned_to(UpAxis up) {
  Mat3 turn = Mat3::Identity();
  if (up == UpAxis::Z) turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return turn;
}

}  // namespace

Placement world_placement(const ExportSettings& settings) {
  return {turned_to(settings.up) / settings.meters_per_unit, Vec3::Zero()};
}

ExportBody export_body(const ExportSettings& settings, const ShotRun& run, std::size_t body, double frame) {
  const LoadedBody& loaded = run.loaded(body);
  ExportBody result;
  result.name = run.settings(body).name;
  result.mesh = &loaded.file_mesh;
  result.material = run.settings(body).material;
  const MaterialSettings& material = run.shot().materials.at(result.material);
  result.appearance = appearance_at(material, frame);
  result.textures = material.textures;
  const Placement world = world_placement(settings);
  const bool in_object_space = settings.space == ExportSpace::Object;
  if (in_object_space)
    result.transform = composed(loaded.placement, world);
  else
    result.file_to_space = composed(loaded.placement, world);
  result.scene_to_space = in_object_space ? inverted(loaded.placement) : world;
  return result;
}

std::function<Camera(double frame)> export_camera(const ShotRun& run) {
  Bounds rest;
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    const Bounds bounds = used_bounds(run.loaded(b).surface);
    rest.add(bounds.min);
    rest.add(bounds.max);
  }
  return [&run, rest](double frame) {
    const RenderParams& params = run.shot().render.params;
    return camera_at(run.shot().camera, frame, rest, static_cast<double>(params.width) / params.height);
  };
}

std::vector<Vec3> export_positions(const ExportSettings& settings, const LoadedBody& loaded,
                                   const std::vector<Vec3>& deformed) {
  std::vector<Vec3> positions(deformed.size());
  const Placement world = world_placement(settings);
  for (std::size_t v = 0; v < deformed.size(); ++v)
    positions[v] = settings.space == ExportSpace::World ? world(deformed[v])
                                                        : undo(loaded.placement, loaded.file_mesh.positions[v],
                                                               loaded.surface.positions[v], deformed[v]);
  return positions;
}

std::vector<Vec3> export_normals(const ExportSettings& settings, const LoadedBody& loaded,
                                 const std::vector<Vec3>& normals) {
  // The placement is a rotation times a scale: its transpose turns back.
  const Mat3 turn =
      settings.space == ExportSpace::World ? turned_to(settings.up) : Mat3(loaded.placement.linear.transpose());
  std::vector<Vec3> turned(normals.size());
  for (std::size_t v = 0; v < normals.size(); ++v) turned[v] = (turn * normals[v]).normalized();
  return turned;
}

}  // namespace softreel
