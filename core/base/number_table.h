/// A hash table of numbers whose keys are kept elsewhere: four bytes a slot.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// Of a point, for exactly equal ones the same; 0 and -0 are equal.
inline std::uint64_t position_hash(const Vec3& p) {
  std::uint64_t hash = 0;
  for (int k = 0; k < 3; ++k) hash = (hash ^ std::bit_cast<std::uint64_t>(p[k] + 0.0)) * 0x9e3779b97f4a7c15ULL;
  return hash;
}

/// Open addressing, at most half full. Finding is safe from many threads while nobody inserts.
class NumberTable {
 public:
  /// With room for so many numbers; it grows when there are more.
  explicit NumberTable(std::size_t numbers = 0) : slots_(std::bit_ceil(2 * numbers + 16), -1) {}

  /// The number with this hash value for which is_wanted(number) holds, -1 if there is none.
  template <typename IsWanted>
  Index find(std::uint64_t hash, const IsWanted& is_wanted) const {
    for (std::size_t s = home(hash);; s = (s + 1) & (slots_.size() - 1))
      if (slots_[s] < 0 || is_wanted(slots_[s])) return slots_[s];
  }

  /// Adds a number that is not in the table. hash_of(number): of any that is in it; asked when the table grows.
  template <typename HashOf>
  void insert(Index number, const HashOf& hash_of) {
    if (2 * size_ >= slots_.size()) grow(hash_of);
    place(number, hash_of(number));
    ++size_;
  }

  /// Forgets all numbers and keeps the room.
  void clear() {
    slots_.assign(slots_.size(), -1);
    size_ = 0;
  }

 private:
  std::size_t home(std::uint64_t hash) const {
    hash ^= hash >> 31;
    hash *= 0x9e3779b97f4a7c15ULL;  // Fibonacci hashing: the golden ratio spreads neighbouring keys
    return static_cast<std::size_t>(hash >> 20) & (slots_.size() - 1);
  }

  void place(Index number, std::uint64_t hash) {
    std::size_t s = home(hash);
    while (slots_[s] >= 0) s = (s + 1) & (slots_.size() - 1);
    slots_[s] = number;
  }

  template <typename HashOf>
  void grow(const HashOf& hash_of) {
    std::vector<Index> old(2 * slots_.size(), -1);
    old.swap(slots_);
    for (const Index number : old)
      if (number >= 0) place(number, hash_of(number));
  }

  std::vector<Index> slots_;  // a power of two
  std::size_t size_ = 0;
};

}  // namespace softreel
