#include "tool/farm/task_script.h"

#include <fmt/format.h>

#include "tool/farm/shell_text.h"

namespace softreel {
namespace {

/// Says how the task fares, and ends it if its node does not see what it needs. A record appears as a whole.
constexpr const char* kChecks = R"bash(
set -u
node=${SLURMD_NODENAME:-$(uname -n)}

record() {
  local part=$records/tasks/.$task.$node.$$
  printf '%s\n' "$1" "$node" "$2" "$log" "$(date -u +%Y-%m-%dT%H:%M:%SZ)" "$job" >"$part" &&
    mv -f "$part" "$records/tasks/$task"
}

fail() {
  printf 'softreel farm: %s of %s: node %s %s\n' "$task" "$name" "$node" "$1" >&2
  [ -z "$keeps_log" ] || printf 'softreel: %s\n' "node $node $1" 2>/dev/null >>"$records/logs/$log"
  record failed 2 2>/dev/null
  exit 2
}

# shared WHAT FOLDER MARK: the folder is the one that the submitting machine sees, and can be written.
shared() {
  [ -d "$2" ] || fail "does not see the $1 folder $2. It must lie on a disk that all nodes share."
  [ -e "$3" ] || fail "sees another $1 folder at $2 than the machine that submitted. It must lie on a disk that all nodes share."
  [ -w "$2" ] || fail "cannot write to the $1 folder $2."
}

shared output "$output" "$records/$token"
shared cache "$cache" "$cache/.$token"
[ -x "$program" ] || fail "does not see the program $program."
said=$("$program" --version 2>&1) || fail "cannot start $program: $said"
read -r word number _ <<<"$said"
said="$word $number"
[ "$said" = "$version" ] || fail "has $said as $program; the jobs were submitted by $version."
sum=$(sha256sum <"$program")
[ "${sum%% *}" = "$checksum" ] || fail "has another build of $version as $program than the one that submitted. Submit again."
[ -r "$shot" ] || fail "does not see the shot $shot."
cd -- "$directory" || fail "does not see the folder $directory, where the jobs were submitted."
)bash";

constexpr const char* kRun = R"bash(
record running 0
if [ -n "$keeps_log" ]; then
  exec > >(tee -a "$records/logs/$log") 2>&1
fi
"$program" "${arguments[@]}" &
child=$!
# A scheduler that ends a task warns it first: softreel keeps what is finished.
trap 'kill -TERM "$child" 2>/dev/null' TERM
wait "$child"
status=$?
while kill -0 "$child" 2>/dev/null; do
  wait "$child"
  status=$?
done
if [ "$status" -ne 0 ]; then
  record failed "$status"
  printf 'softreel farm: %s of %s failed on node %s with status %s; log: %s\n' \
    "$task" "$name" "$node" "$status" "$records/logs/$log" >&2
  exit "$status"
fi
record done 0
)bash";

const char* command_of(FarmStep step) {
  switch (step) {
    case FarmStep::Simulate:
      return "simulate";
    case FarmStep::Frames:
      return "render --only frames";
    case FarmStep::Movie:
      return "render --only movie";
  }
  return "";
}

}  // namespace

std::string record_path(const FarmShot& shot, const std::string& task) {
  return shot.records + "/tasks/" + task;
}

std::string log_folder(const FarmShot& shot) {
  return shot.records + "/logs";
}

std::string cache_token_path(const FarmShot& shot) {
  return shot.cache + "/." + shot.token;
}

std::string shot_assignments(const FarmShot& shot) {
  return fmt::format("program={}\nshot={}\noutput={}\ncache={}\nrecords={}\ndirectory={}\n", shell_quoted(shot.program),
                     shell_quoted(shot.shot), shell_quoted(shot.output), shell_quoted(shot.cache),
                     shell_quoted(shot.records), shell_quoted(shot.directory));
}

std::string set_assignment(const FarmShot& shot, FarmStep step) {
  std::string text = fmt::format("name={}\nversion={}\nchecksum={}\ntoken={}\nsets=(", shell_quoted(shot.name),
                                 shell_quoted(shot.version), shell_quoted(shot.checksum), shell_quoted(shot.token));
  for (const std::string& set : shot.sets) text += "--set " + shell_quoted(set) + " ";
  // The last task cuts the cache: before it, others still need what they find there.
  if (step == FarmStep::Movie && shot.cache_limit_gb >= 0) text += fmt::format("--cache-limit {}", shot.cache_limit_gb);
  return text + ")\n";
}

std::string task_assignments(const TaskVariables& variables) {
  return fmt::format("task={}\njob={}\nlog={}\nframes={}\nthreads={}\nkeeps_log={}\n", variables.task, variables.job,
                     variables.log, variables.frames, variables.threads, variables.keeps_log ? "1" : "");
}

std::string task_body(FarmStep step) {
  return fmt::format(
      "{}arguments=({} \"$shot\" --frames \"$frames\" --output \"$output\" --cache \"$cache\" --threads \"$threads\"\n"
      "  ${{sets[@]+\"${{sets[@]}}\"}})\n{}",
      kChecks, command_of(step), kRun);
}

}  // namespace softreel
