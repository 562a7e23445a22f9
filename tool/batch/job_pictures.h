/// Small pictures of a job's finished frames, for its report.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tool/batch/batch_result.h"

namespace softreel {

struct JobPictures {
  std::vector<std::uint8_t> sheet;  ///< PNG: some frames in a row, with their numbers; empty: no picture is there
  std::vector<std::uint8_t> cover;  ///< PNG: one frame
  int cover_frame = 0;
  int missing = 0;      ///< of the frames of the sheet
  std::string problem;  ///< why a picture that is there cannot be shown; empty: all can
};

/// Reads some of the frames' PNGs, equally far apart, and makes them small. Throws nothing for pictures that are not
/// there or cannot be read.
JobPictures make_job_pictures(const BatchJob& job, const JobPlan& plan);

}  // namespace softreel
