/// A table of measurements: written as TSV, shown as HTML, drawn by Plot.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace softreel::bench {

/// Numbers are written with 5 significant digits, NaN (nothing to say) as "-".
using Cell = std::variant<std::string, double, long>;

std::string text_of(const Cell& cell);

struct Table {
  std::string name;                  ///< of the file: NAME.tsv
  std::string title;                 ///< one sentence above it
  std::vector<std::string> columns;  ///< with units: "cpu seconds", "tip / m"
  std::vector<std::vector<Cell>> rows;

  /// Throws std::logic_error unless there is a cell for each column.
  void add(std::vector<Cell> row);
};

/// Header line and one line a row, tab-separated. Throws std::runtime_error if the file cannot be written.
void write_tsv(const Table& table, const std::filesystem::path& path);

}  // namespace softreel::bench
