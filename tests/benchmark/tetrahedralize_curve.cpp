/// How far tetrahedra are from their surface, and what they cost, over sizes and ways to choose them.
///
/// tetrahedralize_curve [MESH...]: prints TSV, one line a mesh. Default: the creature of the first picture.
#include <ctime>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/mesh/mesh_repair.h"
#include "core/mesh/readers/mesh_import.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "tests/support/peak_memory.h"

namespace softreel {
namespace {

double cpu_seconds() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void measure(const std::string& path, const SurfaceMesh& surface, const char* mode,
             const TetrahedralizeParams& params) {
  const Threads threads;
  const Log silent{[](const std::string&) {}, [](const std::string&) {}};
  StageTimes times;
  test::reset_peak_memory();
  const std::int64_t memory = test::peak_memory();
  const double start = cpu_seconds();
  TetMesh mesh;
  try {
    mesh = tetrahedralize(surface, params, path, threads, silent, times);
  } catch (const Error& error) {
    fmt::print("{}\t{}\t{}\n", path, mode, error.what());
    return;
  }
  const double seconds = cpu_seconds() - start;
  const auto count = static_cast<double>(mesh.tets.size());
  const double bytes = static_cast<double>(test::peak_memory() - memory) / count;
  const TetQuality quality = measure_quality(mesh, threads);
  const double share = measure_deviation(surface, mesh, threads).two_way() / used_bounds(surface).diagonal();
  fmt::print("{}\t{}\t{}\t{:.3f}\t{:.0f}\t{:.4f}\t{:.2f}\t{:.2f}\t{:.2f}\n", path, mode, mesh.tets.size(), seconds,
             bytes, 100 * share, quality.min_dihedral, quality.first_percentile_dihedral, quality.max_dihedral);
  std::fflush(stdout);
}

void measure_all(const std::string& path) {
  const Log silent{[](const std::string&) {}, [](const std::string&) {}};
  SurfaceMesh surface = import_mesh(path, silent);
  repair_mesh(surface);
  const double diagonal = used_bounds(surface).diagonal();
  for (const std::int64_t tets : {10000, 20000, 70000, 200000, 500000, 1000000})
    measure(path, surface, "uniform", {.tets = tets});
  for (const std::int64_t tets : {10000, 20000, 70000, 200000, 500000})
    measure(path, surface, "graded", {.tets = tets, .graded = true});
  for (const double percent : {1.0, 0.5, 0.3, 0.2, 0.12})
    measure(path, surface, fmt::format("error {} %", percent).c_str(), {.error = percent / 100 * diagonal});
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  fmt::print("mesh\tmode\ttets\tcpu_s\tpeak_bytes_a_tet\tdistance_percent\tmin_deg\tfirst_percentile_deg\tmax_deg\n");
  try {
    if (argc < 2) softreel::measure_all(SOFTREEL_SOURCE_DIR "/assets/creature.ply");
    for (int i = 1; i < argc; ++i) softreel::measure_all(argv[i]);
  } catch (const softreel::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
