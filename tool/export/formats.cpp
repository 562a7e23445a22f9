#include "tool/export/formats.h"

#include <algorithm>

#include <fmt/ranges.h>

#include "core/base/error.h"
#include "core/base/nearest_name.h"
#include "tool/export/glb_export.h"
#include "tool/export/mdd_export.h"
#include "tool/export/obj_export.h"
#include "tool/export/pc2_export.h"
#include "tool/export/ply_export.h"
#include "tool/export/usda_export.h"
#include "tool/export/vdb_export.h"
#include "tool/export/vtu_export.h"

namespace softreel {

const std::vector<ExportFormat>& export_formats() {
  static const std::vector<ExportFormat> formats{obj_format(), ply_format(),  pc2_format(), mdd_format(),
                                                 glb_format(), usda_format(), vtu_format(), vdb_format()};
  return formats;
}

std::string export_format_names() {
  std::vector<std::string> names;
  for (const ExportFormat& format : export_formats()) names.push_back(format.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

const ExportFormat& find_export_format(const std::string& name) {
  std::vector<std::string> names;
  for (const ExportFormat& format : export_formats()) {
    if (format.name == name) return format;
    names.push_back(format.name);
  }
  const std::string nearest = nearest_name(name, names);
  throw input_error(fmt::format("--format: \"{}\" is not known.\n  {}Accepted: {}.", name,
                                nearest.empty() ? "" : fmt::format("Did you mean {}? ", nearest),
                                export_format_names()));
}

}  // namespace softreel
