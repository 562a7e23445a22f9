#include "tool/cache/cache.h"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tool/cache/atomic_file.h"
#include "tool/cache/bytes.h"
#include "tool/outputs/outputs.h"

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

Bytes stored_bytes(const Cache& cache, const std::string& stage, const StageKey& key) {
  const auto stored = cache.load(stage, key);
  EXPECT_TRUE(stored.has_value());
  return stored ? stored->bytes : Bytes{};
}

TEST(Cache, GivesBackWhatWasStored) {
  const Folder folder("cache");
  const Log log;
  const Cache cache(folder.path, Cache::Storing::Required, log);
  EXPECT_FALSE(cache.load("stage", "k").has_value());
  EXPECT_FALSE(cache.seconds("stage", "k").has_value());
  cache.store("stage", "k", {1, 2, 3}, 1.25);
  EXPECT_EQ(stored_bytes(cache, "stage", "k"), (Bytes{1, 2, 3}));
  EXPECT_EQ(cache.load("stage", "k")->seconds, 1.25);
  EXPECT_EQ(cache.seconds("stage", "k"), 1.25);
  cache.store("stage", "empty", {}, 0);
  EXPECT_EQ(stored_bytes(cache, "stage", "empty"), Bytes{});
}

TEST(Cache, NeverUsesAFileWithAnyFlippedBitOrCutAnywhere) {
  const Folder folder("damaged");
  const Log log;
  const Cache cache(folder.path, Cache::Storing::Required, log);
  cache.store("stage", "k", {10, 20, 30, 40}, 0.5);
  const std::string path = cache.path("stage", "k");
  const Bytes whole = read_file(path);
  const std::size_t magic = std::string_view("softreel cache 2 ").size();
  // The blanks and the line feed that part the header's words carry nothing.
  const std::set<std::size_t> parting{magic + 32, magic + 32 + 1 + 12};
  for (std::size_t byte = 0; byte < whole.size(); ++byte)
    for (int bit = 0; bit < 8; ++bit) {
      if (parting.count(byte) > 0) continue;
      Bytes flipped = whole;
      flipped[byte] = static_cast<std::uint8_t>(flipped[byte] ^ (1 << bit));
      write_file(path, flipped);
      EXPECT_FALSE(cache.load("stage", "k").has_value()) << byte << ":" << bit;
      EXPECT_FALSE(cache.damage("stage", "k").empty()) << byte << ":" << bit;
    }
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_file(path, std::span(whole).first(size));
    EXPECT_FALSE(cache.load("stage", "k").has_value()) << size;
  }
}

TEST(Cache, SaysADamagedFileOnceAndReplacesItEvenWhereAFolderStands) {
  const Folder folder("said");
  std::vector<std::string> warnings;
  const Log log{{}, [&](const std::string& line) { warnings.push_back(line); }};
  const Cache cache(folder.path, Cache::Storing::Required, log);
  fs::create_directories(cache.path("stage", "k") + "/inside");
  EXPECT_FALSE(cache.load("stage", "k").has_value());
  EXPECT_FALSE(cache.load("stage", "k").has_value());
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find(cache.path("stage", "k")), std::string::npos);
  cache.store("stage", "k", {7}, 0);
  EXPECT_EQ(stored_bytes(cache, "stage", "k"), Bytes{7});
}

TEST(Cache, OfSeveralThatWantAResultOneMakesIt) {
  const Folder folder("produce");
  const Log log;
  std::atomic<int> made{0}, waited{0};
  const auto want = [&] {
    const Cache cache(folder.path, Cache::Storing::Required, log);  // as another process would have
    const auto produced = cache.produce(
        "stage", "k", [&] { ++waited; },
        [&] {
          ++made;
          std::this_thread::sleep_for(std::chrono::milliseconds(50));
          return Bytes{1, 2};
        });
    EXPECT_EQ(produced.bytes, (Bytes{1, 2}));
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) threads.emplace_back(want);
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(made, 1);
  EXPECT_GT(waited, 0);
}

TEST(Cache, GoesOnWithoutStoringAfterOneWarningUnlessStoringIsTheTask) {
  const Folder folder("unwritable");
  write_file(folder.path + "/file", std::string("not a folder"));
  int warnings = 0;
  const Log log{{}, [&](const std::string&) { ++warnings; }};
  const Cache wanted(folder.path + "/file", Cache::Storing::Wanted, log);
  wanted.store("stage", "a", {1}, 0);
  wanted.store("stage", "b", {1}, 0);
  EXPECT_EQ(warnings, 1);
  const Cache required(folder.path + "/file", Cache::Storing::Required, log);
  EXPECT_THROW(required.store("stage", "a", {1}, 0), Error);
}

