#include "tool/export/mdd_export.h"

#include <bit>

#include <fmt/format.h>

#include "core/base/check.h"
#include "tool/export/float_values.h"

namespace softreel {
namespace {

static_assert(std::endian::native == std::endian::little, "values are turned round on their way out");

class MddFile : public ExportWriter {
 public:
  explicit MddFile(ExportTarget target) : target_(std::move(target)) {
    require_float_times("mdd", target_.times, target_.settings.fps);
    put(static_cast<std::uint32_t>(target_.times.count));
    put(static_cast<std::uint32_t>(target_.bodies[0].mesh->positions.size()));
    for (int sample = 0; sample < target_.times.count; ++sample)
      put(std::bit_cast<std::uint32_t>(seconds_of(target_.times, sample, target_.settings.fps)));
    flush();
  }

  void append(const ExportSample& sample) override {
    CHECK(sample.positions.size() == target_.bodies[0].mesh->positions.size());
    values_.clear();
    append_floats(fmt::format("{}.mdd, body {}, frame {}", target_.shot, target_.bodies[0].name, sample.frame),
                  sample.positions, values_);
    for (const float value : values_) put(std::bit_cast<std::uint32_t>(value));
    flush();
    ++written_;
  }

  void finish() override { CHECK(written_ == target_.times.count); }

 private:
  void put(std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes_.push_back(static_cast<std::uint8_t>(value >> shift));
  }
  void flush() {
    target_.sink(bytes_);
    bytes_.clear();
  }

  ExportTarget target_;
  std::vector<float> values_;
  std::vector<std::uint8_t> bytes_;  ///< of the header, or of one sample
  int written_ = 0;
};

}  // namespace

ExportFormat mdd_format() {
  ExportFormat format;
  format.name = "mdd";
  format.about = "MDD point cache, a file a body, positions and times; float32";
  format.file_per = FilePer::Body;
  format.has_seconds = true;
  format.make = [](ExportTarget target) { return std::make_unique<MddFile>(std::move(target)); };
  return format;
}

}  // namespace softreel
