/// Times softreel's linear solver beside others on the same systems (targets, section 4).
///
/// solver_rivals [--tets N] [--threads N] prints tab-separated values: the bar of about that many tetrahedra (default
/// 11000), one implicit Euler step and the static tangent at the same state. setup_ms: taking new values on a known
/// pattern; solve_ms: to a relative residual of 1e-6; ratio_to_softreel: of both together. Medians of repeats in this
/// one run: processor time on one thread, wall time on several. Only softreel and CHOLMOD's BLAS use more than one
/// thread. Every answer is checked; exit status 1 if one is wrong.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/multigrid/multigrid.h"
#include "tests/benchmark/bar_problem.h"
#include "tests/benchmark/rivals/rival.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using benchmark_support::LinearSystem;
using benchmark_support::SystemKind;
using rivals::Rival;
using rivals::ScalarSystem;

constexpr double kTolerance = 1e-6;

/// Work is repeated until it has taken about this long, s, within the bounds below; what takes kTooLong is timed once.
constexpr double kLongEnough = 2, kTooLong = 5;
constexpr int kLeastRepeats = 3, kMostRepeats = 21;

struct Measured {
  double setup_ms = 0, solve_ms = 0;
  int iterations = 0;
  double residual = 0;
  std::vector<Vec3> x;
};

double norm(const std::vector<Vec3>& vectors) {
  double square = 0;
  for (const Vec3& v : vectors) square += v.squaredNorm();
  return std::sqrt(square);
}

double time_ms(const Threads& threads, const std::function<void()>& work) {
  const double first = benchmark_support::median_seconds(threads, 1, work);
  if (first > kTooLong) return 1e3 * first;
  const int repeats = static_cast<int>(std::clamp<double>(kLongEnough / first, kLeastRepeats, kMostRepeats));
  return 1e3 * benchmark_support::median_seconds(threads, repeats, work);
}

Measured measure_softreel(Multigrid& multigrid, const LinearSystem& system, const Threads& threads) {
  Measured measured;
  SolveReport report;
  measured.setup_ms = time_ms(threads, [&] { multigrid.update(system.matrix, system.pinned); });
  measured.solve_ms = time_ms(threads, [&] {
    measured.x.assign(system.load.size(), Vec3::Zero());
    report = multigrid.solve(system.matrix, system.load, measured.x, kTolerance, 0, 400);
  });
  measured.iterations = report.iterations;
  measured.residual = test_support::relative_residual(system.matrix, system.load, measured.x);
  return measured;
}

Measured measure(Rival& rival, const ScalarSystem& scalar, const LinearSystem& system, const Threads& threads) {
  Measured measured;
  Eigen::VectorXd x;
  measured.setup_ms = time_ms(threads, [&] { rival.update(); });
  measured.solve_ms = time_ms(threads, [&] { measured.iterations = rival.solve(kTolerance, x); });
  measured.x.assign(system.load.size(), Vec3::Zero());
  for (std::size_t i = 0; i < scalar.mesh_nodes.size(); ++i)
    measured.x[static_cast<std::size_t>(scalar.mesh_nodes[i])] = x.segment<3>(3 * static_cast<Index>(i));
  measured.residual = test_support::relative_residual(system.matrix, system.load, measured.x);
  return measured;
}

/// Least eigenvalue of the matrix, from above, by inverse iteration: an error in x is at most |b - A x| over it.
double least_eigenvalue(Multigrid& multigrid, const LinearSystem& system) {
  std::vector<Vec3> y = system.load, x(y.size());
  double eigenvalue = 0;
  for (int i = 0; i < 8; ++i) {
    const double scale = 1 / norm(y);
    for (Vec3& v : y) v *= scale;
    std::fill(x.begin(), x.end(), Vec3::Zero());
    if (!multigrid.solve(system.matrix, y, x, 1e-4, 0, 400).ok()) throw std::runtime_error("softreel did not converge");
    eigenvalue = 1 / norm(x);
    std::swap(x, y);
  }
  return eigenvalue;
}

