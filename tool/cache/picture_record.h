/// Which finished file of the cache a picture's key stands for.
#pragma once

#include <optional>
#include <string>

#include "tool/cache/cache.h"
#include "tool/cache/stage_names.h"

namespace softreel {

/// The file files/CHECKSUM of the cache. Several keys may lead to one file: equal pictures are one file.
struct PictureRecord {
  StageKey checksum;
  double seconds = 0;  ///< what making it took
};

std::optional<PictureRecord> load_picture_record(const Cache& cache, const StageKey& key);
/// True if the record is there, and the file that it stands for; the bytes of that are not read.
bool is_picture_stored(const Cache& cache, const StageKey& key);
void store_picture_record(const Cache& cache, const StageKey& key, const PictureRecord& record);

}  // namespace softreel
