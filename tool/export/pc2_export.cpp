#include "tool/export/pc2_export.h"

#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "tool/export/float_values.h"

namespace softreel {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

constexpr std::array<char, 12> kPointCacheMagic{'P', 'O', 'I', 'N', 'T', 'C', 'A', 'C', 'H', 'E', '2', '\0'};

/// The header has no gaps: seven fields one after the other.
std::array<std::uint8_t, 32> encode_header(const Pc2Params& params) {
  const std::int32_t version = 1;
  const auto start = static_cast<float>(params.start_frame), apart = static_cast<float>(params.frames_apart);
  std::array<std::uint8_t, 32> header{};
  std::size_t at = 0;
  const auto put = [&](const auto& value) {
    std::memcpy(header.data() + at, &value, sizeof value);
    at += sizeof value;
  };
  put(kPointCacheMagic);
  put(version);
  put(params.points);
  put(start);
  put(apart);
  put(params.samples);
  return header;
}

class Pc2File : public ExportWriter {
 public:
  explicit Pc2File(const ExportTarget& target)
      : writer_({static_cast<Index>(target.bodies[0].mesh->positions.size()), target.times.count, target.times.first,
                 1.0 / target.times.per_frame},
                target.sink) {}
  void append(const ExportSample& sample) override { writer_.append(sample.positions); }
  void finish() override { writer_.finish(); }

 private:
  Pc2Writer writer_;
};

}  // namespace

Pc2Writer::Pc2Writer(const Pc2Params& params, ExportSink sink) : params_(params), sink_(std::move(sink)) {
  if (params.points < 1 || params.samples < 1)
    throw input_error(
        fmt::format("a point cache of {} points and {} frames holds nothing.\n"
                    "  Accepted: at least 1 of each. Check the frames of the shot.",
                    params.points, params.samples));
  sink_(encode_header(params));
}

void Pc2Writer::append(std::span<const Vec3> positions) {
  CHECK(positions.size() == static_cast<std::size_t>(params_.points));
  CHECK(written_ < params_.samples);
  sample_.clear();
  append_floats(fmt::format("point cache, sample {}", written_ + 1), positions, sample_);
  sink_({reinterpret_cast<const std::uint8_t*>(sample_.data()), sample_.size() * sizeof(float)});
  ++written_;
}

void Pc2Writer::finish() const {
  if (written_ != params_.samples)
    throw work_error(
        fmt::format("point cache: {} of {} samples were written.\n  Accepted: all of them. Run the export "
                    "again.",
                    written_, params_.samples));
}

ExportFormat pc2_format() {
  ExportFormat format;
  format.name = "pc2";
  format.about = "PC2 point cache, a file a body, positions alone; float32";
  format.file_per = FilePer::Body;
  format.version = 3;
  format.make = [](const ExportTarget& target) { return std::make_unique<Pc2File>(target); };
  return format;
}

}  // namespace softreel
