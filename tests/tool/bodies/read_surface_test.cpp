#include "tool/bodies/read_surface.h"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tool/cache/stage_names.h"

namespace softreel {
namespace {
namespace fs = std::filesystem;

/// A folder with a mesh file and a cache.
class ReadSurfaceTest : public ::testing::Test {
 protected:
  ReadSurfaceTest() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ReadSurfaceTest() override { fs::remove_all(folder_); }

  /// A closed box, the first corner moved by `bump`; with a face of two corners, which reading warns of, one face
  /// twice, groups, texture coordinates, and as many bytes of comments.
  std::string write_box(std::size_t comment, double bump = 0) const {
    const std::string path = (folder_ / "box.obj").string();
    std::ofstream file(path);
    for (int k = 0; k < 8; ++k) file << fmt::format("v {} {} {}\n", k == 0 ? bump : k & 1, k >> 1 & 1, k >> 2);
    file << "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\ng front\nf 1/1 3/2 4/3 2/4\nf 1/1 3/2 4/3 2/4\nf 5 6 8 7\ng rest\n"
            "f 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\nf 1 2\n";
    for (std::size_t written = 0; written < comment; written += 100) file << "#" << std::string(98, '-') << "\n";
    return path;
  }

  struct Reading {
    ReadSurface surface;
    std::vector<std::string> said;
  };
  Reading read(const std::string& path, SurfaceUse use) const {
    Reading reading;
    const Log log{[&](const std::string& line) { reading.said.push_back("info: " + line); },
                  [&](const std::string& line) { reading.said.push_back("warning: " + line); }};
    const Threads threads(1);
    StageTimes times;
    const std::atomic<bool> never{false};
    const Cache cache((folder_ / "cache").string(), Cache::Storing::Required, log);
    reading.surface = read_surface(path, use, {threads, log, times, cache, never});
    return reading;
  }
  bool is_stored(const StageKey& key) const {
    const Log silent;
    return Cache((folder_ / "cache").string(), Cache::Storing::Required, silent).has(kSurfaceStage, key);
  }

  static constexpr std::size_t kMegabyte = 1100000;
  fs::path folder_ = fs::temp_directory_path() / fmt::format("softreel_read_surface_{}", ::getpid());
};

TEST_F(ReadSurfaceTest, DoesNotTakeAFileThatChangesMeanwhileForTheOldOne) {
  const Log silent;
  const Cache cache((folder_ / "cache").string(), Cache::Storing::Required, silent);
  const std::string path = write_box(kMegabyte);
  const StageKey old_key = read(path, SurfaceUse::LookUp).surface.stored;
  std::string error;
  // The reader is to wait before the file changes; on a machine where it comes too late, it has more time.
  for (int wait = 100; error.empty() && wait < 10000; wait *= 2) {
    write_box(kMegabyte);
    auto claim = cache.try_claim(kSurfaceStage, old_key);  // as another program does that is reading it
    ASSERT_TRUE(claim);
    std::thread reader([&] {
      try {
        read(path, SurfaceUse::Keep);
      } catch (const Error& problem) {
        error = problem.what();
      }
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(wait));
    write_box(kMegabyte, 0.25);
    claim.reset();
    reader.join();
  }
  EXPECT_NE(error.find("changed while it was being read"), std::string::npos) << error;
  write_box(kMegabyte);
  EXPECT_EQ(read(path, SurfaceUse::Keep).surface.mesh.positions.front(), Vec3(0, 0, 0));
}

TEST_F(ReadSurfaceTest, SaysAndGivesTheSameFromTheCacheAsFromTheFile) {
  const std::string path = write_box(kMegabyte);
  const Reading first = read(path, SurfaceUse::Keep);
  ASSERT_TRUE(is_stored(first.surface.stored));
  EXPECT_FALSE(first.said.empty()) << "of the face with two corners";
  for (const SurfaceUse use : {SurfaceUse::Keep, SurfaceUse::LookUp}) {
    const Reading again = read(path, use);
    EXPECT_EQ(again.said, first.said);
    EXPECT_EQ(again.surface.facts, first.surface.facts);
    EXPECT_EQ(again.surface.key, first.surface.key);
    EXPECT_EQ(again.surface.stored, first.surface.stored);
    const SurfaceMesh &a = again.surface.mesh, &b = first.surface.mesh;
    EXPECT_EQ(mesh_file_key(a), mesh_file_key(b));
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.triangle_polygon, b.triangle_polygon);
    EXPECT_EQ(a.triangle_textures, b.triangle_textures);
    EXPECT_EQ(a.joined, b.joined);
    ASSERT_EQ(a.groups.size(), 2U);
    EXPECT_EQ(a.groups[1].name, "rest");
  }
}

TEST_F(ReadSurfaceTest, IsReadAnewWhenItsFileChangesOrItsCacheFileIsDamaged) {
  const std::string path = write_box(kMegabyte);
  const Reading first = read(path, SurfaceUse::Keep);
  write_box(kMegabyte, -0.25);
  const Reading changed = read(path, SurfaceUse::Keep);
  EXPECT_NE(changed.surface.stored, first.surface.stored);
  EXPECT_EQ(changed.surface.mesh.positions[0].x(), -0.25);
  const Log silent;
  const std::string stored =
      Cache((folder_ / "cache").string(), Cache::Storing::Required, silent).path(kSurfaceStage, changed.surface.stored);
  fs::resize_file(stored, fs::file_size(stored) - 1);
  const Reading mended = read(path, SurfaceUse::Keep);
  EXPECT_EQ(mended.surface.key, changed.surface.key);
  EXPECT_EQ(mended.said.size(), changed.said.size() + 1) << "the damage is said";
}

TEST_F(ReadSurfaceTest, LeavesNothingOfSmallFilesAndOfCommandsThatOnlyLook) {
  read(write_box(kMegabyte), SurfaceUse::LookUp);
  EXPECT_FALSE(fs::exists(folder_ / "cache"));
  EXPECT_TRUE(read(write_box(1000), SurfaceUse::Keep).surface.stored.empty());
  EXPECT_FALSE(fs::exists(folder_ / "cache"));
}

}  // namespace
}  // namespace softreel
