#include "tool/report/markup.h"

#include <gtest/gtest.h>

namespace softreel {
namespace {

const std::string kReplaced = "\xEF\xBF\xBD";

TEST(MarkupText, MakesEntitiesOfWhatWouldBeMarkup) {
  EXPECT_EQ(markup_text("a<b> & \"c\""), "a&lt;b&gt; &amp; &quot;c&quot;");
  EXPECT_EQ(markup_text("&lt;"), "&amp;lt;");
  EXPECT_EQ(markup_text("tab\tand\nline"), "tab\tand\nline");
}

TEST(MarkupText, KeepsCharactersOfEveryLength) {
  const std::string text = "e \xC3\xA9 \xE2\x82\xAC \xF0\x9F\x90\x87 \xF4\x8F\xBF\xBD";
  EXPECT_EQ(markup_text(text), text);
}

TEST(MarkupText, ReplacesEachByteThatIsNoCharacterOfXml) {
  for (const char* wrong : {"\x01", "\x1b", "\r", "\x80", "\xFF", "\xC3", "\xC1"})
    EXPECT_EQ(markup_text(wrong), kReplaced);
  EXPECT_EQ(markup_text("\xC0\x80"), kReplaced + kReplaced) << "overlong zero";
  EXPECT_EQ(markup_text("\xE0\x80\xAF"), kReplaced + kReplaced + kReplaced) << "overlong slash";
  EXPECT_EQ(markup_text("\xED\xA0\x80"), kReplaced + kReplaced + kReplaced) << "half of a surrogate pair";
  EXPECT_EQ(markup_text("\xEF\xBF\xBF"), kReplaced + kReplaced + kReplaced) << "U+FFFF";
  EXPECT_EQ(markup_text("\xF4\x90\x80\x80").size(), 4 * kReplaced.size()) << "beyond the last character";
  EXPECT_EQ(markup_text(std::string("a\0b", 3)), "a" + kReplaced + "b");
  EXPECT_EQ(markup_text("x\xE2\x82"), "x" + kReplaced + kReplaced) << "cut short";
}

}  // namespace
}  // namespace softreel
