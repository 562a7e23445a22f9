/// What an export is asked for on the command line, checked against what the formats can say.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tool/export/exporter.h"

namespace softreel {

/// As typed; empty: not given.
struct ExportWishes {
  std::vector<std::string> formats;  ///< names; one that is named twice counts once
  std::string space, unit, up;
  std::optional<double> fps;
  int subframes = 0;
  bool normals = false;
  std::optional<double> voxel;
};

/// The formats of --format, in the order given; OBJ if none is. Throws input_error for one that is not known.
std::vector<const ExportFormat*> chosen_formats(const ExportWishes& wishes);

/// Throws input_error for a value that is none, and for an option that a format could only ignore, naming both. Where
/// no rate is asked for, the caller sets that of the shot.
ExportSettings export_settings(const ExportWishes& wishes, const std::vector<const ExportFormat*>& formats);

}  // namespace softreel
