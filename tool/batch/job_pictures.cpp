#include "tool/batch/job_pictures.h"

#include <filesystem>

#include <fmt/format.h>

#include "core/base/error.h"
#include "render/image/contact_sheet.h"
#include "render/image/reduce.h"
#include "tool/stages/sheet_stage.h"

namespace softreel {
namespace {

constexpr int kFrames = 6, kColumns = 6;
constexpr int kSheetWidth = 1320, kCoverWidth = 320;  ///< pixels

std::string picture_path(const BatchJob& job, int frame) {
  return (std::filesystem::path(job.folder) / fmt::format("{}.{:04}.png", job.name, frame)).string();
}

}  // namespace

JobPictures make_job_pictures(const BatchJob& job, const JobPlan& plan) {
  JobPictures made;
  if (!plan.known) return made;
  std::vector<SheetPicture> pictures;
  std::vector<int> frames;
  for (const int frame : sheet_frames(plan.first_frame, plan.last_frame, kFrames)) {
    const std::string path = picture_path(job, frame);
    std::error_code none;
    if (!std::filesystem::is_regular_file(path, none)) {
      made.missing += 1;
      continue;
    }
    try {
      DisplayImage picture = over_grey(read_png(path));
      const bool fits = pictures.empty() || (picture.width == pictures.front().picture.width &&
                                             picture.height == pictures.front().picture.height);
      if (!fits) throw input_error(path + ": another size than the frame before");
      pictures.push_back({std::move(picture), fmt::format("frame {}", frame)});
      frames.push_back(frame);
    } catch (const Error& error) {
      made.problem = error.what();
      made.missing += 1;
    }
  }
  if (pictures.empty()) return made;
  const std::size_t middle = pictures.size() / 2;
  made.cover_frame = frames[middle];
  made.cover = encode_png(reduced(pictures[middle].picture, kCoverWidth));
  made.sheet = encode_png(contact_sheet(pictures, {.columns = kColumns, .width = kSheetWidth, .title = {}}));
  return made;
}

}  // namespace softreel
