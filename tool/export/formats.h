/// The one table of export formats: options, help, errors and the command read it.
#pragma once

#include <string>
#include <vector>

#include "tool/export/exporter.h"

namespace softreel {

/// In the order in which help and errors name them.
const std::vector<ExportFormat>& export_formats();

/// "obj, ply, ..."
std::string export_format_names();

/// Throws input_error naming all formats if there is none of this name.
const ExportFormat& find_export_format(const std::string& name);

}  // namespace softreel
