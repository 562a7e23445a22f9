#include "core/mesh/point_cache.h"

#include <algorithm>

#include "core/base/fingerprint.h"

namespace softreel {

CachedVertices::CachedVertices(PointCache cache) : cache_(std::move(cache)) {
  const auto points = static_cast<std::size_t>(cache_.points);
  for (std::size_t s = 0; s < cache_.seconds.size(); ++s) {
    Fingerprint print;
    for (std::size_t v = 0; v < points; ++v) print.add(cache_.positions[s * points + v].cast<double>().eval());
    prints_.push_back({print.high(), print.low()});
  }
}

CachedVertices::Place CachedVertices::place(double seconds) const {
  const std::vector<double>& times = cache_.seconds;
  const auto next = std::upper_bound(times.begin(), times.end(), seconds);
  if (next == times.begin()) return {0, 0};
  const auto sample = static_cast<std::size_t>(next - times.begin()) - 1;
  if (next == times.end()) return {sample, 0};
  return {sample, (seconds - times[sample]) / (*next - times[sample])};
}

Vec3 CachedVertices::position(std::size_t sample, Index vertex) const {
  const std::size_t at = sample * static_cast<std::size_t>(cache_.points) + static_cast<std::size_t>(vertex);
  return cache_.positions[at].cast<double>();
}

std::vector<Vec3> CachedVertices::at(double seconds, std::span<const Index> vertices) const {
  const Place time = place(seconds);
  std::vector<Vec3> positions;
  positions.reserve(vertices.size());
  for (const Index v : vertices) {
    const Vec3 first = position(time.sample, v);
    positions.push_back(time.share == 0 ? first : Vec3(first + time.share * (position(time.sample + 1, v) - first)));
  }
  return positions;
}

std::vector<Vec3> CachedVertices::rest() const {
  std::vector<Vec3> positions;
  for (Index v = 0; v < cache_.points; ++v) positions.push_back(position(0, v));
  return positions;
}

std::vector<double> CachedVertices::pose(double seconds) const {
  const Place time = place(seconds);
  std::vector<double> numbers(prints_[time.sample].begin(), prints_[time.sample].end());
  if (time.share == 0) return numbers;
  numbers.insert(numbers.end(), prints_[time.sample + 1].begin(), prints_[time.sample + 1].end());
  numbers.push_back(time.share);
  return numbers;
}

}  // namespace softreel
