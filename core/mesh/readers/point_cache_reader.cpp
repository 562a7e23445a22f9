#include "core/mesh/readers/point_cache_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "core/mesh/readers/mesh_source.h"

namespace softreel {
namespace {

using detail::MeshSource;

constexpr std::string_view kPc2Magic("POINTCACHE2\0", 12);

Error broken_cache(const MeshSource& source, const std::string& problem) {
  return detail::broken_file(source, "", problem,
                             "a point cache, .pc2 (version 1) or .mdd, as large as its header says",
                             "Export the cache again");
}

/// Numbers of four bytes, one after the other.
class Words {
 public:
  Words(const MeshSource& source, std::size_t begin, bool big_endian)
      : source_(source), place_(begin), big_endian_(big_endian) {}

  template <typename T>
  T next() {
    static_assert(sizeof(T) == 4);
    std::array<char, 4> bytes{};
    if (source_.bytes.size() - place_ < 4) throw broken_cache(source_, "the file ends before its data do");
    std::memcpy(bytes.data(), source_.bytes.data() + place_, 4);
    place_ += 4;
    if (big_endian_) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }
  std::size_t left() const { return (source_.bytes.size() - place_) / 4; }

 private:
  const MeshSource& source_;
  std::size_t place_;
  bool big_endian_;
};

/// Checked before anything is allocated.
void require_size(const MeshSource& source, const Words& words, std::int64_t samples, std::int64_t points,
                  std::int64_t words_a_sample) {
  if (samples < 1 || points < 1)
    throw broken_cache(source, fmt::format("the header names {} samples of {} points", samples, points));
  if (static_cast<std::int64_t>(words.left()) / samples < words_a_sample)
    throw broken_cache(source, fmt::format("the file ends before its data do: {} samples of {} points do not fit in it",
                                           samples, points));
}

void read_positions(const MeshSource& source, Words& words, PointCache& cache) {
  const std::size_t all = cache.seconds.size() * static_cast<std::size_t>(cache.points);
  cache.positions.reserve(all);
  for (std::size_t i = 0; i < all; ++i) {
    const float x = words.next<float>(), y = words.next<float>(), z = words.next<float>();
    cache.positions.emplace_back(x, y, z);
    if (!cache.positions.back().allFinite())
      throw broken_cache(source,
                         fmt::format("point {} of sample {} is not finite", i % static_cast<std::size_t>(cache.points),
                                     i / static_cast<std::size_t>(cache.points)));
  }
}

PointCache read_pc2(const MeshSource& source, double fps) {
  if (!source.bytes.starts_with(kPc2Magic)) throw broken_cache(source, "it does not begin with POINTCACHE2");
  Words words(source, kPc2Magic.size(), false);
  const auto version = words.next<std::int32_t>();
  PointCache cache;
  cache.points = words.next<std::int32_t>();
  words.next<float>();  // the frame of the first sample: where it plays is for the shot to say
  const auto rate = double{words.next<float>()};
  const auto samples = words.next<std::int32_t>();
  if (version != 1) throw broken_cache(source, fmt::format("it has version {}", version));
  if (!(rate > 0) || !std::isfinite(rate))
    throw broken_cache(source, fmt::format("its samples are {} frames apart", rate));
  require_size(source, words, samples, cache.points, 3 * std::int64_t{cache.points});
  for (std::int32_t s = 0; s < samples; ++s) cache.seconds.push_back(s * rate / fps);
  read_positions(source, words, cache);
  return cache;
}

PointCache read_mdd(const MeshSource& source) {
  Words words(source, 0, true);
  const auto samples = words.next<std::int32_t>();
  PointCache cache;
  cache.points = words.next<std::int32_t>();
  require_size(source, words, samples, cache.points, 1 + 3 * std::int64_t{cache.points});
  for (std::int32_t s = 0; s < samples; ++s) cache.seconds.push_back(double{words.next<float>()});
  const double first = cache.seconds.front();
  for (std::size_t s = 0; s < cache.seconds.size(); ++s) {
    cache.seconds[s] -= first;
    if (!std::isfinite(cache.seconds[s]))
      throw broken_cache(source, fmt::format("the time of sample {} is not finite", s));
    if (s > 0 && !(cache.seconds[s] > cache.seconds[s - 1]))
      throw broken_cache(source, fmt::format("the time of sample {} does not come after that before it", s));
  }
  read_positions(source, words, cache);
  return cache;
}

}  // namespace

bool is_point_cache_file(const std::string& path) {
  const std::string extension = detail::lower_extension(path);
  return extension == ".pc2" || extension == ".mdd";
}

PointCache read_point_cache(const std::string& path, double fps) {
  const std::string bytes = detail::read_mesh_file(path);
  const MeshSource source{path, bytes};
  return detail::lower_extension(path) == ".pc2" ? read_pc2(source, fps) : read_mdd(source);
}

}  // namespace softreel
