#include "tool/report/run_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tool/report/console.h"

namespace softreel {

std::vector<BodyReport> report_bodies(const ShotRun& run, bool filled) {
  std::vector<BodyReport> reports;
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    BodyReport report;
    const LoadedBody& loaded = run.loaded(b);
    report.name = run.settings(b).name;
    report.mesh = run.settings(b).mesh;
    report.vertices = static_cast<std::int64_t>(loaded.surface.positions.size());
    report.triangles = static_cast<std::int64_t>(loaded.surface.triangles.size());
    report.facts = loaded.facts;
    if (filled) {
      report.nodes = static_cast<std::int64_t>(run.filled(b).mesh.nodes.size());
      report.tets = static_cast<std::int64_t>(run.filled(b).mesh.tets.size());
      report.tets_from_cache = run.filled(b).from_cache;
      report.levels = run.levels(b);
    }
    reports.push_back(std::move(report));
  }
  return reports;
}

namespace {

/// Time of a stage without that of its sub-stages, which are listed under it.
std::string stage_table(const std::map<std::string, StageTimes::Entry>& stages, double seconds) {
  std::string text;
  for (const auto& [name, entry] : stages) {
    const auto slash = name.rfind('/');
    const std::string shown = slash == std::string::npos ? name : "  " + name.substr(slash + 1);
    const double share = seconds > 0 ? 100 * entry.seconds / seconds : 0;
    text += fmt::format("    {:<18}{:>9.2f} s  {:>3.0f} %\n", shown, entry.seconds, share);
  }
  return text;
}

/// A parent line for stages that only appear as "parent/child".
std::map<std::string, StageTimes::Entry> with_parents(const std::map<std::string, StageTimes::Entry>& stages) {
  auto all = stages;
  for (const auto& [name, entry] : stages) {
    const auto slash = name.find('/');
    if (slash == std::string::npos || stages.count(name.substr(0, slash)) > 0) continue;
    all[name.substr(0, slash)].seconds += entry.seconds;
    all[name.substr(0, slash)].calls += entry.calls;
  }
  return all;
}

std::string simulation_line(const RunReport& report) {
  const SimulationCounts& counts = report.simulation;
  if (counts.frames == 0) return {};
  const int simulated = counts.frames - counts.frames_from_cache;
  std::string line = fmt::format("  simulation: {} body frames computed, {} taken from the cache", simulated,
                                 counts.frames_from_cache);
  if (simulated > 0)
    line +=
        fmt::format("; {:.1f} solver iterations a frame", static_cast<double>(counts.linear_iterations) / simulated);
  return line + "\n";
}

}  // namespace

std::string to_text(const RunReport& report) {
  std::string text;
  for (const BodyReport& body : report.bodies) {
    text += fmt::format("  {}: {} triangles", body.name, body.triangles);
    if (body.tets > 0)
      text += fmt::format(", {} tetrahedra, {} nodes{}", body.tets, body.nodes,
                          body.tets_from_cache ? " (from the cache)" : "");
    text += "\n";
  }
  text += simulation_line(report);
  if (report.pictures_traced + report.pictures_linked + report.pictures_kept > 0)
    text += fmt::format("  pictures: {} traced, {} equal to another and copied, {} there already\n",
                        report.pictures_traced, report.pictures_linked, report.pictures_kept);
  text += fmt::format("  time: {} on {} threads, of which\n{}", format_duration(report.seconds), report.threads,
                      stage_table(with_parents(report.stages), report.seconds));
  for (const std::string& made : report.made) text += "  made: " + made + "\n";
  return text;
}

std::string to_json(const RunReport& report) {
  nlohmann::ordered_json json;
  json["softreel"] = version_text();
  json["command"] = report.command;
  json["shot"] = report.shot;
  json["frames"] = {report.first_frame, report.last_frame};
  json["threads"] = report.threads;
  json["seconds"] = report.seconds;
  for (const BodyReport& body : report.bodies) {
    nlohmann::ordered_json levels = nlohmann::ordered_json::array();
    for (const LevelInfo& level : body.levels)
      levels.push_back({{"nodes", level.nodes}, {"blocks", level.blocks}, {"bytes", level.bytes}});
    json["bodies"].push_back({{"name", body.name},
                              {"mesh", body.mesh},
                              {"vertices", body.vertices},
                              {"triangles", body.triangles},
                              {"nodes", body.nodes},
                              {"tets", body.tets},
                              {"tets_from_cache", body.tets_from_cache},
                              {"facts", body.facts},
                              {"levels", levels}});
  }
  json["simulation"] = {{"frames", report.simulation.frames},
                        {"frames_from_cache", report.simulation.frames_from_cache},
                        {"linear_iterations", report.simulation.linear_iterations},
                        {"nonlinear_iterations", report.simulation.nonlinear_iterations}};
  json["pictures"] = {
      {"traced", report.pictures_traced}, {"copied", report.pictures_linked}, {"kept", report.pictures_kept}};
  json["made"] = report.made;
  for (const auto& [name, entry] : report.stages)
    json["stages"][name] = {{"seconds", entry.seconds}, {"calls", entry.calls}};
  return json.dump(1);
}

std::string version_text() {
  return fmt::format("softreel {} (g++ {}, Eigen {}.{}.{})", SOFTREEL_VERSION, __VERSION__, EIGEN_WORLD_VERSION,
                     EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
}

}  // namespace softreel
