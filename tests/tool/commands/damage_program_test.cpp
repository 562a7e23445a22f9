/// Files of the cache and of the output that are cut, flipped or swapped are said, made again, and never used.
#include <filesystem>
#include <functional>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tool/commands/survival.h"

namespace softreel {
namespace {

using namespace softreel::testing;
namespace fs = std::filesystem;

constexpr const char* kDamageFrames = "--set shot.frames=[1,8]";

using Random = std::mt19937_64;

/// Any number below `size`.
std::size_t below(std::size_t size, Random& random) {
  return std::uniform_int_distribution<std::size_t>(0, size - 1)(random);
}

std::string flipped(std::string bytes, std::size_t at) {
  bytes[at] = static_cast<char>(bytes[at] ^ 16);
  return bytes;
}

/// What becomes of a file's bytes; `other` are those of another file of the same folder.
struct Damage {
  const char* name;
  std::function<std::string(const std::string& bytes, const std::string& other, Random& random)> apply;
};

const std::vector<Damage> kDamages = {
    {"emptied", [](const auto&, const auto&, Random&) { return std::string(); }},
    {"cut to a byte", [](const auto& bytes, const auto&, Random&) { return bytes.substr(0, 1); }},
    {"cut in its header", [](const auto& bytes, const auto&, Random&) { return bytes.substr(0, 20); }},
    {"cut to half", [](const auto& bytes, const auto&, Random&) { return bytes.substr(0, bytes.size() / 2); }},
    {"cut by a byte", [](const auto& bytes, const auto&, Random&) { return bytes.substr(0, bytes.size() - 1); }},
    {"longer by a byte", [](const auto& bytes, const auto&, Random&) { return bytes + "x"; }},
    {"flipped in its header",
     [](const auto& bytes, const auto&, Random& r) {
       return flipped(bytes, below(std::min<std::size_t>(bytes.size(), 40), r));
     }},
    {"flipped", [](const auto& bytes, const auto&, Random& r) { return flipped(bytes, below(bytes.size(), r)); }},
    {"swapped", [](const auto&, const auto& other, Random&) { return other; }},
    {"zeroed", [](const auto& bytes, const auto&, Random&) { return std::string(bytes.size(), 0); }},
};

/// Files that hold something, for a lock may be empty.
std::vector<std::string> filled_files(const std::string& folder) {
  std::vector<std::string> names = files_under(folder);
  std::erase_if(names, [&](const std::string& name) { return fs::file_size(folder + "/" + name) < 100; });
  return names;
}

class DamageTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = shot_folder("damage");
    make_sound();
    render_in_peace(folder_, folder_ + "/exported",
                    fmt::format("--cache {}/sound/cache --format obj {}", folder_, options_), "export");
  }

  void make_sound() const {
    render_in_peace(folder_, folder_ + "/sound/out", fmt::format("--cache {}/sound/cache {}", folder_, options_));
  }

  /// A copy of the sound output and cache; hard links stay such.
  std::string work_folder() const {
    const std::string work = new_folder("damage_work");
    EXPECT_EQ(run(fmt::format("cp -a {}/sound/. {}/", folder_, work)).status, 0);
    return work;
  }

  Outcome render(const std::string& work, const std::string& output) const {
    return run_abused(fmt::format("render {0}/shot.toml --output {1}/{2} --cache {1}/cache --quiet {3}", folder_, work,
                                  output, options_),
                      {});
  }

  Outcome export_meshes(const std::string& work) const {
    return run_abused(
        fmt::format("export {0}/shot.toml --output {1}/exported --cache {1}/cache --quiet --format obj {2}", folder_,
                    work, options_),
        {});
  }

  /// A rendering into an empty folder and an export, which together need all that is kept. Returns what they say of
  /// `path`, each at most a line.
  int times_said_while_all_is_made_equal(const std::string& work, const std::string& path) const {
    const Outcome pictures = render(work, "new"), meshes = export_meshes(work);
    EXPECT_EQ(pictures.status, 0) << pictures.err;
    EXPECT_EQ(meshes.status, 0) << meshes.err;
    expect_equal_final_files(folder_ + "/sound/out", work + "/new");
    expect_equal_final_files(folder_ + "/exported", work + "/exported");
    const auto once = lines_with(pictures.err, path), twice = lines_with(meshes.err, path);
    EXPECT_LE(once.size(), 1U) << pictures.err;
    EXPECT_LE(twice.size(), 1U) << meshes.err;
    return static_cast<int>(once.size() + twice.size());
  }

  /// After the file `path` of an output was damaged: said once, and everything is as it was. The cache may hold the
  /// same file by another name, which is said too.
  void expect_said_and_mended(const std::string& work, const std::string& path, std::size_t names = 1) const {
    const Outcome outcome = render(work, "out");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(lines_with(outcome.err, path).size(), 1U) << outcome.err;
    EXPECT_LE(lines_with(outcome.err, "warning: ").size(), names) << outcome.err;
    expect_equal_final_files(folder_ + "/sound/out", work + "/out");
  }

