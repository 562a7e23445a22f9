#include "tool/batch/job_messages.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

namespace softreel {
namespace {

constexpr std::string_view kWarning = "warning: ", kProgram = "softreel: ";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string joined(std::vector<std::string>::const_iterator begin, std::vector<std::string>::const_iterator end) {
  std::string text;
  for (; begin != end; ++begin) text += (text.empty() ? "" : "\n") + *begin;
  return text;
}

}  // namespace

void JobMessages::read(const std::string& all) {
  if (all.size() < at_) at_ = all.size();  // its middle was dropped
  for (std::size_t end; (end = all.find('\n', at_)) != std::string::npos; at_ = end + 1)
    read_line(all.substr(at_, end - at_));
}

void JobMessages::read_line(const std::string& line) {
  int done = 0, total = 0;
  if (std::sscanf(line.c_str(), "frames %d/%d", &done, &total) == 2) {
    done_ = done;
    total_ = total;
  }
  if (!line.empty()) note_ = line;
}

std::vector<std::string> warnings_in(const std::string& said) {
  std::vector<std::string> warnings;
  for (const std::string& line : lines_of(said)) {
    if (!line.starts_with(kWarning)) continue;
    std::string warning = line.substr(kWarning.size());
    if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(std::move(warning));
  }
  return warnings;
}

std::string closing_message(const std::string& said) {
  constexpr std::ptrdiff_t kLastLines = 5;
  const std::vector<std::string> lines = lines_of(said);
  for (auto line = lines.end(); line != lines.begin();) {
    --line;
    if (!line->starts_with(kProgram)) continue;
    return joined(line, lines.end()).substr(kProgram.size());
  }
  return joined(lines.end() - std::min(kLastLines, lines.end() - lines.begin()), lines.end());
}

}  // namespace softreel
