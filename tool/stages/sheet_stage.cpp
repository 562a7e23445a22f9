#include "tool/stages/sheet_stage.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/timer.h"
#include "render/image/contact_sheet.h"
#include "render/image/image_io.h"
#include "render/image/reduce.h"

namespace softreel {
namespace {

StageKey sheet_key(const Shot& shot, const std::vector<int>& frames, int columns, const Outputs& outputs) {
  KeyHasher key("sheet 3");
  const ShotSettings& settings = shot.settings;  // of the title
  key.add(outputs.shot_name()).add(settings.fps).add(settings.first_frame).add(settings.last_frame);
  key.add(frames).add(columns);
  for (const int frame : frames) {
    const auto entry = outputs.entry(outputs.frame_path(frame, "png"));
    key.add(entry ? entry->checksum : "");
  }
  return key.key();
}

std::string title_of(const Shot& shot, int width, int height) {
  const ShotSettings& settings = shot.settings;
  return fmt::format("{}    frames {} to {}, {} a second    {} x {}", settings.name, settings.first_frame,
                     settings.last_frame, settings.fps, width, height);
}

/// Never holds more than one frame at its full size.
DisplayImage sheet_of(const Shot& shot, const std::vector<int>& frames, int columns, const Outputs& outputs,
                      const RunContext& context) {
  SheetStyle style{.columns = columns, .title = {}};
  const int cell = sheet_cell_width(frames.size(), style);
  std::vector<SheetPicture> pictures;
  int width = 0, height = 0;
  for (const int frame : frames) {
    context.stop_if_cancelled();
    const std::string path = outputs.frame_path(frame, "png");
    const DisplayImage whole = over_grey(read_png(path));
    if (pictures.empty()) {
      width = whole.width;
      height = whole.height;
    }
    if (whole.width != width || whole.height != height)
      throw input_error(
          fmt::format("{}: has {} x {} pixels, the frames before it {} x {}.\n"
                      "  Accepted: frames of one size. Delete it and render it again.",
                      path, whole.width, whole.height, width, height));
    pictures.push_back({reduced(whole, cell), fmt::format("frame {}", frame)});
  }
  style.title = title_of(shot, width, height);
  return contact_sheet(pictures, style);
}

}  // namespace

std::vector<int> sheet_frames(int first, int last, int count) {
  const int all = last - first + 1, taken = std::clamp(count, 1, all);
  std::vector<int> frames;
  for (int k = 0; k < taken; ++k)
    frames.push_back(
        taken == 1 ? first : first + static_cast<int>(std::lround(static_cast<double>(k) * (all - 1) / (taken - 1))));
  return frames;
}

std::string make_sheet(const Shot& shot, const std::vector<int>& frames, int columns, Outputs& outputs,
                       const RunContext& context) {
  const std::string path = outputs.path("sheet.png");
  const StageKey key = sheet_key(shot, frames, columns, outputs);
  if (outputs.is_done(path, key)) return path;
  const ScopedStage stage(context.times, "sheet");
  const auto start = std::chrono::steady_clock::now();
  const std::vector<std::uint8_t> bytes = encode_png(sheet_of(shot, frames, columns, outputs, context));
  outputs.write(path, key, bytes, seconds_since(start));
  return path;
}

bool is_sheet_done(const Shot& shot, const std::vector<int>& frames, int columns, const Outputs& outputs) {
  return outputs.is_done(outputs.path("sheet.png"), sheet_key(shot, frames, columns, outputs));
}

OutputState sheet_state(const Shot& shot, const std::vector<int>& frames, int columns, const Outputs& outputs) {
  return outputs.state(outputs.path("sheet.png"), sheet_key(shot, frames, columns, outputs));
}

bool is_sheet_outdated(const Shot& shot, const std::vector<int>& frames, int columns, const Outputs& outputs) {
  return outputs.claimed_state(outputs.path("sheet.png"), sheet_key(shot, frames, columns, outputs)) ==
         OutputState::Stale;
}

}  // namespace softreel
