#include "tool/cache/byte_hasher.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>

#include <fmt/format.h>
#include <xxhash.h>

#include "core/base/error.h"

namespace softreel {

struct ByteHasher::State {
  State() : hash(XXH3_createState()) {
    if (hash == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(hash);
  }
  ~State() { XXH3_freeState(hash); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  XXH3_state_t* hash;
};

ByteHasher::ByteHasher() : state_(std::make_unique<State>()) {}
ByteHasher::~ByteHasher() = default;

void ByteHasher::add(std::span<const std::uint8_t> bytes) {
  XXH3_128bits_update(state_->hash, bytes.data(), bytes.size());
}

StageKey ByteHasher::key() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->hash);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

StageKey hash_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path))
    throw input_error(fmt::format("{}: cannot be read: {}.\n  Accepted: a readable file. Check the path.", path,
                                  in ? "it is a folder" : std::strerror(errno)));
  ByteHasher hasher;
  std::vector<char> part(1 << 20);
  while (in) {
    in.read(part.data(), static_cast<std::streamsize>(part.size()));
    hasher.add({reinterpret_cast<const std::uint8_t*>(part.data()), static_cast<std::size_t>(in.gcount())});
  }
  if (in.bad()) throw input_error(fmt::format("{}: cannot be read to its end.", path));
  return hasher.key();
}

}  // namespace softreel
