/// Counts the iterations of the multigrid solver over sizes, Poisson's ratios, aspects and stiffness contrasts.
///
/// iteration_counts [--tets N,N,...] [--smoother gauss_seidel|one_way_gauss_seidel|chebyshev] [--sweeps N] [--degree N]
/// [--cycle auto|v|w|full_w] [--copy_contrast X] [--contrasts none,blocks,random] [--threads N] prints tab-separated
/// values: iterations to 1e-6 of bars of about that many tetrahedra each (default 11000; a million take 1.6 GB). state:
/// rest, under weight, whose error is smooth; or deformed as in solver_rivals. contrast: none, or Young's modulus 1e6
/// times higher in every second block of half the bar's width, in three dimensions, or in a tenth of the elements,
/// drawn at random. ratio: to the first size's bar of aspect 4, nu 0.3, same problem and state.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/multigrid/multigrid.h"
#include "tests/benchmark/bar_problem.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using benchmark_support::LinearSystem;
using benchmark_support::SystemKind;

constexpr double kContrast = 1e6;
constexpr double kWidth = 0.25;

struct Case {
  Index aspect = 4;
  double poisson_ratio = 0.3;
  std::string contrast = "none";
};

const std::vector<Case> kCases{{4, 0.3, "none"},  {4, 0.45, "none"},  {1, 0.3, "none"},
                               {20, 0.3, "none"}, {1, 0.45, "none"},  {20, 0.45, "none"},
                               {4, 0.49, "none"}, {4, 0.3, "blocks"}, {4, 0.3, "random"}};

/// A bar of the width of the targets' and about so many tetrahedra.
TetMesh make_bar(Index aspect, double tets) {
  const auto across = std::max(2, static_cast<Index>(std::lround(std::cbrt(tets / (12.0 * aspect)))));
  return test_support::make_box({aspect * across, across, across}, kWidth / across);
}

std::vector<double> stiffness_of(const TetMesh& mesh, const std::string& contrast) {
  std::vector<double> stiffness(mesh.tets.size(), benchmark_support::kBarMaterial.youngs_modulus);
  std::mt19937 random(7);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    Vec3 center = Vec3::Zero();
    for (const Index node : mesh.tets[e]) center += mesh.nodes[static_cast<std::size_t>(node)] / (2 * kWidth);
    const auto sum = static_cast<int>(center[0]) + static_cast<int>(center[1]) + static_cast<int>(center[2]);
    if ((contrast == "blocks" && sum % 2 == 1) || (contrast == "random" && random() % 10 == 0))
      stiffness[e] *= kContrast;
  }
  return stiffness;
}

struct Options {
  std::vector<double> sizes{11000};
  std::vector<std::string> contrasts{"none", "blocks", "random"};
  MultigridParams params;
  int threads = 1;
};

void run_case(const Case& which, double tets, const Options& options, const Threads& threads,
              std::map<std::string, int>& reference) {
  const TetMesh mesh = make_bar(which.aspect, tets);
  const std::vector<double> stiffness = stiffness_of(mesh, which.contrast);
  std::vector<ElementMaterial> materials(mesh.tets.size(), benchmark_support::kBarMaterial);
  for (std::size_t e = 0; e < materials.size(); ++e) {
    materials[e].poisson_ratio = which.poisson_ratio;
    materials[e].youngs_modulus = stiffness[e];
  }
  const bool homogeneous = which.contrast == "none";
  MultigridParams params = options.params;
  params.poisson_ratio = which.poisson_ratio;
  Multigrid multigrid(mesh, homogeneous ? std::span<const double>() : std::span<const double>(stiffness),
                      stiffness_pattern(mesh.tets, static_cast<Index>(mesh.nodes.size())), params, threads);
  for (const SystemKind kind : {SystemKind::Dynamic, SystemKind::Static})
    for (const std::string state : {"rest", "deformed"}) {
      const std::vector<Vec3> positions =
          state == "rest" ? mesh.nodes : benchmark_support::deform_bar(mesh.nodes, mesh.lattice.spacing);
      const LinearSystem system = make_system(mesh, materials, positions, kind, threads);
      multigrid.update(system.matrix, system.pinned);
      std::vector<Vec3> x(mesh.nodes.size(), Vec3::Zero());
      const SolveReport report = multigrid.solve(system.matrix, system.load, x, 1e-6, 0, 1000);
      const std::string key = name_of(kind) + state;
      reference.try_emplace(key, report.iterations);
      fmt::print("{}\t{}\t{}\t{}\t{}\t{}\t{}\t{:.2f}\t{}\t{}\n", mesh.tets.size(), which.aspect, which.poisson_ratio,
                 which.contrast, name_of(kind), state, report.iterations,
                 static_cast<double>(report.iterations) / reference.at(key), report.ok() ? "ok" : "failed",
                 report.double_cycle ? "double" : "float");
      std::fflush(stdout);
    }
}

SmootherKind smoother_of(const std::string& name) {
  if (name == "gauss_seidel") return SmootherKind::GaussSeidel;
  if (name == "one_way_gauss_seidel") return SmootherKind::OneWayGaussSeidel;
  if (name == "chebyshev") return SmootherKind::Chebyshev;
  throw std::invalid_argument(name + " is no smoother");
}

CycleKind cycle_of(const std::string& name) {
  if (name == "auto") return CycleKind::Auto;
  if (name == "v") return CycleKind::V;
  if (name == "w") return CycleKind::W;
  if (name == "full_w") return CycleKind::FullW;
  throw std::invalid_argument(name + " is no cycle");
}

std::vector<std::string> split(const std::string& value) {
  std::vector<std::string> parts;
  std::istringstream list(value);
  for (std::string part; std::getline(list, part, ',');) parts.push_back(part);
  return parts;
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; i += 2) {
    const std::string option = argv[i];
    if (i + 1 == argc) throw std::invalid_argument(option + " has no value");
    const std::string value = argv[i + 1];
    if (option == "--tets") {
      options.sizes.clear();
      for (const std::string& size : split(value)) options.sizes.push_back(std::stod(size));
    } else if (option == "--contrasts") {
      options.contrasts = split(value);
    } else if (option == "--cycle") {
      options.params.coarse_cycle = cycle_of(value);
    } else if (option == "--smoother") {
      options.params.smoother = smoother_of(value);
    } else if (option == "--sweeps") {
      options.params.sweeps = std::stoi(value);
    } else if (option == "--degree") {
      options.params.chebyshev_degree = std::stoi(value);
    } else if (option == "--copy_contrast") {
      options.params.stiffness_contrast = std::stod(value);
    } else if (option == "--threads") {
      options.threads = std::stoi(value);
    } else {
      throw std::invalid_argument(option + " is no option");
    }
  }
  return options;
}

void run(const Options& options) {
  const Threads threads(options.threads);
  std::map<std::string, int> reference;
  fmt::print("tets\taspect\tnu\tcontrast\tproblem\tstate\titerations\tratio\tstatus\tcycle\n");
  for (const double tets : options.sizes)
    for (const Case& which : kCases)
      if (std::find(options.contrasts.begin(), options.contrasts.end(), which.contrast) != options.contrasts.end())
        run_case(which, tets, options, threads, reference);
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  try {
    softreel::run(softreel::parse(argc, argv));
    return 0;
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "iteration_counts: {}; the options stand at the top of its source\n", error.what());
    return 2;
  }
}
