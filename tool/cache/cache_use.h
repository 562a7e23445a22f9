/// Who needs what of a cache, so that it can be cut to a size or cleaned without touching what a running job needs.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "tool/cache/cache.h"

namespace softreel {

/// "STAGE/KEY"
using CacheItem = std::string;

inline CacheItem cache_item(const std::string& stage, const StageKey& key) {
  return stage + "/" + key;
}

/// A running job's claim on the items it will read or write. While the object lives nobody removes them; afterwards
/// they are remembered as what the owner (a shot in an output folder) was last made of, for clean_cache.
class CacheUse {
 public:
  /// `owner`: path of the shot, and its output folder. Nothing is written where the cache cannot be written.
  CacheUse(const Cache& cache, const std::string& shot_path, const std::string& output_folder);
  ~CacheUse();
  CacheUse(const CacheUse&) = delete;
  CacheUse& operator=(const CacheUse&) = delete;

  void claim(const std::vector<CacheItem>& items);
  /// The running job is done with an item: it may go if space is needed.
  void release(const CacheItem& item);

  static std::string owner_id(const std::string& shot_path, const std::string& output_folder);

 private:
  void append(const std::string& lines);

  const Cache& cache_;
  std::string owner_, path_;
  int descriptor_ = -1;
};

struct CacheRemoval {
  std::int64_t files = 0;
  double bytes = 0;
  std::string problem;  ///< the first file that could not be removed, and why; empty if there was none
};

/// Bytes in a cache that removing its files would free (finished files that outputs link to are not counted).
double cache_size(const Cache& cache);

/// Removes the results that were used longest ago until at most `limit` bytes are left; what running jobs claim stays,
/// even if that is more. `dry_run`: only counts.
CacheRemoval cut_cache(const Cache& cache, double limit, bool dry_run = false);

/// Removes what neither `kept`, nor a running job, nor another shot that still exists needs: results of older versions
/// of the owner's shot, older formats, and what killed processes left. `dry_run`: only counts.
CacheRemoval clean_cache(const Cache& cache, const std::string& owner_id, const std::vector<CacheItem>& kept,
                         bool dry_run);

/// Removes everything that no running job claims.
CacheRemoval empty_cache(const Cache& cache, bool dry_run);

}  // namespace softreel
