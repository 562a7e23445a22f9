#include "tool/report/run_report.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "tool/cache/json_text.h"
#include "tool/cache/stage_names.h"
#include "tool/report/console.h"
#include "tool/report/version.h"

namespace softreel {

std::vector<BodyReport> report_bodies(const ShotRun& run) {
  std::vector<BodyReport> reports;
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    BodyReport report;
    const LoadedBody& loaded = run.loaded(b);
    report.name = run.settings(b).name;
    report.mesh = run.settings(b).mesh;
    report.vertices = static_cast<std::int64_t>(loaded.surface.positions.size());
    report.triangles = static_cast<std::int64_t>(loaded.surface.triangles.size());
    report.facts = loaded.facts;
    report.dial = run.dial(b);
    if (report.dial) report.dial_line = describe(*report.dial, run.shot());
    report.levels = run.simulation(b).levels();
    if (const FilledBody* filled = run.filled(b)) {
      report.nodes = static_cast<std::int64_t>(filled->mesh.nodes.size());
      report.tets = static_cast<std::int64_t>(filled->mesh.tets.size());
      report.tets_from_cache = filled->from_cache;
      report.tets_seconds = filled->seconds;
    } else if (const auto seconds = run.context().cache.seconds(kTetrahedraStage, run.simulation(b).filled_key())) {
      report.tets_from_cache = true;
      report.tets_seconds = *seconds;
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
  if (counts.computed == 0) return {};
  const SimulationWork& work = counts.work;
  std::string line = fmt::format("  simulation: {} body frames computed; {:.1f} solver iterations a frame",
                                 counts.computed, static_cast<double>(work.linear_iterations) / counts.computed);
  if (work.steps_at_rest > 0) line += fmt::format("; {} of {} steps left out at rest", work.steps_at_rest, work.steps);
  if (work.kept_hierarchies > 0)
    line += fmt::format("; {} hierarchies and {:.0f} % of the matrices kept", work.kept_hierarchies,
                        100 * work.kept_matrices / static_cast<double>(work.steps));
  if (work.steps_rejected > 0)
    line += fmt::format("; {} steps, {} more taken in vain to keep the error", work.steps, work.steps_rejected);
  if (work.frames_unchanged > 0) line += fmt::format("; {} frames unchanged and not solved", work.frames_unchanged);
  return line + "\n";
}

/// Bodies whose recovery was at work, with the frames and the most elements that it took.
std::string recovery_lines(const SimulationCounts& counts) {
  struct Span {
    int first, last, frames;
    Index elements;
  };
  std::map<std::string, Span> bodies;
  for (const FrameRecovery& recovery : counts.recoveries) {
    Span& span = bodies.try_emplace(recovery.body, Span{recovery.frame, recovery.frame, 0, 0}).first->second;
    span.first = std::min(span.first, recovery.frame);
    span.last = std::max(span.last, recovery.frame);
    span.frames += 1;
    span.elements = std::max(span.elements, recovery.elements);
  }
  std::string lines;
  for (const auto& [body, span] : bodies)
    lines += fmt::format("  recovery: {} in {} frames between {} and {}, at most {} tetrahedra\n", body, span.frames,
                         span.first, span.last, span.elements);
  return lines;
}

std::string picture_line(const PictureCounts& counts) {
  std::string line;
  const auto add = [&](int number, const char* what) {
    if (number > 0) line += fmt::format("{}{} {}", line.empty() ? "  pictures: " : ", ", number, what);
  };
  add(counts.traced, "traced");
  add(counts.linked, "equal to another and linked");
  add(counts.developed, "developed again without tracing");
  add(counts.recalled, "taken from the cache");
  add(counts.kept, "there already");
  return line.empty() ? line : line + "\n";
}

}  // namespace

std::vector<std::string> skipped_lines(const RunReport& report) {
  std::vector<std::string> lines;
  const auto add = [&](int number, const char* what, double seconds) {
    if (number > 0) lines.push_back(fmt::format("{} {} ({})", number, what, format_duration(seconds)));
  };
  int filled = 0;
  double fill_seconds = 0;
  for (const BodyReport& body : report.bodies) {
    filled += body.tets_from_cache ? 1 : 0;
    fill_seconds += body.tets_from_cache ? body.tets_seconds : 0;
  }
  for (const BodyReport& body : report.bodies)
    if (body.dial && body.dial->from_cache) add(1, "error dial", body.dial->seconds);
  add(filled, filled == 1 ? "tetrahedralisation" : "tetrahedralisations", fill_seconds);
  add(report.simulation.loaded + report.simulation.not_needed, "simulated body frames",
      report.simulation.saved_seconds);
  const PictureCounts& pictures = report.pictures;
  add(pictures.kept + pictures.recalled + pictures.developed + pictures.linked, "traced pictures",
      pictures.saved_seconds);
  add(report.files_kept, "written files", report.files_saved_seconds);
  return lines;
}

std::string to_text(const RunReport& report) {
  std::string text;
  for (const BodyReport& body : report.bodies) {
    text += fmt::format("  {}: {} triangles", body.name, body.triangles);
    if (body.tets > 0)
      text += fmt::format(", {} tetrahedra, {} nodes{}", body.tets, body.nodes,
                          body.tets_from_cache ? " (from the cache)" : "");
    text += "\n";
    if (body.dial)
      text += fmt::format("  {}: {} ({})\n", body.name, body.dial_line,
                          (body.dial->from_cache ? "from the cache, once " : "") + format_duration(body.dial->seconds));
  }
  text += simulation_line(report);
  text += recovery_lines(report.simulation);
  text += picture_line(report.pictures);
  if (report.files_written + report.files_kept > 0)
    text += fmt::format("  files: {} written, {} there already\n", report.files_written, report.files_kept);
  const std::vector<std::string> skipped = skipped_lines(report);
  if (!skipped.empty()) text += fmt::format("  skipped, with the time they once took: {}\n", fmt::join(skipped, ", "));
  text += fmt::format("  time: {} on {} threads; stages that ran side by side are counted each\n{}",
                      format_duration(report.seconds), report.threads,
                      stage_table(with_parents(report.stages), report.seconds));
  for (const std::string& made : report.made) text += "  made: " + made + "\n";
  return text;
}

namespace {

nlohmann::ordered_json to_json(const BodyDial& dial) {
  const DialChoice& choice = dial.choice;
  return {{"asked", dial.asked},
          {"believed", choice.believed.total()},
          {"mesh", choice.believed.mesh},
          {"time", choice.believed.time},
          {"solver", choice.believed.algebra},
          {"cancelled", choice.believed.cancelled},
          {"reached", choice.reached},
          {"tets", choice.chosen.tets},
          {"substeps", choice.chosen.substeps},
          {"tolerance", choice.chosen.tolerance},
          {"mesh_order", choice.mesh_order},
          {"step_order", choice.step_order},
          {"pilots", choice.pilots},
          {"finest_pilot", choice.finest_pilot},
          {"pilot_share", choice.pilot_share},
          {"pilot_seconds", dial.seconds},
          {"from_cache", dial.from_cache}};
}

}  // namespace

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
                              {"tets_seconds", body.tets_seconds},
                              {"facts", body.facts},
                              {"levels", levels}});
    if (body.dial) json["bodies"].back()["error"] = to_json(*body.dial);
  }
  const SimulationCounts& simulation = report.simulation;
  json["simulation"] = {{"computed", simulation.computed},
                        {"loaded", simulation.loaded},
                        {"not_needed", simulation.not_needed},
                        {"linear_iterations", simulation.work.linear_iterations},
                        {"nonlinear_iterations", simulation.work.nonlinear_iterations},
                        {"steps", simulation.work.steps},
                        {"steps_at_rest", simulation.work.steps_at_rest},
                        {"steps_rejected", simulation.work.steps_rejected},
                        {"frames_unchanged", simulation.work.frames_unchanged},
                        {"kept_hierarchies", simulation.work.kept_hierarchies},
                        {"kept_matrices", simulation.work.kept_matrices},
                        {"saved_seconds", simulation.saved_seconds}};
  json["simulation"]["recoveries"] = nlohmann::ordered_json::array();
  for (const FrameRecovery& recovery : simulation.recoveries)
    json["simulation"]["recoveries"].push_back(
        {{"body", recovery.body}, {"frame", recovery.frame}, {"elements", recovery.elements}});
  json["energies"] = nlohmann::ordered_json::parse(energies_to_json(report.energies));
  const PictureCounts& pictures = report.pictures;
  json["pictures"] = {{"traced", pictures.traced},       {"linked", pictures.linked},
                      {"developed", pictures.developed}, {"recalled", pictures.recalled},
                      {"kept", pictures.kept},           {"saved_seconds", pictures.saved_seconds}};
  json["files"] = {
      {"written", report.files_written}, {"kept", report.files_kept}, {"saved_seconds", report.files_saved_seconds}};
  json["skipped"] = skipped_lines(report);
  json["made"] = report.made;
  for (const auto& [name, entry] : report.stages)
    json["stages"][name] = {{"seconds", entry.seconds}, {"calls", entry.calls}};
  return json_text(json);
}

}  // namespace softreel
