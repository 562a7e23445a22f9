#include "tests/benchmark/report/report.h"

#include <cstdint>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

#include "tests/benchmark/report/machine.h"

namespace softreel::bench {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, sans-serif; color: #222; background: #fff; max-width: 1120px; margin: 2rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.7rem; margin-bottom: .2rem; } h2 { font-size: 1.25rem; margin-top: 2.6rem; border-top: 2px solid #d7301f;
  padding-top: .6rem; }
nav a { margin-right: 1.2em; } a { color: #0b5fa5; }
code { background: #f2f2f0; padding: .1em .3em; border-radius: 3px; font-size: .9em; }
.scroll { overflow-x: auto; max-height: 34rem; overflow-y: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13px; margin: .4rem 0 1.2rem; }
th { text-align: left; position: sticky; top: 0; background: #fff; border-bottom: 1px solid #222; padding: .25rem .7rem; }
td { padding: .15rem .7rem; border-bottom: 1px solid #eee; white-space: nowrap; } td.n { text-align: right; }
img { max-width: 100%; } figure { margin: 1rem 0; } figcaption, .title { color: #555; font-size: 13px; }
.bad { color: #b00020; font-weight: 600; }
)";

/// Text for HTML; what stands between backquotes is code.
std::string html(const std::string& text) {
  std::string out;
  bool in_code = false;
  for (const char c : text) {
    if (c == '`') {
      out += in_code ? "</code>" : "<code>";
      in_code = !in_code;
    } else {
      out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
    }
  }
  return in_code ? out + "</code>" : out;
}

std::string read_all(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(fmt::format("{}: cannot be read", path.string()));
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[group >> (6 * (3 - k)) & 63U] : '=';
  }
  return out;
}

std::string html(const Table& table) {
  std::string out = "<div class=scroll><table><tr>";
  for (const std::string& name : table.columns) out += "<th>" + html(name) + "</th>";
  out += "</tr>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (const Cell& cell : row)
      out += (std::holds_alternative<std::string>(cell) ? "<td>" : "<td class=n>") + html(text_of(cell)) + "</td>";
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

}  // namespace

Report::Report(std::filesystem::path folder, std::string command)
    : folder_(std::move(folder)), command_(std::move(command)) {
  std::filesystem::create_directories(folder_);
}

void Report::begin(const std::string& title, const std::string& command) {
  ++sections_;
  contents_ += fmt::format("<a href=\"#s{}\">{}</a>\n", sections_, html(title));
  body_ += fmt::format("<h2 id=s{}>{}</h2>\n<p><code>{}</code></p>\n", sections_, html(title), html(command));
}

void Report::say(const std::string& text) {
  body_ += "<p>" + html(text) + "</p>\n";
}

void Report::add(const Table& table) {
  write_tsv(table, folder_ / (table.name + ".tsv"));
  body_ += fmt::format("<p class=title>{} (<code>{}.tsv</code>)</p>\n{}", html(table.title), table.name, html(table));
}

void Report::add(const Plot& plot) {
  if (!can_draw()) {
    if (!said_no_plots_) say("gnuplot was not found, so the curves are in the tables only.");
    said_no_plots_ = true;
    return;
  }
  draw(plot, folder_);
  // The first lines of gnuplot's SVG speak of files outside; a data address has neither scripts nor links.
  body_ += fmt::format("<figure><img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\"></figure>\n", html(plot.title),
                       base64(read_all(folder_ / (plot.name + ".svg"))));
}

void Report::add_picture(const std::string& file, const std::string& caption) {
  body_ +=
      fmt::format("<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
                  html(caption), base64(read_all(folder_ / file)));
}

void Report::fail(const std::string& message) {
  body_ += fmt::format("<p class=bad>Not measured: {}</p>\n", html(message));
}

std::filesystem::path Report::finish() const {
  const std::filesystem::path path = folder_ / "index.html";
  std::string machine;
  for (const auto& [name, value] : describe_machine())
    machine += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", html(name), html(value));
  std::ofstream file(path);
  file << "<!doctype html>\n<html lang=en><head><meta charset=utf-8><title>softreel: run time against error</title>\n"
       << "<style>" << kStyle << "</style></head><body>\n<h1>softreel: run time against error</h1>\n<p>Made by <code>"
       << html(command_) << "</code>.</p>\n<nav>" << contents_ << "</nav>\n<table>" << machine << "</table>\n"
       << body_ << "</body></html>\n";
  file.close();
  if (!file) throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
  return path;
}

}  // namespace softreel::bench
