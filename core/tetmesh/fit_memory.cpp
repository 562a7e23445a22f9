#include "core/tetmesh/fit_memory.h"

#include <bit>

namespace softreel {
namespace {

std::uint64_t position_key(const Vec3& p) {
  std::uint64_t key = 0;
  for (int k = 0; k < 3; ++k) key = (key ^ std::bit_cast<std::uint64_t>(p[k])) * 0x9e3779b97f4a7c15ULL;
  return key;
}

}  // namespace

Index FitMemory::find_step(const Vec3& before) const {
  return table_.find(position_key(before),
                     [&](Index number) { return steps_[static_cast<std::size_t>(number)][0] == before; });
}

void FitMemory::add(const Vec3& before, const Vec3& after) {
  if (find_step(before) >= 0) return;
  steps_.push_back({before, after});
  table_.insert(static_cast<Index>(steps_.size() - 1),
                [&](Index number) { return position_key(steps_[static_cast<std::size_t>(number)][0]); });
}

const Vec3* FitMemory::find(const Vec3& before) const {
  const Index number = find_step(before);
  return number >= 0 ? &steps_[static_cast<std::size_t>(number)][1] : nullptr;
}

}  // namespace softreel
