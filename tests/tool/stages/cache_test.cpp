#include "tool/stages/cache.h"

#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tool/stages/atomic_file.h"
#include "tool/stages/bytes.h"
#include "tool/stages/outputs.h"

namespace softreel {
namespace {
namespace fs = std::filesystem;

/// A folder of the test's own, removed at its end.
struct Folder {
  explicit Folder(const std::string& name)
      : path((fs::temp_directory_path() / fmt::format("softreel_{}_{}", name, ::getpid())).string()) {
    fs::remove_all(path);
  }
  ~Folder() { fs::remove_all(path); }
  std::string path;
};

TEST(KeyHasher, ChangesWithEveryValueAndWithTheirOrder) {
  const auto key = [](double a, double b) { return KeyHasher("test").add(a).add(b).key(); };
  EXPECT_EQ(key(1, 2), key(1, 2));
  EXPECT_NE(key(1, 2), key(2, 1));
  EXPECT_NE(key(1, 2), key(1, 2.0000000000000004));
  EXPECT_EQ(key(0.0, 1), key(-0.0, 1)) << "an edit from 0 to -0 changes no value";
  EXPECT_NE(KeyHasher("a").add("bc").key(), KeyHasher("ab").add("c").key()) << "texts must not run together";
  EXPECT_NE(KeyHasher("t").add(std::vector<int>{1}).add(std::vector<int>{}).key(),
            KeyHasher("t").add(std::vector<int>{}).add(std::vector<int>{1}).key());
}

TEST(Bytes, ComeBackAsTheyWentIn) {
  ByteWriter out;
  out.put(1.5);
  out.put_array(std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  out.put_array(std::vector<Index>{});
  const std::vector<std::uint8_t> bytes = out.take();
  ByteReader in(bytes);
  EXPECT_EQ(in.get<double>(), 1.5);
  const auto vectors = in.get_array<Vec3>();
  ASSERT_EQ(vectors.size(), 2U);
  EXPECT_EQ(vectors[1], Vec3(4, 5, 6));
  EXPECT_TRUE(in.get_array<Index>().empty());
  EXPECT_THROW(in.get<double>(), Error);
}

TEST(Bytes, ALengthBeyondTheEndIsAnErrorNotAnAllocation) {
  ByteWriter out;
  out.put(std::uint64_t{1} << 60);
  const std::vector<std::uint8_t> bytes = out.take();
  EXPECT_THROW(ByteReader(bytes).get_array<double>(), Error);
}

TEST(Cache, GivesBackWhatWasStored) {
  const Folder folder("cache");
  const Log log;
  const Cache cache(folder.path, log);
  EXPECT_FALSE(cache.load("stage", "k").has_value());
  cache.store("stage", "k", {1, 2, 3});
  EXPECT_EQ(cache.load("stage", "k"), (std::vector<std::uint8_t>{1, 2, 3}));
  cache.store("stage", "empty", {});
  EXPECT_EQ(cache.load("stage", "empty"), std::vector<std::uint8_t>{});
}

TEST(Cache, NeverUsesAFileWithAnyFlippedBitOrCutAnywhere) {
  const Folder folder("damaged");
  int warnings = 0;
  const Log log{{}, [&](const std::string&) { ++warnings; }};
  const Cache cache(folder.path, log);
  cache.store("stage", "k", {10, 20, 30, 40});
  const std::string path = folder.path + "/stage/k";
  const std::vector<std::uint8_t> whole = read_file(path);
  int tried = 0;
  for (std::size_t byte = 0; byte < whole.size(); ++byte)
    for (int bit = 0; bit < 8; ++bit, ++tried) {
      std::vector<std::uint8_t> flipped = whole;
      flipped[byte] = static_cast<std::uint8_t>(flipped[byte] ^ (1 << bit));
      write_file(path, flipped);
      const auto loaded = cache.load("stage", "k");
      // The line feed that ends the checksum carries nothing.
      if (byte + 1 == whole.size() - 4) continue;
      EXPECT_FALSE(loaded.has_value()) << byte << ":" << bit;
    }
  for (std::size_t size = 0; size < whole.size(); ++size, ++tried) {
    write_file(path, std::span(whole).first(size));
    EXPECT_FALSE(cache.load("stage", "k").has_value()) << size;
  }
  EXPECT_GE(warnings, tried - 8);
}

TEST(AtomicFile, LeavesNothingWithoutCommitAndKeepsTheOldFile) {
  const Folder folder("atomic");
  const std::string path = folder.path + "/a/b.txt";
  write_file(path, std::string("old"));
  {
    AtomicFile file(path);
    file.write(std::vector<std::uint8_t>{1, 2, 3});
  }
  EXPECT_EQ(read_file(path), (std::vector<std::uint8_t>{'o', 'l', 'd'}));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path + "/a"), fs::directory_iterator{}), 1);
}

TEST(Outputs, CountAFileAsDoneOnlyWhileItIsWholeAndOfTheSameKey) {
  const Folder folder("outputs");
  const Log log;
  const std::string path = folder.path + "/shot.0001.png";
  {
    Outputs outputs(folder.path, "shot", log);
    EXPECT_EQ(outputs.frame_path(1, "png"), path);
    outputs.write(path, "key", std::vector<std::uint8_t>{1, 2});
  }
  const Outputs outputs(folder.path, "shot", log);
  EXPECT_TRUE(outputs.is_done(path, "key"));
  EXPECT_FALSE(outputs.is_done(path, "other"));
  EXPECT_EQ(outputs.find_equal("key"), (std::vector<std::uint8_t>{1, 2}));
  write_file(path, std::string("x"));
  EXPECT_FALSE(outputs.is_done(path, "key"));
  fs::remove(path);
  EXPECT_FALSE(outputs.is_done(path, "key"));
  EXPECT_FALSE(outputs.find_equal("key").has_value());
}

}  // namespace
}  // namespace softreel
