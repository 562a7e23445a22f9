#include <fmt/format.h>

#include "tool/bodies/simulate_key.h"
#include "tool/commands/commands.h"
#include "tool/stages/shot_run.h"

namespace softreel {

namespace {

PlannedWork all_frames(const FrameSpan& frames) {
  PlannedWork work;
  for (int frame = frames.first; frame <= frames.last; ++frame) work.frames.push_back(frame);
  return work;
}

}  // namespace

int run_simulate(const ShotOptions& options) {
  if (options.dry_run)
    return run_plan(options,
                    [&](ShotRun& run, Outputs&) { return all_frames(parse_frames(options.frames, run.shot())); });
  Session session(options, Cache::Storing::Required);
  const FrameSpan frames = session.frames();
  ShotRun run(session.shot(), session.context());
  Outputs outputs(session.shot().output.directory, session.shot().settings.name, session.context().log);
  session.prepare(outputs, run);
  outputs.note_simulation();
  session.console().begin("frames", frames.count());
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    run.simulate(frame);
    session.console().advance(frame - frames.first + 1, fmt::format("frame {}", frame));
    session.keep_within_limit();
  }
  RunReport report = session.report("simulate", run);
  report.made.push_back(session.context().cache.folder() + ": simulated frames");
  session.finish(report);
  return 0;
}

}  // namespace softreel
