#include "tests/benchmark/report/table.h"

#include <cmath>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

namespace softreel::bench {

std::string text_of(const Cell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  if (const auto* whole = std::get_if<long>(&cell)) return std::to_string(*whole);
  const double value = std::get<double>(cell);
  return std::isnan(value) ? "-" : fmt::format("{:.5g}", value);
}

void Table::add(std::vector<Cell> row) {
  if (row.size() != columns.size())
    throw std::logic_error(fmt::format("table {}: {} cells for {} columns", name, row.size(), columns.size()));
  rows.push_back(std::move(row));
}

void write_tsv(const Table& table, const std::filesystem::path& path) {
  std::ofstream file(path);
  const auto write_line = [&](const auto& cells, const auto& text) {
    for (std::size_t c = 0; c < cells.size(); ++c) file << (c > 0 ? "\t" : "") << text(cells[c]);
    file << '\n';
  };
  write_line(table.columns, [](const std::string& name) { return name; });
  for (const auto& row : table.rows) write_line(row, text_of);
  file.close();
  if (!file) throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace softreel::bench
