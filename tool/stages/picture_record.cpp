#include "tool/stages/picture_record.h"

namespace softreel {

std::optional<PictureRecord> load_picture_record(const Cache& cache, const StageKey& key) {
  const auto stored = cache.load(kPictureStage, key);
  if (!stored) return std::nullopt;
  return PictureRecord{{stored->bytes.begin(), stored->bytes.end()}, stored->seconds};
}

void store_picture_record(const Cache& cache, const StageKey& key, const PictureRecord& record) {
  cache.store(kPictureStage, key, Bytes(record.checksum.begin(), record.checksum.end()), record.seconds);
}

}  // namespace softreel