TEST(Cache, SaysThatItHoldsAnOlderFormatAndDoesNotReadIt) {
  const Folder folder("older");
  write_file(folder.path + "/simulation/" + std::string(32, 'a'), std::string("softreel cache 1\n"));
  int warnings = 0;
  const Log log{{}, [&](const std::string&) { ++warnings; }};
  const Cache cache(folder.path, Cache::Storing::Required, log);
  EXPECT_EQ(warnings, 1);
  EXPECT_FALSE(cache.load("simulation", std::string(32, 'a')).has_value());
  cache.store("simulation", "k", {1}, 0);
  const Cache again(folder.path, Cache::Storing::Required, log);
  EXPECT_EQ(warnings, 1) << "said again although the new format is in use";
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
    outputs.write(path, "key", std::vector<std::uint8_t>{1, 2}, 0.5);
  }
  const Outputs outputs(folder.path, "shot", log);
  EXPECT_TRUE(outputs.is_done(path, "key"));
  EXPECT_FALSE(outputs.is_done(path, "other"));
  EXPECT_EQ(outputs.state(path, "other"), OutputState::Stale);
  EXPECT_EQ(outputs.entry(path)->seconds, 0.5);
  write_file(path, std::string("x"));
  EXPECT_EQ(outputs.state(path, "key"), OutputState::Damaged);
  EXPECT_FALSE(outputs.is_done(path, "key"));
  fs::remove(path);
  EXPECT_EQ(outputs.state(path, "key"), OutputState::Missing);
  write_file(folder.path + "/shot.0002.png", std::string("x"));
  EXPECT_EQ(outputs.state(folder.path + "/shot.0002.png", "key"), OutputState::Unknown);
}

TEST(Outputs, RemoveNothingThatAnotherProcessHasJustMade) {
  const Folder folder("fresh");
  const Log log;
  const Bytes bytes{1};
  Outputs(folder.path, "shot", log).write(folder.path + "/shot.mp4", "old", bytes, 0);
  Outputs a(folder.path, "shot", log);
  const std::string picture = a.frame_path(1, "png"), movie = a.path("mp4");
  for (const std::string& path : {picture, movie}) {
    Outputs b(folder.path, "shot", log);
    a.write(path, "new", bytes, 0);
    EXPECT_NE(b.claimed_state(path, "new"), OutputState::Done);  // by what it read before
    EXPECT_EQ(b.remove_outdated({{path, "new"}}), 0);
    EXPECT_TRUE(a.is_done(path, "new")) << path;
    EXPECT_TRUE(b.is_done(path, "new")) << path;
  }
  a.write(picture, "newer", bytes, 0);
  EXPECT_EQ(a.remove_outdated({{picture, "new"}}), 1);
  EXPECT_FALSE(fs::exists(picture));
}

TEST(Outputs, ReadAgainKnowWhatAnotherProcessHasMadeOfOtherKeys) {
  const Folder folder("replaced");
  const Log log;
  const Bytes bytes{1};
  Outputs a(folder.path, "shot", log), b(folder.path, "shot", log);
  const std::string path = a.frame_path(1, "png");
  a.write(path, "mine", bytes, 0);
  b.write(path, "other", bytes, 0);
  EXPECT_EQ(a.entry(path)->key, "mine");
  a.read_again();
  EXPECT_EQ(a.entry(path)->key, "other");
  a.write(a.frame_path(2, "png"), "mine", bytes, 0);
  EXPECT_TRUE(Outputs(folder.path, "shot", log).is_done(path, "other")) << "what was read again is kept";
}

TEST(Outputs, RefuseNamesThatTheManifestCannotCarry) {
  const Folder folder("latin");
  const Log log;
  EXPECT_THROW(Outputs(folder.path, "b\xff", log), Error);
  EXPECT_THROW(Outputs(folder.path + "\xff", "shot", log), Error);
  Outputs outputs(folder.path, "shot", log);
  EXPECT_THROW(outputs.set_settings({{"mesh /s/\xff.obj", "key"}}), Error);
  EXPECT_THROW(outputs.set_settings({{"shot", "mesh = \"\xff\""}}), Error);
}

TEST(Outputs, OfSeveralProcessesKeepEachOthersEntries) {
  const Folder folder("merged");
  const Log log;
  Outputs a(folder.path, "shot", log), b(folder.path, "shot", log);
  const Bytes bytes{1};
  for (int frame = 1; frame <= 4; ++frame) {
    Outputs& writer = frame % 2 == 0 ? a : b;
    writer.write(writer.frame_path(frame, "png"), "key", bytes, 0);
  }
  const Outputs all(folder.path, "shot", log);
  for (int frame = 1; frame <= 4; ++frame) EXPECT_TRUE(all.is_done(all.frame_path(frame, "png"), "key")) << frame;
}

}  // namespace
}  // namespace softreel
