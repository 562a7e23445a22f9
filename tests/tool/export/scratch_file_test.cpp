// Scratch files give back what they were given and leave nothing behind.
#include "tool/export/scratch_file.h"

#include <filesystem>

#include "tests/tool/export/format_runs.h"

namespace softreel {
namespace {

TEST(ScratchFile, GivesBackAllBytesInPartsAndHasNoName) {
  const testing::TemporaryFolder folder;
  ScratchFile file(folder.path(""));
  std::string expected;
  for (int i = 0; i < 300000; ++i) expected += std::to_string(i);
  file.write(expected.substr(0, 1000));
  file.write(expected.substr(1000));
  EXPECT_EQ(file.size(), expected.size());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path("")));
  for (int time = 0; time < 2; ++time) {
    std::string read;
    std::size_t largest = 0;
    file.copy_to([&](std::span<const std::uint8_t> part) {
      read.append(reinterpret_cast<const char*>(part.data()), part.size());
      largest = std::max(largest, part.size());
    });
    EXPECT_EQ(read, expected);
    EXPECT_LE(largest, std::size_t{1} << 20);
  }
}

TEST(ScratchFile, NamesAFolderThatItCannotUse) {
  const std::string message = testing::error_of([] { ScratchFile file("/no/such/folder"); });
  EXPECT_NE(message.find("/no/such/folder"), std::string::npos);
  EXPECT_NE(message.find("--output"), std::string::npos);
}

}  // namespace
}  // namespace softreel
