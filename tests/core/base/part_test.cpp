/// The loader of parts where it fails; that parts load and throw is tested with the readers, bodies and pictures that
/// need them.
#include "core/base/part.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace softreel {
namespace {

/// The message of the error, which must be of kind Work.
std::string failure(const char* part, const char* symbol) {
  try {
    detail::part_symbol(part, symbol);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Work);
    return error.what();
  }
  ADD_FAILURE() << part << " has " << symbol;
  return {};
}

TEST(PartSymbol, NamesAMissingFileAndWhatHelps) {
  const std::string message = failure("flying_carpet", "fly");
  EXPECT_NE(message.find("softreel_part_flying_carpet.so: "), std::string::npos) << message;
  EXPECT_NE(message.find("No such file"), std::string::npos) << message;
  EXPECT_NE(message.find("../lib/softreel"), std::string::npos) << message;
}

#if SOFTREEL_LAZY_PARTS && SOFTREEL_WITH_ASSIMP

TEST(PartSymbol, NamesAMissingFunction) {
  const std::string message = failure("assimp", "fly");
  EXPECT_NE(message.find("undefined symbol: fly"), std::string::npos) << message;
}

TEST(PartSymbol, LoadsOnce) {
  void* first = detail::part_symbol("assimp", "softreel_read_with_assimp");
  EXPECT_NE(first, nullptr);
  EXPECT_EQ(detail::part_symbol("assimp", "softreel_read_with_assimp"), first);
}

#endif

}  // namespace
}  // namespace softreel
