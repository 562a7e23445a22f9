/// A body's surface on its way out: from skinned positions (scene, m) to the space, unit and axes of an export.
#pragma once

#include <functional>
#include <vector>

#include "tool/export/exporter.h"
#include "tool/stages/shot_run.h"

namespace softreel {

/// From the scene to the export's world: its unit and axes.
Placement world_placement(const ExportSettings& settings);

/// body: of the run; frame: of the first sample, at which keyed looks are taken.
ExportBody export_body(const ExportSettings& settings, const ShotRun& run, std::size_t body, double frame);

/// The shot's camera by frame, in the scene. run is kept by reference.
std::function<Camera(double frame)> export_camera(const ShotRun& run);

/// deformed: of the file's vertices, in the scene, m. In object space exactly the file's numbers, bit for bit, where
/// nothing has moved.
std::vector<Vec3> export_positions(const ExportSettings& settings, const LoadedBody& loaded,
                                   const std::vector<Vec3>& deformed);

/// normals: unit length, in the scene; the result too, in the space asked for.
std::vector<Vec3> export_normals(const ExportSettings& settings, const LoadedBody& loaded,
                                 const std::vector<Vec3>& normals);

}  // namespace softreel
