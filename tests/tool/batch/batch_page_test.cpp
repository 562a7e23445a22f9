#include "tool/batch/batch_page.h"

#include "tests/tool/batch/batch_samples.h"

namespace softreel {
namespace {

using namespace softreel::testing;

BodyEnergies falling(const std::string& name) {
  BodyEnergies body{name, {}};
  for (int frame = 1; frame <= 24; ++frame) {
    const double time = (frame - 1) / 24.0, energy = 0.5 * 9.81 * 9.81 * time * time;
    body.frames[frame] = {{energy, 0, -energy}, "key"};
  }
  return body;
}

std::vector<JobPictures> pictures_of(const BatchResult& batch) {
  std::vector<JobPictures> pictures(batch.jobs.size());
  pictures[0].cover = pictures[0].sheet = encode_png({2, 1, {255, 0, 0, 0, 255, 0}});
  pictures[2] = pictures[0];
  pictures[2].missing = 3;
  return pictures;
}

TEST(BatchPage, NeedsNothingButItselfWhateverTheWords) {
  BatchResult batch = sample_batch();
  batch.results[0].facts.energies = {falling(kHostileText)};
  batch.results[0].facts.stages = {{kHostileText, 2.0}, {"trace", 1.0}};
  batch.results[0].facts.made = batch.results[0].facts.skipped = {kHostileText};
  const nlohmann::json page =
      checked("check_page.py", batch_page(batch, pictures_of(batch), kHostileText, kHostileText));
  ASSERT_TRUE(page.is_object());
  EXPECT_EQ(page["counts"]["img"], 4);
  EXPECT_EQ(page["counts"]["svg"], 1);
  EXPECT_EQ(page["counts"]["section"], batch.jobs.size());
}

TEST(BatchPage, ShowsEveryJobWithItsCommandAndEveryFailureWithItsMessage) {
  const BatchResult batch = sample_batch();
  const nlohmann::json page = checked("check_page.py", batch_page(batch, pictures_of(batch), "now", "here"));
  ASSERT_TRUE(page.is_object());
  EXPECT_EQ(page["texts"]["h1"][0], "Batch: 1 done, 1 up to date, 3 failed, 1 interrupted, 1 not started");
  std::string all;
  for (const auto& text : page["texts"]["pre"]) all += text.get<std::string>() + "\n";
  EXPECT_NE(all.find("It was ended by signal 6 (SIGABRT)."), std::string::npos);
  EXPECT_NE(all.find("shot.toml:3: wrong\n  Accepted: right."), std::string::npos);
  std::size_t commands = 0;
  for (std::size_t at = all.find("softreel render"); at != std::string::npos; at = all.find("softreel render", at + 1))
    ++commands;
  EXPECT_EQ(commands, batch.jobs.size());
}

}  // namespace
}  // namespace softreel
