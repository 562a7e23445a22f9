/// Whether the system was asked for huge pages, by what it says of the program's memory.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace softreel {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;

/// Whether the mapping that holds this address is one that is to have huge pages ("hg", proc(5)).
bool is_asked_for(const void* address) {
  const auto wanted = reinterpret_cast<std::uintptr_t>(address);
  std::ifstream maps("/proc/self/smaps");
  bool holds_it = false;
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t begin = 0, end = 0;
    char dash = 0;
    std::istringstream range(line);
    if (range >> std::hex >> begin >> dash >> end && dash == '-') holds_it = begin <= wanted && wanted < end;
    if (holds_it && line.starts_with("VmFlags:")) return (line + " ").find(" hg ") != std::string::npos;
  }
  return false;
}

TEST(HugePages, AreAskedForInLargeMemory) {
  if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage")) GTEST_SKIP() << "this system has none";
  const std::vector<char> large(8 * kHugePage);
  EXPECT_TRUE(is_asked_for(large.data() + large.size() / 2));
  struct alignas(64) Line {
    char bytes[64];
  };
  const std::vector<Line> lines(8 * kHugePage / sizeof(Line));
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(lines.data()) % 64, 0U);
  EXPECT_TRUE(is_asked_for(lines.data() + lines.size() / 2));
}

TEST(OperatorNew, SaysWhenThereIsNoMemory) {
  std::size_t bytes = SIZE_MAX / 2;
  const auto take = [&] { ::operator delete(::operator new(bytes)); };
  EXPECT_THROW(take(), std::bad_alloc);
  const auto take_aligned = [&] {
    ::operator delete (::operator new (bytes, std::align_val_t{64}), std::align_val_t{64});
  };
  EXPECT_THROW(take_aligned(), std::bad_alloc);
  for (bytes = SIZE_MAX; bytes > SIZE_MAX - 65; --bytes) EXPECT_THROW(take_aligned(), std::bad_alloc) << bytes;
}

}  // namespace
}  // namespace softreel
