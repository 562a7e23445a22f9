/// Checksums of files too large to be held: the same as hash_bytes of all their bytes.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "tool/cache/key.h"

namespace softreel {

/// XXH3-128 of bytes that come in parts.
class ByteHasher {
 public:
  ByteHasher();
  ~ByteHasher();

  void add(std::span<const std::uint8_t> bytes);
  /// Of all bytes so far.
  StageKey key() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Of a file's bytes, read in parts. Throws input_error if it cannot be read.
StageKey hash_file(const std::string& path);

}  // namespace softreel
