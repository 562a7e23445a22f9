#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/cache/atomic_file.h"
#include "tool/cache/cache_use.h"
#include "tool/commands/commands.h"
#include "tool/stages/picture_stage.h"

namespace softreel {
namespace {

void say(const CacheRemoval& removal, const Cache& cache, bool dry_run) {
  std::printf("%s %lld files, %s, from %s; %s are left\n", dry_run ? "would remove" : "removed",
              static_cast<long long>(removal.files), format_bytes(removal.bytes).c_str(), cache.folder().c_str(),
              format_bytes(cache_size(cache) - (dry_run ? removal.bytes : 0)).c_str());
}

/// Throws work_error if something could not be removed.
void require_removed(const CacheRemoval& removal) {
  if (removal.problem.empty()) return;
  throw work_error(removal.problem + ".\n  Run the command as a user who may remove files there.");
}

void operator+=(CacheRemoval& sum, const CacheRemoval& more) {
  sum.files += more.files;
  sum.bytes += more.bytes;
  if (sum.problem.empty()) sum.problem = more.problem;
}

}  // namespace

int run_clean(const CleanOptions& options) {
  const bool dry_run = options.shot.dry_run;
  if (options.shot.shot.empty()) {
    if (options.shot.cache.empty())
      throw input_error(
          "clean: neither a shot nor a cache is named.\n  Accepted: softreel clean SHOT, or --cache DIR.");
    if (!options.all && options.shot.cache_limit_gb < 0)
      throw input_error(
          "clean: without a shot there is no telling what is still needed.\n  Accepted: --all, or --cache-limit GB, or "
          "a shot.");
  }
  if (options.shot.cache_limit_gb == 0)
    throw input_error(
        "clean: --cache-limit 0 stands for no limit.\n  Accepted: --all to remove everything, or more than 0.");
  Console console(Verbosity::Normal, false);
  const Log log{{}, console.log().warning_sink};
  CacheRemoval removal;
  if (options.shot.shot.empty()) {
    if (!std::filesystem::is_directory(options.shot.cache))
      throw input_error(
          fmt::format("clean: --cache {}: is no folder.\n  Accepted: a cache. Check the path.", options.shot.cache));
    const Cache cache(options.shot.cache, Cache::Storing::Wanted, log);
    removal += options.all ? empty_cache(cache, dry_run) : cut_cache(cache, options.shot.cache_limit_gb * 1e9, dry_run);
    say(removal, cache, dry_run);
    require_removed(removal);
    return 0;
  }
  ShotOptions silent = options.shot;
  silent.quiet = true;
  Session session(silent);
  const Shot& shot = session.shot();
  const Cache& cache = session.context().cache;
  if (options.all) {
    removal += empty_cache(cache, dry_run);
  } else {
    ShotRun run(shot, session.context(), DialUse::LookUp);
    Outputs outputs(shot.output.directory, shot.settings.name, session.context().log);
    const std::vector<CacheItem> needed = Session::items(run, outputs);
    removal += clean_cache(cache, CacheUse::owner_id(shot.path, shot.output.directory), needed, dry_run);
    if (!dry_run) CacheUse(cache, shot.path, shot.output.directory).claim(needed);  // remembered
    const Swept swept = sweep_temporaries(shot.output.directory, dry_run);
    removal.files += swept.files;
    removal.bytes += swept.bytes;
  }
  if (options.shot.cache_limit_gb >= 0) removal += cut_cache(cache, options.shot.cache_limit_gb * 1e9, dry_run);
  say(removal, cache, dry_run);
  require_removed(removal);
  return 0;
}

}  // namespace softreel
