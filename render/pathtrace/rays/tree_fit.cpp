#include "render/pathtrace/rays/tree_fit.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace softreel {
namespace {

/// Triangles in a group, each level so many times the one below: 8, 64, 512, 4096.
constexpr int kLevels = 4;
constexpr std::size_t kBranching = 8;

struct Box {
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::infinity());
  Vec3f high = -low;

  void add(const Vec3f& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void add(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  double half_area() const {
    const Vec3 size = (high - low).cast<double>();
    return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
  }
};

const Vec3f& corner(std::span<const Vec3f> positions, const Triangle& triangle, std::size_t k) {
  return positions[static_cast<std::size_t>(triangle[k])];
}

/// The low 10 bits, with two zeros before each.
std::uint32_t spread(std::uint32_t bits) {
  bits = (bits | bits << 16) & 0x030000ffu;
  bits = (bits | bits << 8) & 0x0300f00fu;
  bits = (bits | bits << 4) & 0x030c30c3u;
  return (bits | bits << 2) & 0x09249249u;
}

/// Place on a Morton curve through `box`.
std::uint32_t morton_code(const Vec3f& p, const Box& box) {
  const float size = std::max((box.high - box.low).maxCoeff(), std::numeric_limits<float>::min());
  std::uint32_t code = 0;
  for (int k = 0; k < 3; ++k) {
    const float place = std::clamp((p[k] - box.low[k]) / size * 1024, 0.0f, 1023.0f);
    code |= spread(static_cast<std::uint32_t>(place)) << k;
  }
  return code;
}

std::vector<Triangle> along_curve(std::span<const Vec3f> rest, std::span<const Triangle> triangles) {
  Box box;
  for (const Vec3f& p : rest) box.add(p);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order;
  order.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const Vec3f middle = (corner(rest, t, 0) + corner(rest, t, 1) + corner(rest, t, 2)) / 3;
    order.emplace_back(morton_code(middle, box), static_cast<std::uint32_t>(order.size()));
  }
  std::sort(order.begin(), order.end());
  std::vector<Triangle> ordered;
  ordered.reserve(order.size());
  for (const auto& [code, triangle] : order) ordered.push_back(triangles[triangle]);
  return ordered;
}

}  // namespace

TreeFit::TreeFit(std::span<const Vec3f> rest, std::span<const Triangle> triangles)
    : ordered_(along_curve(rest, triangles)), at_rest_(mean_area_ratio(rest)) {}

double TreeFit::mean_area_ratio(std::span<const Vec3f> positions) const {
  double triangles = 0;
  std::array<double, kLevels> groups{};
  std::array<Box, kLevels> open;
  for (std::size_t k = 0; k < ordered_.size(); ++k) {
    Box box;
    for (std::size_t c = 0; c < 3; ++c) box.add(corner(positions, ordered_[k], c));
    triangles += box.half_area();
    const bool is_last = k + 1 == ordered_.size();
    std::size_t size = kBranching;
    for (std::size_t level = 0; level < kLevels; ++level, size *= kBranching) {
      open[level].add(box);
      if (!is_last && (k + 1) % size != 0) break;
      groups[level] += open[level].half_area();
      box = std::exchange(open[level], Box());
    }
  }
  double sum = 0;
  for (const double area : groups) sum += area;
  if (triangles > 0) return sum / (kLevels * triangles);
  return sum > 0 ? std::numeric_limits<double>::infinity() : 1.0;
}

double TreeFit::looseness(std::span<const Vec3f> positions) const {
  return mean_area_ratio(positions) / at_rest_;
}

bool is_worth_fitting(double looseness, std::size_t triangles, double paths) {
  // Cpu time, measured by tests/benchmark/tree_speed on bodies of 20k to 86k triangles, pulled and stretched up to four
  // times: us to build a tree, a triangle; us of a ray; how much slower rays are, for each unit that the looseness is
  // above 1 (between 2 and 5). Fitting costs a tenth of building, which is left out.
  constexpr double kBuild = 0.42, kRay = 0.18, kSlower = 3, kRaysAPath = 4;
  const double lost = kRaysAPath * paths * kRay * kSlower * (looseness - 1);
  return lost <= kBuild * static_cast<double>(triangles);
}

}  // namespace softreel
