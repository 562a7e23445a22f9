#include "tool/export/vtu_export.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/tetmesh/files/vtu_file.h"
#include "tool/export/tet_fields.h"

namespace softreel {
namespace {

class VtuWriter : public ExportWriter {
 public:
  explicit VtuWriter(ExportTarget target) : target_(std::move(target)) {}

  void append(const ExportSample& sample) override {
    CHECK(sample.tets != nullptr);
    const TetSample& tets = *sample.tets;
    const TetMesh& mesh = tets.filled.mesh;
    const Placement& to_space = target_.bodies[sample.body].scene_to_space;
    const std::vector<Vec3> rest = moved(mesh.nodes, to_space), deformed = moved(tets.nodes, to_space);
    const TetFields fields =
        find_tet_fields({rest, deformed, mesh.tets, tets.materials, tets.dilatation}, *target_.threads);
    std::vector<VtuArray> cells{vtu_array("strain", 1, fields.strain),
                                vtu_array("von_mises_stress", 1, fields.von_mises_stress),
                                vtu_array("green_strain", 6, fields.green_strain),
                                vtu_array("cauchy_stress", 6, fields.cauchy_stress),
                                vtu_array("cauchy_von_mises", 1, fields.cauchy_von_mises),
                                vtu_array("material", 1, number_materials(tets.materials))};
    if (!mesh.fill.empty()) cells.push_back(vtu_array("fill", 1, mesh.fill));
    target_.sink(encode_vtu(deformed, mesh.tets, {displacement(rest, deformed)}, cells));
  }
  void finish() override {}

 private:
  static std::vector<Vec3> moved(const std::vector<Vec3>& nodes, const Placement& placement) {
    std::vector<Vec3> result(nodes.size());
    std::transform(nodes.begin(), nodes.end(), result.begin(), placement);
    return result;
  }

  static VtuArray displacement(const std::vector<Vec3>& rest, const std::vector<Vec3>& deformed) {
    std::vector<double> values;
    values.reserve(3 * rest.size());
    for (std::size_t i = 0; i < rest.size(); ++i)
      for (int k = 0; k < 3; ++k) values.push_back(deformed[i][k] - rest[i][k]);
    return vtu_array("displacement", 3, values);
  }

  ExportTarget target_;
};

/// As a value of an attribute in XML.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return result;
}

}  // namespace

std::string pvd_text(std::span<const SeriesEntry> series) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const SeriesEntry& entry : series)
    text += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", entry.seconds, escaped(entry.name));
  return text + "</Collection>\n</VTKFile>\n";
}

ExportFormat vtu_format() {
  ExportFormat format;
  format.name = "vtu";
  format.about = "VTK tetrahedra with displacement, strain and stress, a file a sample, and a .pvd that ParaView opens";
  format.file_per = FilePer::Sample;
  format.needs_tets = true;
  format.has_seconds = true;
  format.make = [](ExportTarget target) { return std::make_unique<VtuWriter>(std::move(target)); };
  format.index_extension = "pvd";
  format.make_index = pvd_text;
  return format;
}

}  // namespace softreel
