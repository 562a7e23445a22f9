/// VTK .vtu files of the tetrahedra, one a sample, with a .pvd file that lists them by time: for ParaView.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tool/export/exporter.h"

namespace softreel {

/// The format. Points are the deformed nodes, in the space and unit asked for; of the points `displacement`, in the
/// same unit; of the elements what tool/export/tet_fields.h finds (in Pa), `material`, a number per kind of it, and
/// `fill` of an embedded mesh.
ExportFormat vtu_format();

/// ParaView's list of a series of files beside it: what it opens, with a time in seconds for each.
std::string pvd_text(std::span<const SeriesEntry> series);

}  // namespace softreel