/// Throws unless x solves the system and is as near to softreel's answer as the two residuals allow. The residual is
/// taken with softreel's own matrix, so that a mistake in what a rival was given shows.
void check_answer(const std::string& name, const Measured& measured, const Measured& softreel,
                  const LinearSystem& system, double eigenvalue) {
  if (!(measured.residual <= 1.1 * kTolerance))
    throw std::runtime_error(
        fmt::format("{}: relative residual {:.3g}, wanted {}", name, measured.residual, kTolerance));
  double square = 0;
  for (std::size_t i = 0; i < measured.x.size(); ++i) square += (measured.x[i] - softreel.x[i]).squaredNorm();
  // The eigenvalue is a little too high, so the bound a little too low.
  const double allowed = 1.5 * (measured.residual + softreel.residual) * norm(system.load) / eigenvalue;
  if (!(std::sqrt(square) <= allowed))
    throw std::runtime_error(fmt::format("{}: differs from softreel's answer by {:.3g} m, at most {:.3g} m allowed",
                                         name, std::sqrt(square), allowed));
}

void print_row(const std::string& problem, const std::string& name, std::size_t tets, int threads,
               const Measured& measured, const Measured& softreel) {
  const double total = measured.setup_ms + measured.solve_ms, reference = softreel.setup_ms + softreel.solve_ms;
  fmt::print("{}\t{}\t{}\t{}\t{:.2f}\t{:.2f}\t{}\t{:.2e}\t{:.2f}\n", problem, name, tets, threads, measured.setup_ms,
             measured.solve_ms, measured.iterations, measured.residual, total / reference);
  std::fflush(stdout);
}

void run_problem(const TetMesh& mesh, const std::vector<Vec3>& positions, SystemKind kind, const Threads& threads) {
  const std::vector<ElementMaterial> materials(mesh.tets.size(), benchmark_support::kBarMaterial);
  const LinearSystem system = make_system(mesh, materials, positions, kind, threads);
  Multigrid multigrid(mesh, {}, system.matrix.pattern, {}, threads);
  const std::string problem = name_of(kind);
  const Measured softreel = measure_softreel(multigrid, system, threads);
  const double eigenvalue = least_eigenvalue(multigrid, system);
  check_answer("softreel", softreel, softreel, system, eigenvalue);
  print_row(problem, "softreel", mesh.tets.size(), threads.count(), softreel, softreel);
  const ScalarSystem scalar = rivals::make_scalar_system(system, mesh.nodes);
  const auto compare = [&](std::unique_ptr<Rival> rival, int rival_threads) {
    if (!rival) return;
    const Measured measured = measure(*rival, scalar, system, threads);
    check_answer(rival->name(), measured, softreel, system, eigenvalue);
    print_row(problem, rival->name(), mesh.tets.size(), rival_threads, measured, softreel);
  };
  compare(rivals::make_eigen_ldlt(scalar), 1);
  compare(rivals::make_cholmod(scalar, threads.count()), threads.count());
  compare(rivals::make_eigen_cg_diagonal(scalar), 1);
  compare(rivals::make_eigen_cg_ic(scalar), 1);
  compare(rivals::make_petsc_gamg(scalar), 1);
}

int run(int argc, char** argv) {
  int threads = 1;
  double tets = 11000;
  for (int i = 1; i < argc; i += 2) {
    const std::string option = argv[i];
    const double value = i + 1 < argc ? std::atof(argv[i + 1]) : 0;
    if ((option != "--threads" && option != "--tets") || value < 1) {
      fmt::print(stderr, "solver_rivals: {}: accepted: [--tets N] [--threads N], N at least 1\n", option);
      return 2;
    }
    if (option == "--threads") threads = static_cast<int>(value);
    if (option == "--tets") tets = value;
  }
  const Threads pool(threads);
  const TetMesh mesh = test_support::make_bar(benchmark_support::cubes_for(tets));
  const std::vector<Vec3> positions = benchmark_support::deform_bar(mesh.nodes, mesh.lattice.spacing);
  fmt::print("problem\tmethod\ttets\tthreads\tsetup_ms\tsolve_ms\titerations\trelative_residual\tratio_to_softreel\n");
  for (const SystemKind kind : {SystemKind::Dynamic, SystemKind::Static}) run_problem(mesh, positions, kind, pool);
  return 0;
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  try {
    return softreel::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "solver_rivals: {}\n", error.what());
    return 1;
  }
}
