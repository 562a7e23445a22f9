#include "tests/benchmark/report/report.h"

#include <cmath>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/test_folder.h"

namespace softreel::bench {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

fs::path new_folder(const std::string& name) {
  const fs::path folder = testing::test_folder() / name;
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

Plot line_plot() {
  return {"line",
          "It's a \"line\" & <more>",
          "x",
          "y",
          true,
          true,
          {{"ours'", {1, 10, 0, NAN}, {2, 20, 1, 1}, true, false}}};
}

TEST(Table, RefusesARowOfAnotherLength) {
  Table table{"t", "", {"a", "b"}, {}};
  EXPECT_THROW(table.add({1.0}), std::logic_error);
}

TEST(Table, IsWrittenWithATabBetweenCellsAndALineForEachRow) {
  Table table{"t", "", {"method", "tets", "error"}, {}};
  table.add({std::string("softreel"), 12L, 0.25});
  table.add({std::string("rival"), 7L, NAN});
  const fs::path path = new_folder("tsv") / "t.tsv";
  write_tsv(table, path);
  EXPECT_EQ(read(path), "method\ttets\terror\nsoftreel\t12\t0.25\nrival\t7\t-\n");
}

TEST(WriteTsv, SaysWhichFileCannotBeWritten) {
  try {
    write_tsv({"t", "", {"a"}, {}}, "/dev/null/t.tsv");
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/dev/null/t.tsv"), std::string::npos);
  }
}

TEST(Draw, MakesBothPicturesAndLeavesOutWhatALogarithmCannotShow) {
  if (!can_draw()) GTEST_SKIP() << "gnuplot is not installed";
  const fs::path folder = new_folder("plot's");
  draw(line_plot(), folder);
  EXPECT_EQ(read(folder / "line.png").substr(1, 3), "PNG");
  EXPECT_NE(read(folder / "line.svg").find("<svg"), std::string::npos);
  EXPECT_EQ(read(folder / "line.dat"), "# ours'\n1 2\n10 20\n\n\n");
}

TEST(Draw, RefusesAPlotWithoutPoints) {
  EXPECT_THROW(draw({"none", "", "", "", true, true, {{"a", {-1}, {1}, false, false}}}, new_folder("none")),
               std::runtime_error);
}

TEST(Report, IsOnePageThatRefersToNoOtherFileAndEscapesItsText) {
  const fs::path folder = new_folder("page");
  Report report(folder, "softreel bench <x>");
  report.begin("A & B", "softreel bench a");
  report.say("smaller < larger, `code`");
  Table table{"t", "Title", {"<column>"}, {}};
  table.add({std::string("a&b")});
  report.add(table);
  report.add(line_plot());
  report.fail("no <reason>");
  const std::string page = read(report.finish());
  for (const char* part : {"A &amp; B", "smaller &lt; larger, <code>code</code>", "&lt;column&gt;", "a&amp;b",
                           "no &lt;reason&gt;", "softreel bench &lt;x&gt;"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  for (std::size_t at = page.find("src=\""); at != std::string::npos; at = page.find("src=\"", at + 1))
    EXPECT_EQ(page.substr(at + 5, 5), "data:");
  EXPECT_EQ(page.find("href=\"http"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "t.tsv"));
}

TEST(Report, ShowsAPicturesBytesUnchanged) {
  const fs::path folder = new_folder("picture");
  std::ofstream(folder / "p.png", std::ios::binary) << "Man"
                                                    << "Ma";  // base64 of RFC 4648: TWFuTWE=
  Report report(folder, "");
  report.begin("P", "");
  report.add_picture("p.png", "caption");
  EXPECT_NE(read(report.finish()).find("base64,TWFuTWE=\""), std::string::npos);
}

}  // namespace
}  // namespace softreel::bench
