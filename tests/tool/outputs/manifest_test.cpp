// The manifest and its journal: what is written, what is read after a death at any place, and by others at once.
#include "tool/outputs/manifest.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/base/error.h"

namespace softreel {
namespace {
namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

void enter(Manifest& manifest, const std::string& name, const std::string& key) {
  manifest.update([&](const ManifestContents&) {
    return ManifestChange{{{name, OutputEntry{key, "sum", 1, ""}}}, {}, {}};
  });
}

void remove(Manifest& manifest, const std::string& name) {
  manifest.update([&](const ManifestContents&) { return ManifestChange{{{name, std::nullopt}}, {}, {}}; });
}

class ManifestFiles : public ::testing::Test {
 protected:
  ManifestFiles() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ManifestFiles() override { fs::remove_all(folder_); }

  Manifest open() const {
    Manifest manifest(folder_.string(), "shot", log_);
    manifest.read();
    return manifest;
  }
  /// Names and keys as somebody who comes now reads them, "a:1 b:2 ".
  std::string seen() const {
    const Manifest manifest = open();
    std::string text;
    for (const auto& [name, entry] : manifest.contents().files) text += name + ":" + entry.key + " ";
    return text;
  }
  /// So long a manifest that the next entries go to the journal.
  void fill(Manifest& manifest) const {
    manifest.update([](const ManifestContents&) {
      return ManifestChange{{}, {{"id", {{"shot", std::string(20000, 'x')}}}}, "id"};
    });
  }

