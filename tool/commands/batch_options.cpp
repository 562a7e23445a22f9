#include "tool/commands/batch_options.h"

#include "tool/commands/shared_options.h"

namespace softreel {

void add_batch_command(CLI::App& app, BatchOptions& options, std::function<int()>& run) {
  CLI::App* batch = app.add_subcommand(
      "batch",
      "render several shots, and variants of them, each in a process of its own; one that fails stops no other");
  batch->add_option("shots", options.shots, "shot files (TOML)")->required()->option_text("SHOT ...");
  add_run_options(*batch, options.shot);
  batch->get_option("--threads")->description("threads of all running jobs together, 1 to 1024 [all processors]");
  batch->get_option("--json")->description("print what became of the jobs as JSON on standard output");
  batch
      ->add_option("--sweep", options.sweeps,
                   "render a variant for each value, e.g. body.tets=5000,20000; A..B/N: N numbers from A to B, "
                   "A..B/Nlog: by equal factors; several: all combinations (repeatable)")
      ->option_text("PATH=VALUES")
      ->expected(1)
      ->take_all()
      ->group("Shot");
  batch
      ->add_option("--report", options.report,
                   "folder of batch.html, batch.junit.xml and batch.json [where the files go]")
      ->option_text("DIR")
      ->group("Files");
  batch->add_option("--jobs", options.jobs, "jobs at one time, 1 to 256 [by processors and memory]")
      ->option_text("N")
      ->check(CLI::Range(1, 256))
      ->group("Running");
  batch
      ->add_option("--memory", options.memory_gb,
                   "memory that running jobs may be expected to need [what is available]")
      ->option_text("GB")
      ->check(length("amount of memory"))
      ->group("Running");
  batch->add_option("--retry", options.retries, "times to try again a job that crashed or was killed, 0 to 100 [0]")
      ->option_text("N")
      ->check(CLI::Range(0, 100))
      ->group("Running");
  CLI::Option* fail_fast =
      batch->add_flag("--fail-fast", options.fail_fast, "start no more jobs once one has failed")->group("Running");
  batch->add_flag("--keep-going", options.keep_going, "run all jobs whatever fails (this is the default)")
      ->excludes(fail_fast)
      ->group("Running");
  batch->callback([&options, &run] { run = [&options] { return run_batch(options); }; });
}

}  // namespace softreel
