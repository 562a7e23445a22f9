/// Albedo tables that are made once for all materials that need the same, and kept from frame to frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>

#include "render/pathtrace/materials/bsdf.h"

namespace softreel {

/// Tables with the bits of AlbedoTables::of. Not thread-safe.
class AlbedoCache {
 public:
  /// Stay until drop_unused() drops them.
  const AlbedoTables& of(const Appearance& appearance);
  /// Drops what was not asked for since the last call: materials that change from frame to frame do not pile up.
  void drop_unused();
  std::size_t size() const { return tables_.size(); }

 private:
  /// Bits of all that tables depend on.
  using TopKey = std::array<std::uint32_t, 11>;
  struct Key {
    TopKey top;
    std::array<std::uint32_t, 4> base;
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  struct Entry {
    AlbedoTables tables;
    bool is_used = true;
  };

  static TopKey top_key(const Appearance& appearance);
  static Key key_of(const Appearance& appearance);
  AlbedoTables made(const Appearance& appearance, const TopKey& key);

  std::map<Key, Entry> tables_;
  std::map<TopKey, std::shared_ptr<const TopLayers>> tops_;  ///< one for all roughnesses of the base
};

}  // namespace softreel
