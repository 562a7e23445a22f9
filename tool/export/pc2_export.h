/// PC2 point caches: the positions of every frame in one file, as Blender, Houdini and 3ds Max read them.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/types.h"
#include "tool/export/exporter.h"

namespace softreel {

struct Pc2Params {
  Index points = 0;         ///< vertices of the mesh file, used by faces or not
  Index samples = 0;        ///< frames that will be appended
  double start_frame = 1;   ///< frame of the first sample
  double frames_apart = 1;  ///< frames from one sample to the next
};

/// Writes a cache frame after frame; holds one frame at most.
///
/// The bytes are "POINTCACHE2" and 0, then int32 1, int32 points, float32 start frame, float32 sample rate, int32
/// samples, then float32 x, y, z of every point of every sample, all little-endian. A float32 is the nearest one of the
/// double.
class Pc2Writer {
 public:
  /// Writes the header at once. Throws input_error if there is nothing to write: no point or no sample.
  Pc2Writer(const Pc2Params& params, ExportSink sink);

  /// positions: one per point, in the file's unit. Throws work_error if a coordinate is not finite in float32, naming
  /// the point: readers of point caches show such frames as garbage without a word.
  void append(std::span<const Vec3> positions);

  /// Throws work_error unless as many samples were appended as the header announces.
  void finish() const;

 private:
  Pc2Params params_;
  ExportSink sink_;
  Index written_ = 0;
  std::vector<float> sample_;
};

ExportFormat pc2_format();

}  // namespace softreel
