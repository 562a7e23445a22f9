#include "tool/farm/shell_text.h"

#include <algorithm>
#include <string_view>

namespace softreel {
namespace {

bool is_plain(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("-_./:,=+@%").find(c) != std::string_view::npos;
  });
}

}  // namespace

std::string shell_quoted(const std::string& text) {
  std::string quoted = "'";
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool brace = c == '{' || c == '}';
    if (c == '\'')
      quoted += "'\\''";
    else if (brace && i > 0 && text[i - 1] == c)
      quoted.append("''").push_back(c);  // closes the word's quotes and opens them again
    else
      quoted.push_back(c);
  }
  return quoted + "'";
}

std::string shell_command(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) {
    if (!command.empty()) command += ' ';
    command += is_plain(word) ? word : shell_quoted(word);
  }
  return command;
}

}  // namespace softreel
