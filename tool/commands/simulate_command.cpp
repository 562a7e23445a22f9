#include <fmt/format.h>

#include "tool/commands/commands.h"
#include "tool/stages/shot_run.h"

namespace softreel {

int run_simulate(const ShotOptions& options) {
  if (options.dry_run) return run_plan(options);
  Session session(options);
  const FrameSpan frames = session.frames();
  ShotRun run(session.shot(), session.context());
  session.console().begin("frames", frames.count());
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    run.advance_to(frame);
    session.console().advance(frame - frames.first + 1, fmt::format("frame {}", frame));
  }
  RunReport report = session.report("simulate", run, true);
  report.made.push_back(session.context().cache.folder() + ": simulated frames");
  session.finish(report);
  return 0;
}

}  // namespace softreel
