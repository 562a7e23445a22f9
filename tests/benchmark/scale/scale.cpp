#include "tests/benchmark/scale/scale.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "tool/cache/process.h"

namespace softreel::bench {
namespace {

/// Wanted: time ~ N^p with p at most this.
constexpr double kWantedExponent = 1.05;

/// A second fit starts here: below, what does not depend on the size shows. Under the nominal 30000 by more than meshes
/// miss the number of tetrahedra that they are asked for.
constexpr double kLeastLarge = 2.5e4;

/// Of every mesh: the first steps of the sag take more iterations than later ones.
constexpr int kSteps = 8;

/// Of one run of scale_point; seconds and bytes as it prints them.
struct ScalePoint {
  int threads = 1;
  double tets = 0, fill_seconds = 0, setup_seconds = 0, step_seconds = 0, iterations = 0, fill_bytes = 0, bytes = 0;
};

ScalePoint measure_point(long tets, int threads) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "scale_point";
  std::string said;
  const int status =
      run_process({program.string(), std::to_string(tets), std::to_string(threads), std::to_string(kSteps)}, &said);
  ScalePoint point;
  point.threads = threads;
  std::istringstream line(said);
  if (status != 0 || !(line >> point.tets >> point.fill_seconds >> point.setup_seconds >> point.step_seconds >>
                       point.iterations >> point.fill_bytes >> point.bytes))
    throw std::runtime_error(fmt::format("scale_point {} {} ended with {}: {}", tets, threads, status, said));
  return point;
}

/// Bytes the machine can still give; throws where the kernel does not say.
double available_bytes() {
  std::ifstream file("/proc/meminfo");
  for (std::string name; file >> name;) {
    double kilobytes = 0;
    if (name == "MemAvailable:" && file >> kilobytes) return kilobytes * 1024;
  }
  throw std::runtime_error("/proc/meminfo does not say what memory is available");
}

/// By what the largest point so far took a tetrahedron; nothing is known of the first.
double expected_bytes(const std::vector<ScalePoint>& points, long tets) {
  double most_tets = 0, bytes_a_tet = 0;
  for (const ScalePoint& p : points)
    if (p.tets >= most_tets) {
      most_tets = p.tets;
      bytes_a_tet = std::max(p.fill_bytes, p.bytes);
    }
  return bytes_a_tet * static_cast<double>(tets);
}

struct Quantity {
  const char* name;
  double ScalePoint::*value;
};
constexpr Quantity kTimes[] = {
    {"fill", &ScalePoint::fill_seconds}, {"set-up", &ScalePoint::setup_seconds}, {"step", &ScalePoint::step_seconds}};

Table point_table(const std::vector<ScalePoint>& points) {
  Table table{"scale",
              "One thread: processor seconds; two: seconds on the wall",
              {"threads", "tets", "fill / s", "set-up / s", "step / s", "step / (us a tet)", "iterations a step",
               "fill, bytes a tet", "all, bytes a tet"},
              {}};
  for (const ScalePoint& p : points)
    table.add({static_cast<long>(p.threads), static_cast<long>(p.tets), p.fill_seconds, p.setup_seconds, p.step_seconds,
               1e6 * p.step_seconds / p.tets, p.iterations, p.fill_bytes, p.bytes});
  return table;
}

/// Over the meshes of at least so many tetrahedra; not a number for fewer than two of them.
double exponent_of(const std::vector<ScalePoint>& points, int threads, const Quantity& quantity, double least_tets) {
  std::vector<double> x, y;
  for (const ScalePoint& p : points)
    if (p.threads == threads && p.tets >= least_tets) {
      x.push_back(p.tets);
      y.push_back(p.*quantity.value);
    }
  return x.size() < 2 ? std::nan("") : fit_exponent(x, y);
}

/// Exponents of each quantity and thread count; those above the wanted one are named in `above`.
Table exponent_table(const std::vector<ScalePoint>& points, std::string& above) {
  Table table{"scale_exponents",
              fmt::format("p in time ~ N^p, least squares over all meshes, wanted: at most {}; and over those from "
                          "{:.0f} tetrahedra on, which leave the caches",
                          kWantedExponent, kLeastLarge),
              {"threads", "time of", "p", "p of large meshes"},
              {}};
  for (const int threads : {1, 2})
    for (const Quantity& quantity : kTimes) {
      const double exponent = exponent_of(points, threads, quantity, 0);
      const double large = exponent_of(points, threads, quantity, kLeastLarge);
      table.add({static_cast<long>(threads), std::string(quantity.name), exponent, large});
      if (exponent > kWantedExponent)
        above += fmt::format(" {} on {} thread(s): {:.3f}.", quantity.name, threads, exponent);
      if (large > kWantedExponent)
        above += fmt::format(" {} on {} thread(s), large meshes: {:.3f}.", quantity.name, threads, large);
    }
  return table;
}

Plot time_plot(const std::vector<ScalePoint>& points) {
  Plot plot{"scale",
            "Seconds of filling, set-up and one step over the number of tetrahedra",
            "tetrahedra",
            "seconds (1 thread: processor time; 2: wall)",
            true,
            true,
            {}};
  for (const Quantity& quantity : kTimes)
    for (const int threads : {1, 2}) {
      Series series{
          fmt::format("{}, {} thread{}", quantity.name, threads, threads > 1 ? "s" : ""), {}, {}, false, false};
      series.ours = std::string(quantity.name) == "step";
      for (const ScalePoint& p : points)
        if (p.threads == threads) {
          series.x.push_back(p.tets);
          series.y.push_back(p.*quantity.value);
        }
      plot.series.push_back(series);
    }
  return plot;
}

}  // namespace

