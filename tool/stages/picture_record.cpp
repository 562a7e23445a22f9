#include "tool/stages/picture_record.h"

namespace softreel {

std::optional<PictureRecord> load_picture_record(const Cache& cache, const StageKey& key) {
  const auto stored = cache.load(kPictureStage, key);
  if (!stored) return std::nullopt;
  const std::string text(stored->bytes.begin(), stored->bytes.end());
  const auto blank = text.find(' ');
  if (blank == std::string::npos) return std::nullopt;
  return PictureRecord{text.substr(0, blank), text.substr(blank + 1), stored->seconds};
}

void store_picture_record(const Cache& cache, const StageKey& key, const PictureRecord& record) {
  const std::string text = record.extension + " " + record.checksum;
  cache.store(kPictureStage, key, Bytes(text.begin(), text.end()), record.seconds);
}

}  // namespace softreel
