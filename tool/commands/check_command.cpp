#include <cstdio>

#include <fmt/format.h>

#include "tool/commands/commands.h"
#include "tool/stages/glue_facts.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/shot_run.h"

namespace softreel {

int run_check(const ShotOptions& options) {
  ShotOptions silent = options;  // the facts are printed below, in order
  silent.quiet = true;
  Session session(silent);
  ShotRun run(session.shot(), session.context(), DialUse::LookUp);
  SceneStage scenes(run);
  scenes.require_looks();
  scenes.load_images();
  const GlueFacts glues = glue_facts(run);
  for (const std::string& line : glues.warnings) session.context().log.warn(line);
  RunReport report = session.report("check", run);
  if (options.json) {
    std::printf("%s\n", to_json(report).c_str());
    return 0;
  }
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    const BodyConstraints constraints = resolve_constraints(run.shot(), run.settings(b), run.loaded(b), Log{});
    const Vec3 size = used_bounds(run.loaded(b).surface).size();
    std::printf("%s: %s: %lld vertices, %lld triangles, %.4g x %.4g x %.4g m\n", report.bodies[b].name.c_str(),
                report.bodies[b].mesh.c_str(), static_cast<long long>(report.bodies[b].vertices),
                static_cast<long long>(report.bodies[b].triangles), size.x(), size.y(), size.z());
    for (const std::string& fact : report.bodies[b].facts) std::printf("  %s\n", fact.c_str());
    for (const Pin& pin : constraints.pins) std::printf("  %s: %zu points\n", pin.name.c_str(), pin.points.size());
    for (const Pull& pull : constraints.pulls) std::printf("  %s: %zu points\n", pull.name.c_str(), pull.points.size());
  }
  for (const std::string& line : glues.lines) std::printf("%s\n", line.c_str());
  std::printf("%s: sound.\n", session.shot().path.c_str());
  return 0;
}

}  // namespace softreel
