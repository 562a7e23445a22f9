#include "tool/cache/picture_record.h"

#include <filesystem>

namespace softreel {

std::optional<PictureRecord> load_picture_record(const Cache& cache, const StageKey& key) {
  const auto stored = cache.load(kPictureStage, key);
  if (!stored) return std::nullopt;
  return PictureRecord{{stored->bytes.begin(), stored->bytes.end()}, stored->seconds};
}

bool is_picture_stored(const Cache& cache, const StageKey& key) {
  const auto record = load_picture_record(cache, key);
  std::error_code none;
  return record && std::filesystem::is_regular_file(cache.file_path(record->checksum), none);
}

void store_picture_record(const Cache& cache, const StageKey& key, const PictureRecord& record) {
  cache.store(kPictureStage, key, Bytes(record.checksum.begin(), record.checksum.end()), record.seconds);
}

}  // namespace softreel
