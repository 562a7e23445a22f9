/// Dense numbers for sparse 64-bit keys: the one hash table of the lattices and grids.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// Numbers keys 0, 1, 2 ... in the order of their first insertion; open addressing, at most half full. Finding is safe
/// from many threads while nobody inserts.
class KeyIndex {
 public:
  KeyIndex() : slots_(16) {}

  /// Number of a key, -1 if it was never inserted.
  Index find(std::uint64_t key) const {
    for (std::size_t s = home(key);; s = (s + 1) & (slots_.size() - 1)) {
      if (slots_[s].number < 0 || slots_[s].key == key) return slots_[s].number;
    }
  }

  /// Number of a key, and whether it is new.
  std::pair<Index, bool> insert(std::uint64_t key) {
    if (2 * static_cast<std::size_t>(size_) >= slots_.size()) grow();
    for (std::size_t s = home(key);; s = (s + 1) & (slots_.size() - 1)) {
      if (slots_[s].number < 0) {
        slots_[s] = {key, size_};
        return {size_++, true};
      }
      if (slots_[s].key == key) return {slots_[s].number, false};
    }
  }

  Index size() const { return size_; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    Index number = -1;
  };

  std::size_t home(std::uint64_t key) const {
    key ^= key >> 31;
    key *= 0x9e3779b97f4a7c15ULL;  // Fibonacci hashing: the golden ratio spreads neighbouring keys
    return static_cast<std::size_t>(key >> 20) & (slots_.size() - 1);
  }

  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.number < 0) continue;
      std::size_t s = home(slot.key);
      while (slots_[s].number >= 0) s = (s + 1) & (slots_.size() - 1);
      slots_[s] = slot;
    }
  }

  std::vector<Slot> slots_;  // a power of two
  Index size_ = 0;
};

}  // namespace softreel
