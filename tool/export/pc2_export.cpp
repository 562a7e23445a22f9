#include "tool/export/pc2_export.h"

#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"

namespace softreel {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

constexpr std::array<char, 12> kMagic{'P', 'O', 'I', 'N', 'T', 'C', 'A', 'C', 'H', 'E', '2', '\0'};

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
  put(kMagic);
  put(version);
  put(params.points);
  put(start);
  put(apart);
  put(params.samples);
  return header;
}

}  // namespace

Pc2Writer::Pc2Writer(const Pc2Params& params, Sink sink) : params_(params), sink_(std::move(sink)) {
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
  for (const Vec3& p : positions)
    for (int k = 0; k < 3; ++k) {
      sample_.push_back(static_cast<float>(p[k]));
      if (!std::isfinite(sample_.back()))
        throw work_error(
            fmt::format("point cache, sample {}: vertex {} has the coordinate {}, which is no finite "
                        "float32.\n  Accepted: finite positions. Look for a vertex in the mesh file or "
                        "a step of the simulation that is not finite, or export OBJ or PLY.",
                        written_ + 1, (sample_.size() + 2) / 3, p[k]));
    }
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

}  // namespace softreel
