/// What softreel_bench leaves: one folder of tables, plots and pictures, and a self-contained page with all of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/benchmark/report/plot.h"
#include "tests/benchmark/report/table.h"

namespace softreel::bench {

/// Grows section by section; every table, plot and picture is in the folder as soon as it was added.
class Report {
 public:
  /// Makes the folder. command: as typed, for the page.
  Report(std::filesystem::path folder, std::string command);

  const std::filesystem::path& folder() const { return folder_; }

  /// Opens a section. command: what makes this section alone.
  void begin(const std::string& title, const std::string& command);
  /// Plain text; `code` between backquotes.
  void say(const std::string& text);
  void add(const Table& table);
  /// Without gnuplot says once that plots are left out; their numbers are in the tables.
  void add(const Plot& plot);
  /// A PNG that is in the folder already.
  void add_picture(const std::string& file, const std::string& caption);
  /// A section whose benchmark failed, and why.
  void fail(const std::string& message);

  /// Writes index.html: nothing in it refers to another file. Returns its path.
  std::filesystem::path finish() const;

 private:
  std::filesystem::path folder_;
  std::string command_, contents_, body_;
  int sections_ = 0;
  bool said_no_plots_ = false;
};

}  // namespace softreel::bench
