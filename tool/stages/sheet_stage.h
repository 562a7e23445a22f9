/// A contact sheet: small pictures of some frames on one, SHOT.sheet.png.
#pragma once

#include <string>
#include <vector>

#include "tool/bodies/run_context.h"
#include "tool/outputs/outputs.h"
#include "tool/shot/shot.h"

namespace softreel {

struct SheetOptions {
  int count = 16;   ///< of pictures at most
  int columns = 4;  ///< of pictures side by side
};

/// At most `count` frames from first to last, both among them if count is above 1, equally far apart but for rounding.
std::vector<int> sheet_frames(int first, int last, int count);

/// Makes the sheet of the frames' PNGs, which must be there; nothing to do if it is there, made of the same ones.
/// Returns its path. Throws work_error, or input_error for a picture that cannot be read.
std::string make_sheet(const Shot& shot, const std::vector<int>& frames, int columns, Outputs& outputs,
                       const RunContext& context);

/// True if the sheet is there, whole, and made of the frames as the manifest has them now.
bool is_sheet_done(const Shot& shot, const std::vector<int>& frames, int columns, const Outputs& outputs);

/// The same, with the reason. Reads the sheet.
OutputState sheet_state(const Shot& shot, const std::vector<int>& frames, int columns, const Outputs& outputs);

/// True if a sheet is there that was not made of the frames as the manifest has them now.
bool is_sheet_outdated(const Shot& shot, const std::vector<int>& frames, int columns, const Outputs& outputs);

}  // namespace softreel
