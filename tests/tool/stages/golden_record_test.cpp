#include "tool/stages/golden_record.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tool/cache/base64.h"
#include "tool/report/golden_page.h"
#include "tool/stages/sheet_stage.h"

namespace softreel {
namespace {

std::string text_base64(const std::string& text) {
  return base64(std::vector<std::uint8_t>(text.begin(), text.end()));
}

TEST(Base64, GivesTheExamplesOfTheStandardAndTheBytesBack) {
  EXPECT_EQ(text_base64(""), "");
  EXPECT_EQ(text_base64("f"), "Zg==");
  EXPECT_EQ(text_base64("fo"), "Zm8=");
  EXPECT_EQ(text_base64("foo"), "Zm9v");
  EXPECT_EQ(text_base64("foobar"), "Zm9vYmFy");
  std::vector<std::uint8_t> bytes;
  for (int k = 0; k < 256; ++k) {
    EXPECT_EQ(from_base64(base64(bytes)), bytes);
    bytes.push_back(static_cast<std::uint8_t>(k));
  }
  EXPECT_THROW(from_base64("Zg="), Error);
  EXPECT_THROW(from_base64("Z!=="), Error);
}

GoldenGeometry triangle(float shift) {
  return {{"blob", {3, shift == 0 ? "a" : "b", {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(0, 1 + shift, 0)}}}};
}

SettingsSnapshot settings(const std::string& shot) {
  return {{"shot", shot}, {"unset", "[render]\nsamples = 16\nnovel = 1\n"}};
}

TEST(FindCause, NamesTheFarthestMove) {
  const GoldenRecord record{settings("[render]\nsamples = 8\n"), {{7, triangle(0)}}};
  const GoldenCause cause = find_cause(record, 7, record.settings, triangle(0.0012f));
  EXPECT_FALSE(cause.same_geometry);
  EXPECT_NE(cause.words.find("of all 3 vertices is 1.2 mm ('blob' vertex 2)"), std::string::npos) << cause.words;
  EXPECT_NE(cause.words.find("the shot says the same"), std::string::npos) << cause.words;
}

TEST(FindCause, TellsBodiesThatCameOrWentAndOtherMeshes) {
  const GoldenRecord record{settings(""), {{7, triangle(0)}}};
  GoldenGeometry more = triangle(0);
  more["second"] = more["blob"];
  EXPECT_NE(find_cause(record, 7, record.settings, more).words.find("'second' is new"), std::string::npos);
  EXPECT_NE(find_cause(record, 7, record.settings, {}).words.find("'blob' is gone"), std::string::npos);
  GoldenGeometry finer = triangle(0);
  finer["blob"].vertices = 4;
  EXPECT_NE(find_cause(record, 7, record.settings, finer).words.find("4 vertices, it had 3"), std::string::npos);
}

TEST(FindCause, ParameterOfALookIsNamedAndANewDefaultIsNone) {
  const GoldenRecord record{settings("[render]\nsamples = 8\n"), {{7, triangle(0)}}};
  const auto cause = [&](const std::string& shot) { return find_cause(record, 7, settings(shot), triangle(0)); };
  EXPECT_EQ(cause("[render]\nsamples = 8\n").words, "same geometry, same shot: the renderer changed");
  EXPECT_EQ(cause("[render]\nsamples = 9\n").words, "same geometry: the look changed: render.samples 8 -> 9");
  EXPECT_EQ(cause("[render]\nsamples = 8\nnovel = 1\n").words, "same geometry, same shot: the renderer changed")
      << "a field that a newer program has, as nobody set it";
  EXPECT_EQ(cause("[render]\nsamples = 8\nnovel = 2\n").words,
            "same geometry: the look changed: render.novel none -> 2");
}

TEST(FindCause, WithoutARecordNothingIsClaimed) {
  EXPECT_NE(find_cause(std::nullopt, 7, settings(""), triangle(0)).words.find("not known"), std::string::npos);
  const GoldenRecord other{settings(""), {{8, triangle(0)}}};
  EXPECT_NE(find_cause(other, 7, settings(""), triangle(0)).words.find("not known"), std::string::npos);
}

TEST(GoldenRecordFile, SamplesAreSpreadOverAllVertices) {
  EXPECT_EQ(sampled_vertex(2, 3), 2u);
  EXPECT_EQ(sampled_vertex(0, 100000), 0u);
  EXPECT_EQ(sampled_vertex(256, 100000), 50000u);
  EXPECT_LT(sampled_vertex(kGoldenSample - 1, 100000), 100000u);
}

TEST(GoldenPage, NamesCannotBreakIt) {
  const std::string page = golden_page({{"<b>&\"", 3, true, false, "a < b", "", {}, {1, 2, 3}, {}}});
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  EXPECT_NE(page.find("&lt;b&gt;&amp;&quot;"), std::string::npos);
  EXPECT_NE(page.find("base64,AQID"), std::string::npos);
}

TEST(SheetFrames, AreRisingEvenAndHoldBothEnds) {
  EXPECT_EQ(sheet_frames(1, 4, 16), (std::vector<int>{1, 2, 3, 4}));
  EXPECT_EQ(sheet_frames(1, 97, 5), (std::vector<int>{1, 25, 49, 73, 97}));
  EXPECT_EQ(sheet_frames(-3, 9, 1), (std::vector<int>{-3}));
  const std::vector<int> many = sheet_frames(10, 1009, 37);
  ASSERT_EQ(many.size(), 37u);
  EXPECT_EQ(many.front(), 10);
  EXPECT_EQ(many.back(), 1009);
  for (std::size_t k = 1; k < many.size(); ++k) EXPECT_NEAR(many[k] - many[k - 1], 999.0 / 36, 1.001);
}

}  // namespace
}  // namespace softreel
