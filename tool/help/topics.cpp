#include "tool/help/topics.h"

#include <algorithm>

#include <fmt/format.h>

namespace softreel {

namespace {

Topic exit_status() {
  return {
      "exit-status",
      "What the number means that softreel ends with.",
      "EXIT STATUS",
      {{"0", "Done."},
       {"1",
        "The work failed: a step that cannot be solved, a full disk or standard output, a golden image that changed, "
        "pictures that another run replaced; the message says which. What was finished is kept, and the same command "
        "goes on there."},
       {"2",
        "The input is wrong (an option, a field, a file) or a part is not built in; nothing was begun. The message "
        "says what is accepted."},
       {"130", "Interrupted by Ctrl-C, SIGTERM or a closed terminal; what was finished is kept."}}};
}

}  // namespace

const std::vector<Topic>& topics() {
  static const std::vector<Topic> all{
      exit_status(),
      {"variables",
       "Environment variables that softreel reads.",
       "ENVIRONMENT",
       {{"SOFTREEL_LOG",
         "How much is said where no option says it: error, warning, info (the default) or debug; see --log-level."},
        {"SOFTREEL_PRESETS",
         "Folder of the material library and the presets; without it, presets beside the program's build folder or "
         "../share/softreel/presets from the program."},
        {"TMPDIR", "Where the system keeps temporary files; used by ffmpeg only."}}},
      {"files",
       "What softreel reads and writes.",
       "FILES",
       {{"SHOT.toml", "A shot. `softreel new` writes one, `softreel fields` lists what it may say."},
        {"SHOT.####.png, SHOT.####.exr", "Pictures in the output folder, which is output.directory or --output."},
        {"SHOT.mp4", "Their movie, where ffmpeg is installed."},
        {"SHOT.resolved.toml", "The shot that a run used, with presets, --quality, --set and defaults written out."},
        {"SHOT.report.json", "What a run did, and where its time went."},
        {".cache",
         "In the output folder (or --cache DIR): results that later runs skip; `softreel clean SHOT` removes what the "
         "shot no longer needs, `--all` everything."},
        {"golden", "Beside a shot: the pictures that `softreel golden` compares with."}}},
      {"units",
       "What the numbers of a shot count.",
       "",
       {{"m, kg, s, N, Pa", "All fields are in SI units unless their name or `softreel explain FIELD` says otherwise."},
        {"_deg, _mm", "Fields with these endings are in degrees and millimetres."},
        {"unit = \"box\"",
         "In selections, and as keys_unit of pins and pulls: the box of the placed body, 0 to 1 along each axis; "
         "lengths count in its heights."},
        {"axes", "Right-handed, y up. A body faces +z; `up` says which axis of a mesh file points up."},
        {"colours", "Linear RGB, 0 to 1; pictures for colours are sRGB."}}},
      {"layers",
       "Where the value of a field comes from; later ones win.",
       "",
       {{"default", "What `softreel explain FIELD` says; the field need not be given."},
        {"use", "Presets that the shot names, in their order, each with those that it names underneath."},
        {"the shot", "Its own lines."},
        {"--quality NAME", "Those of draft, preview or final, or of any file of fields."},
        {"--set PATH=VALUE", "Overrides on the command line, in their order."}}},
      {"log",
       "What is said on standard error, and how much of it.",
       "",
       {{"error", "What stopped the work; always said."},
        {"warning", "What may not be what you want; all that --quiet leaves."},
        {"info", "What is done, and progress: the default."},
        {"debug", "Also which files, folders and settings are used, and times: --verbose."},
        {"--log-file FILE", "Adds all of this, with date, time and level, to the end of a file, whatever is shown."},
        {"standard output", "Holds results only: reports, --json, pages."}}},
  };
  return all;
}

const Topic* find_topic(const std::string& name) {
  const auto is_it = [&name](const Topic& topic) { return topic.name == name; };
  const auto found = std::find_if(topics().begin(), topics().end(), is_it);
  return found == topics().end() ? nullptr : &*found;
}

std::string to_text(const Topic& topic) {
  std::size_t width = 0;
  for (const TopicLine& line : topic.lines) width = std::max(width, line.name.size());
  std::string text = fmt::format("{}: {}\n", topic.name, topic.sentence);
  for (const TopicLine& line : topic.lines) text += fmt::format("  {:<{}}  {}\n", line.name, width, line.sentence);
  return text;
}

const std::vector<CommandExample>& command_examples() {
  static const std::vector<CommandExample> all{
      {"softreel new bunny.ply -o bunny.toml", "Writes a shot of a mesh, with a comment for every field."},
      {"softreel check bunny.toml", "Reads the shot and says what its mesh and selections hold."},
      {"softreel preview bunny.toml --mode fast", "Draws the motion quickly."},
      {"softreel render bunny.toml --frames 1-24", "Simulates and renders the first 24 frames."},
      {"softreel render bunny.toml --set render.samples=64 --set body.tets=50000",
       "Changes fields in passing; what does not depend on them is not computed again."},
      {"softreel explain body.*.pin[].select --shot bunny.toml", "Says what a field means and what the shot says."},
      {"softreel export bunny.toml --format pc2", "Writes the motion for another program."},
      {"source <(softreel completion bash)", "Lets bash complete commands, options, fields and files."},
  };
  return all;
}

}  // namespace softreel
