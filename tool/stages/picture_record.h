/// Which finished file of the cache a picture's key stands for.
#pragma once

#include <optional>
#include <string>

#include "tool/stages/cache.h"
#include "tool/stages/stage_names.h"

namespace softreel {

/// The file files/CHECKSUM of the cache. Several keys may lead to one file: equal pictures are one file.
struct PictureRecord {
  StageKey checksum;
  double seconds = 0;  ///< what making it took
};

std::optional<PictureRecord> load_picture_record(const Cache& cache, const StageKey& key);
void store_picture_record(const Cache& cache, const StageKey& key, const PictureRecord& record);

}  // namespace softreel
