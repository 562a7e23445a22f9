/// Numbers as float32 files hold them: the nearest one of each double, or an error that says whose it would be.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/types.h"
#include "tool/export/exporter.h"

namespace softreel {

/// Appends x, y, z of each vector. Throws work_error if one is not finite in float32, naming `where` and the vertex:
/// readers of such files show such frames as garbage without a word.
void append_floats(const std::string& where, std::span<const Vec3> values, std::vector<float>& floats);

/// Throws work_error if a texture coordinate of the mesh is no finite number of at most `most`, naming `where` and it.
void require_texture_coordinates(const std::string& where, const SurfaceMesh& mesh, double most);

/// When a sample is shown, as float32 files say it.
float seconds_of(const SampleTimes& times, int sample, double fps);
/// Throws input_error unless these are finite and grow from sample to sample.
void require_float_times(const char* format, const SampleTimes& times, double fps);

}  // namespace softreel