  /// Writes into the file that is there, which all its names see, or puts another under its name.
  static void replace(const std::string& path, const std::string& bytes, bool in_place) {
    if (!in_place) fs::remove(path);
    write_text(path, bytes);
  }

  std::string folder_, options_ = kDamageFrames;
};

TEST_F(DamageTest, OfACacheFileIsSaidAndMended) {
  Random random(11);
  const std::string sound = folder_ + "/sound/cache";
  const auto names = filled_files(sound);
  ASSERT_GT(names.size(), 8U);
  int mended = 0;
  constexpr int kRounds = 40;
  for (int round = 0; round < kRounds; ++round) {
    const Damage& damage = kDamages[static_cast<std::size_t>(round) % kDamages.size()];
    const std::string name = names[below(names.size(), random)], other = names[below(names.size(), random)];
    const std::string bytes = read_text(sound + "/" + name);
    const std::string damaged = damage.apply(bytes, read_text(sound + "/" + other), random);
    if (damaged == bytes) continue;  // swapped with its like
    const std::string work = work_folder(), path = work + "/cache/" + name;
    replace(path, damaged, round % 2 == 0);
    SCOPED_TRACE(fmt::format("round {}: {} {} (with {})", round, name, damage.name, other));
    const int said = times_said_while_all_is_made_equal(work, path);
    if (read_text(path) == damaged) continue;  // nothing needed it
    EXPECT_EQ(said, 1);
    EXPECT_TRUE(stored_content(path) == stored_content(sound + "/" + name));
    ++mended;
  }
  EXPECT_GE(mended, kRounds / 4) << "too few damaged files were needed to test anything";
}

TEST_F(DamageTest, OfAllCacheFilesAtOnceIsMended) {
  Random random(12);
  const std::string work = work_folder();
  for (const std::string& name : filled_files(work + "/cache")) {
    const std::string path = work + "/cache/" + name, bytes = read_text(path);
    replace(path, kDamages[below(kDamages.size(), random)].apply(bytes, bytes + "y", random), false);
  }
  times_said_while_all_is_made_equal(work, work + "/no such file");
}

TEST_F(DamageTest, AFolderInPlaceOfACacheFileStopsNothing) {
  Random random(13);
  const auto names = filled_files(folder_ + "/sound/cache");
  for (int round = 0; round < 5; ++round) {
    const std::string work = work_folder(), path = work + "/cache/" + names[below(names.size(), random)];
    SCOPED_TRACE(path);
    fs::remove(path);
    fs::create_directories(path + "/inside");
    times_said_while_all_is_made_equal(work, path);
  }
}

/// A picture must not be said twice, once when it is looked for and once when its equal is.
TEST_F(DamageTest, OfAPictureOrMovieIsSaidAndMended) {
  Random random(14);
  options_ += " --set output.movie=true";
  make_sound();
  std::vector<std::string> names = final_files(folder_ + "/sound/out");
  std::erase_if(names, [](const std::string& name) { return name.ends_with(".json"); });
  ASSERT_EQ(names.size(), 9U);
  for (int round = 0; round < 20; ++round) {
    const Damage& damage = kDamages[static_cast<std::size_t>(round) % kDamages.size()];
    const std::string work = work_folder(), name = names[below(names.size(), random)], path = work + "/out/" + name;
    const std::string bytes = read_text(path), other = read_text(work + "/out/" + names[below(names.size(), random)]);
    const std::string damaged = damage.apply(bytes, other, random);
    if (damaged == bytes) continue;
    SCOPED_TRACE(fmt::format("round {}: {} {}", round, name, damage.name));
    const auto names_of_file = static_cast<std::size_t>(fs::hard_link_count(path));
    const bool in_place = round % 2 == 0;
    replace(path, damaged, in_place);
    expect_said_and_mended(work, path, in_place ? names_of_file : 1);
  }
}

TEST_F(DamageTest, OfAManifestIsSaidAndMended) {
  const std::string manifest = read_text(folder_ + "/sound/out/ball.manifest.json");
  const std::vector<std::string> damaged = {"",
                                            "\n",
                                            "garbage",
                                            std::string("\0\xff\x80", 3),
                                            "{}",
                                            "[]",
                                            "7",
                                            R"({"format":1,"shot":"ball","files":[1]})",
                                            R"({"format":1,"shot":"ball","files":{"ball.0001.png":7}})",
                                            manifest.substr(0, manifest.size() / 2)};
  for (const std::string& text : damaged) {
    const std::string work = work_folder(), path = work + "/out/ball.manifest.json";
    SCOPED_TRACE(text);
    write_text(path, text);
    expect_said_and_mended(work, path);
  }
}

}  // namespace
}  // namespace softreel
