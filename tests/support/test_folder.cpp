#include "tests/support/test_folder.h"

#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace softreel::testing {
namespace fs = std::filesystem;
namespace {

fs::path own_folder() {
  return fs::temp_directory_path() / ("softreel_test_" + std::to_string(::getpid()));
}

class FolderRemoval : public ::testing::Environment {
 public:
  void TearDown() override {
    std::error_code none;
    if (::testing::UnitTest::GetInstance()->Passed()) fs::remove_all(own_folder(), none);
  }
};
const ::testing::Environment* const kFolderRemoval = ::testing::AddGlobalTestEnvironment(new FolderRemoval);

}  // namespace

fs::path test_folder() {
  const fs::path folder = own_folder();
  fs::create_directories(folder);
  return folder;
}

}  // namespace softreel::testing
