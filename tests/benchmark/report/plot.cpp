#include "tests/benchmark/report/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/wait.h>

namespace softreel::bench {
namespace {

/// softreel's own curves are red and thick; rivals take these in turn (Okabe and Ito's, which colour-blind readers
/// tell apart) and other symbols.
constexpr const char* kOurs = "#d7301f";
constexpr std::array kRivals{"#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f6000", "#888888"};

/// Dash styles of softreel's own curves, where there are several.
constexpr std::array kDashes{1, 2, 3, 4, 5};

/// Inside single quotes of gnuplot, whose enhanced text is off.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

bool shows(const Plot& plot, double x, double y) {
  return std::isfinite(x) && std::isfinite(y) && (!plot.log_x || x > 0) && (!plot.log_y || y > 0);
}

/// The points that can be shown, in blocks divided by two blank lines; returns the series that have any.
std::vector<const Series*> write_data(const Plot& plot, const std::filesystem::path& path) {
  std::ofstream file(path);
  std::vector<const Series*> drawn;
  for (const Series& series : plot.series) {
    std::string block;
    for (std::size_t i = 0; i < series.x.size(); ++i)
      if (shows(plot, series.x[i], series.y[i])) block += fmt::format("{:.8g} {:.8g}\n", series.x[i], series.y[i]);
    if (block.empty()) continue;
    file << "# " << series.label << '\n' << block << "\n\n";
    drawn.push_back(&series);
  }
  file.close();
  if (!file) throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
  return drawn;
}

std::string curve(const Series& series, std::size_t index, std::size_t& ours, std::size_t& rivals) {
  const std::string with = series.points ? "points" : "linespoints";
  std::string style;
  if (series.ours) {
    style = fmt::format("lc rgb '{}' lw 3 dt {} pt 7 ps 0.9", kOurs, kDashes[ours % kDashes.size()]);
    ++ours;
  } else {
    style = fmt::format("lc rgb '{}' lw 1.5 pt {} ps 0.8", kRivals[rivals % kRivals.size()], 4 + rivals % 10);
    ++rivals;
  }
  return fmt::format("datafile index {} with {} {} title {}", index, with, style, quoted(series.label));
}

std::string script_of(const Plot& plot, const std::vector<const Series*>& drawn) {
  std::string script = fmt::format("datafile = '{}.dat'\n", plot.name);
  script += "set encoding utf8\nset grid lc rgb '#dddddd'\nset border 3 lc rgb '#444444'\nset tics nomirror\n";
  script += "set key outside right top samplen 4 spacing 1.15\n";
  script += fmt::format("set title {}\nset xlabel {}\nset ylabel {}\n", quoted(plot.title), quoted(plot.x_label),
                        quoted(plot.y_label));
  if (plot.log_x) script += "set logscale x\nset format x '%g'\n";
  if (plot.log_y) script += "set logscale y\nset format y '%g'\n";
  std::string curves;
  std::size_t ours = 0, rivals = 0;
  for (std::size_t i = 0; i < drawn.size(); ++i)
    curves += (i > 0 ? ", \\\n     " : "plot ") + curve(*drawn[i], i, ours, rivals);
  const auto into = [&](const std::string& terminal, const std::string& ending) {
    return fmt::format("set terminal {}\nset output '{}.{}'\n{}\n", terminal, plot.name, ending, curves);
  };
  return script + into("pngcairo noenhanced size 1100,620 font 'sans,11'", "png") +
         into("svg noenhanced size 1100,620 font 'sans,11' background '#ffffff'", "svg");
}

/// Runs a shell's command; its output and whether it succeeded.
std::pair<std::string, bool> run(const std::string& command) {
  std::string output;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {"no shell", false};
  std::array<char, 512> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) output += buffer.data();
  const int status = pclose(pipe);
  return {output, WIFEXITED(status) && WEXITSTATUS(status) == 0};
}

/// For a shell.
std::string shell_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace

bool can_draw() {
  static const bool found = run("gnuplot --version 2>&1").second;
  return found;
}

void draw(const Plot& plot, const std::filesystem::path& folder) {
  const std::vector<const Series*> drawn = write_data(plot, folder / (plot.name + ".dat"));
  if (drawn.empty()) throw std::runtime_error(fmt::format("plot {}: no point to draw", plot.name));
  const std::filesystem::path script = folder / (plot.name + ".gnuplot");
  std::ofstream file(script);
  file << script_of(plot, drawn);
  file.close();
  if (!file) throw std::runtime_error(fmt::format("{}: cannot be written", script.string()));
  const auto [output, ok] =
      run(fmt::format("cd {} && gnuplot {}.gnuplot 2>&1", shell_quoted(folder.string()), plot.name));
  if (!ok) throw std::runtime_error(fmt::format("plot {}: gnuplot said: {}", plot.name, output));
}

}  // namespace softreel::bench