double fit_exponent(const std::vector<double>& x, const std::vector<double>& y) {
  double sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = std::log(x[i]), b = std::log(y[i]);
    sum_x += a;
    sum_y += b;
    sum_xx += a * a;
    sum_xy += a * b;
  }
  return (n * sum_xy - sum_x * sum_y) / (n * sum_xx - sum_x * sum_x);
}

void run_scale(const BenchOptions& options, Report& report) {
  const std::vector<long> sizes =
      options.quick ? std::vector<long>{1000, 10000, 40000, 100000, 300000}
                    : std::vector<long>{1000, 3000, 10000, 30000, 100000, 300000, 1000000, 3000000, 10000000};
  report.say(
      "The creature of the assets is filled, pinned at its feet and sags under its weight, E = 1 MPa, Poisson's ratio "
      "0.4, 1/96 s a step, one solve a step to 1e-3. Set-up is everything before the second step: embedding, element "
      "matrices, hierarchy, first step. Each point is a process of its own, `scale_point TETS THREADS STEPS`.");
  std::vector<ScalePoint> points;
  for (const long tets : sizes)
    for (const int threads : {1, 2}) {
      const double needed = expected_bytes(points, tets);
      if (needed > available_bytes()) {
        report.say(fmt::format("{} tetrahedra on {} thread(s) are left out: this machine has no {:.1f} GB free.", tets,
                               threads, 1e-9 * needed));
        continue;
      }
      points.push_back(measure_point(tets, threads));
      fmt::print("  {} tetrahedra, {} thread(s): step {:.4g} s\n", tets, threads, points.back().step_seconds);
      std::fflush(stdout);
    }
  std::string above;
  const Table exponents = exponent_table(points, above);
  report.say(
      above.empty()
          ? fmt::format("Every time grows with an exponent of at most {}, over all meshes and over the large ones.",
                        kWantedExponent)
          : fmt::format("Above the wanted exponent of {}:{}", kWantedExponent, above));
  report.add(exponents);
  report.add(time_plot(points));
  report.add(point_table(points));
}

}  // namespace softreel::bench
