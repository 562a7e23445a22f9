#include "tool/batch/machine.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace softreel {
namespace {
namespace fs = std::filesystem;

/// Two nested control groups as files.
class ControlGroups : public ::testing::Test {
 protected:
  ControlGroups() {
    fs::create_directories(root_ / "slice/job");
    write("membership", "1:cpu:/elsewhere\n0::/slice/job\n");
  }
  ~ControlGroups() override { fs::remove_all(root_); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(root_ / name) << text; }
  double left() const { return left_by_control_groups((root_ / "membership").string(), root_.string()); }

  fs::path root_ = fs::temp_directory_path() / fmt::format("softreel_groups_{}", ::getpid());
};

TEST_F(ControlGroups, WithoutALimitLeaveAll) {
  EXPECT_TRUE(std::isinf(left()));
  write("slice/job/memory.max", "max\n");
  write("slice/job/memory.current", "1000\n");
  EXPECT_TRUE(std::isinf(left()));
}

TEST_F(ControlGroups, CountFilesInMemoryAsFree) {
  write("slice/job/memory.max", "1000\n");
  write("slice/job/memory.current", "1000\n");
  EXPECT_EQ(left(), 0);
  write("slice/job/memory.stat", "anon 150\nfile 850\nkernel 0\ninactive_file 600\nactive_file 250\n");
  EXPECT_EQ(left(), 850);
}

TEST_F(ControlGroups, LeaveWhatTheTightestOneLeaves) {
  write("slice/job/memory.max", "1000\n");
  write("slice/job/memory.current", "200\n");
  write("slice/memory.max", "1500\n");
  write("slice/memory.current", "1100\n");
  EXPECT_EQ(left(), 400);
}

TEST_F(ControlGroups, OfVersion1HaveFilesAndPathsOfTheirOwn) {
  fs::create_directories(root_ / "memory/batch/job");
  write("membership", "4:cpu,memory:/batch/job\n3:cpuset:/elsewhere\n0::/slice/job\n");
  write("memory/batch/job/memory.limit_in_bytes", "9223372036854771712\n");
  write("memory/batch/job/memory.usage_in_bytes", "1000\n");
  EXPECT_TRUE(std::isinf(left()));
  write("memory/batch/memory.limit_in_bytes", "2000\n");
  write("memory/batch/memory.usage_in_bytes", "1500\n");
  write("memory/batch/memory.stat", "inactive_file 1\ntotal_inactive_file 200\ntotal_active_file 100\n");
  EXPECT_EQ(left(), 800);
  write("slice/job/memory.max", "1000\n");
  write("slice/job/memory.current", "300\n");
  EXPECT_EQ(left(), 700) << "the tighter of both versions";
}

TEST_F(ControlGroups, OfVersion1InAContainerAreFoundAtTheRoot) {
  fs::create_directories(root_ / "memory");
  write("membership", "4:memory:/docker/0123\n");
  write("memory/memory.limit_in_bytes", "2000\n");
  write("memory/memory.usage_in_bytes", "500\n");
  EXPECT_EQ(left(), 1500);
}

TEST(AvailableMemory, IsSaidByThisSystem) {
  EXPECT_GT(available_memory(), 0);
  EXPECT_TRUE(std::isfinite(available_memory()));
}

}  // namespace
}  // namespace softreel
