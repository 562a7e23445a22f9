#include "tool/batch/junit.h"

#include "tests/tool/batch/batch_samples.h"

namespace softreel {
namespace {

using namespace softreel::testing;

TEST(Junit, ConformsToTheCommonFormAndSaysWhatBecameOfEachJob) {
  const BatchResult batch = sample_batch();
  const nlohmann::json suite = checked("check_junit.py", to_junit(batch, "2026-11-28T13:00:00", "host & \"more\""));
  ASSERT_TRUE(suite.is_object());
  EXPECT_EQ(suite["counts"]["tests"], 7);
  const std::vector<std::string> wanted{"passed", "passed", "failure", "failure", "error", "skipped", "skipped"};
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_EQ(suite["cases"][i]["outcome"], wanted[i]) << i;
    EXPECT_EQ(suite["cases"][i]["time"], 1.25);
  }
  EXPECT_EQ(suite["cases"][2]["type"], "status 1");
  EXPECT_EQ(suite["cases"][4]["type"], "signal 6 (SIGABRT)");
  EXPECT_EQ(suite["cases"][3]["text"], "shot.toml:3: wrong\n  Accepted: right.");
  EXPECT_EQ(suite["cases"][3]["message"], "shot.toml:3: wrong");
}

TEST(Junit, WordsArriveAsTheyWereButForWhatXmlCannotCarry) {
  const nlohmann::json suite = checked("check_junit.py", to_junit(sample_batch(), "2026-11-28T13:00:00", "host"));
  ASSERT_TRUE(suite.is_object());
  const std::string carried =
      "a<b> & \"c\" 'd' ]]> \xEF\xBF\xBD \xEF\xBF\xBD\xEF\xBF\xBD </pre></testcase> \xC3\xA9 \n\ttwo";
  EXPECT_EQ(suite["cases"][2]["text"], carried);
  EXPECT_NE(suite["out"].get<std::string>().find("job1: all was there already"), std::string::npos);
}

}  // namespace
}  // namespace softreel
