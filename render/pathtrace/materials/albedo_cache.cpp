#include "render/pathtrace/materials/albedo_cache.h"

#include <bit>

namespace softreel {

namespace {

std::uint32_t bits(float value) {
  return std::bit_cast<std::uint32_t>(value);
}

}  // namespace

/// Zeros without layers; with them, all that TopLayers keeps.
AlbedoCache::TopKey AlbedoCache::top_key(const Appearance& a) {
  if (!TopLayers::has_any(a)) return {};
  const Vec3f &coat = a.coat_color, &sheen = a.sheen_color;
  return {bits(a.coat),  bits(a.coat_roughness),  bits(a.coat_ior), bits(coat.x()),  bits(coat.y()), bits(coat.z()),
          bits(a.sheen), bits(a.sheen_roughness), bits(sheen.x()),  bits(sheen.y()), bits(sheen.z())};
}

AlbedoCache::Key AlbedoCache::key_of(const Appearance& appearance) {
  const bool reflects = AlbedoTables::has_reflection(appearance), glass = AlbedoTables::has_glass(appearance);
  const float roughness = reflects ? appearance.roughness : 0.0f, ior = glass ? appearance.ior : 0.0f;
  return {top_key(appearance), {bits(roughness), bits(ior), reflects ? 1u : 0u, glass ? 1u : 0u}};
}

AlbedoTables AlbedoCache::made(const Appearance& appearance, const TopKey& key) {
  std::shared_ptr<const TopLayers>& top = tops_[key];
  if (!top) top = TopLayers::make(appearance);
  return AlbedoTables::of(appearance, top);
}

const AlbedoTables& AlbedoCache::of(const Appearance& appearance) {
  const Key key = key_of(appearance);
  auto found = tables_.find(key);
  if (found == tables_.end()) found = tables_.emplace(key, Entry{made(appearance, key.top)}).first;
  found->second.is_used = true;
  return found->second.tables;
}

void AlbedoCache::drop_unused() {
  std::erase_if(tables_, [](const auto& kept) { return !kept.second.is_used; });
  std::erase_if(tops_, [](const auto& kept) { return kept.second.use_count() <= 1; });
  for (auto& kept : tables_) kept.second.is_used = false;
}

}  // namespace softreel