  const fs::path folder_ = fs::temp_directory_path() / fmt::format("softreel_manifest_{}", ::getpid());
  const fs::path path_ = folder_ / "shot.manifest.json", journal_ = folder_ / ".shot.manifest.journal";
  std::string warnings_;
  const Log log_{{}, [this](const std::string& line) { warnings_ += line + "\n"; }};
};

TEST_F(ManifestFiles, CostALineForEachFile) {
  const auto bytes_for = [&](int files) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    Manifest manifest = open();
    std::uintmax_t bytes = 0, journal = 0;
    std::string whole;
    for (int i = 0; i < files; ++i) {
      enter(manifest, fmt::format("shot.{:04}.png", i), std::string(32, 'k'));
      const std::uintmax_t now = fs::exists(journal_) ? fs::file_size(journal_) : 0;
      if (std::string text = text_of(path_); text != whole) {
        bytes += text.size();
        whole = std::move(text);
        journal = 0;
      }
      bytes += now - std::min(now, journal);
      journal = now;
    }
    manifest.fold();
    return bytes + fs::file_size(path_);
  };
  const auto some = bytes_for(150), many = bytes_for(600);
  EXPECT_LT(many, 8 * some) << "four times the files, " << some << " and " << many << " bytes";
  EXPECT_LT(many, 600U * 2000U);
}

TEST_F(ManifestFiles, AreReadWithAJournalThatNobodyFolded) {
  Manifest manifest = open();
  fill(manifest);
  enter(manifest, "a", "1");
  enter(manifest, "b", "1");
  remove(manifest, "a");
  EXPECT_EQ(text_of(path_).find("\"b\""), std::string::npos) << "it is in the journal";
  EXPECT_EQ(seen(), "b:1 ");
  EXPECT_EQ(open().contents().simulated, "id");
  manifest.fold();
  EXPECT_FALSE(fs::exists(journal_));
  EXPECT_EQ(seen(), "b:1 ");
}

/// At every length that a kill or a full disk may leave.
TEST_F(ManifestFiles, ATornLineIsNotThereAndSpoilsNoLaterOne) {
  Manifest manifest = open();
  fill(manifest);
  enter(manifest, "a", "1");
  const std::size_t whole = text_of(journal_).size();
  enter(manifest, "b", "1");
  const std::string journal = text_of(journal_);
  for (std::size_t size = 0; size < journal.size(); ++size) {
    write_text(journal_, journal.substr(0, size));
    write_text(folder_ / ".shot.manifest.lock", "\n");  // as the killed one left it
    ASSERT_EQ(seen(), size < whole ? "" : "a:1 ") << size;
    Manifest next = open();
    enter(next, "c", "1");
    ASSERT_EQ(seen(), size < whole ? "c:1 " : "a:1 c:1 ") << size;
  }
  EXPECT_EQ(warnings_, "");
}

/// The one that wrote a manifest died before it removed the journal that this one holds.
TEST_F(ManifestFiles, AJournalOfAnOlderManifestIsNotRead) {
  Manifest manifest = open(), other = open();
  fill(manifest);
  enter(manifest, "a", "1");
  enter(manifest, "b", "1");
  enter(other, "c", "1");
  const std::string journal = text_of(journal_);
  manifest.fold();
  write_text(journal_, journal);
  EXPECT_EQ(seen(), "a:1 b:1 c:1 ");
  remove(manifest, "a");
  EXPECT_EQ(seen(), "b:1 c:1 ");
  manifest.fold();
  write_text(journal_, journal);
  write_text(folder_ / ".shot.manifest.lock", "\n");
  enter(other, "d", "1");  // which had read that journal, and is not to go on with it
  EXPECT_EQ(seen(), "b:1 c:1 d:1 ");
}

/// Between the two steps of a fold there is the new manifest beside a journal that others went on to read.
TEST_F(ManifestFiles, TheEndOfAnOlderJournalIsNoNews) {
  Manifest manifest = open(), other = open();
  fill(manifest);
  enter(manifest, "a", "1");
  other.read();
  enter(manifest, "b", "1");
  const std::string journal = text_of(journal_);
  manifest.fold();
  remove(manifest, "a");
  manifest.fold();
  write_text(journal_, journal);
  enter(other, "c", "1");
  EXPECT_EQ(seen(), "b:1 c:1 ");
}

TEST_F(ManifestFiles, WhatCouldNotBeWrittenIsNotKnownLaterEither) {
  Manifest manifest = open(), other = open();
  fill(manifest);
  enter(manifest, "a", "1");
  const std::string journal = text_of(journal_);
  std::filesystem::remove(journal_);
  std::filesystem::create_directory(journal_);
  EXPECT_THROW(enter(manifest, "b", "1"), Error);
  std::filesystem::remove(journal_);
  write_text(journal_, journal);
  enter(other, "c", "1");
  enter(manifest, "d", "1");
  manifest.fold();
  EXPECT_EQ(seen(), "a:1 c:1 d:1 ");
}

TEST_F(ManifestFiles, OfAnOlderProgramAreReadAndWrittenAnew) {
  write_text(path_, R"({"format":2,"shot":"shot","simulated":"","settings":{},
                        "files":{"a":{"key":"1","checksum":"s","seconds":1,"settings":""}}})");
  write_text(journal_, "{\"journal\":\"\"}\n{\"files\":{\"z\":null},\"settings\":{}}\n");
  EXPECT_EQ(seen(), "a:1 ");
  Manifest manifest = open();
  enter(manifest, "b", "1");
  EXPECT_EQ(seen(), "a:1 b:1 ");
  EXPECT_NE(text_of(path_).find("\"b\""), std::string::npos);
}

TEST_F(ManifestFiles, AreSharedByWritersAtOnceAndNeverShrinkForAReader) {
  constexpr int kFiles = 60;
  std::atomic<int> running{2};
  const auto write = [&](const std::string& name) {
    Manifest manifest = open();
    for (int i = 0; i < kFiles; ++i) {
      enter(manifest, fmt::format("{}{}", name, i), "1");
      if (i % 20 == 19) manifest.fold();
    }
    --running;
  };
  std::thread a(write, "a"), b(write, "b");
  std::size_t most = 0;
  while (running > 0) {
    const std::size_t now = open().contents().files.size();
    EXPECT_GE(now, most);
    most = std::max(most, now);
  }
  a.join();
  b.join();
  EXPECT_EQ(open().contents().files.size(), 2U * kFiles);
  EXPECT_EQ(warnings_, "");
}

TEST_F(ManifestFiles, KeepOnlySettingsThatAreUsed) {
  Manifest manifest = open();
  manifest.update([](const ManifestContents&) {
    return ManifestChange{{{"a", OutputEntry{"1", "s", 1, "x"}}}, {{"x", {{"f", "1"}}}, {"y", {{"f", "2"}}}}, {}};
  });
  const auto settings = open().contents().settings;
  EXPECT_TRUE(settings.contains("x"));
  EXPECT_FALSE(settings.contains("y"));
}

}  // namespace
}  // namespace softreel
