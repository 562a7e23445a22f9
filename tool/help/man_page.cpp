#include "tool/help/man_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tool/help/command_table.h"
#include "tool/help/topics.h"

namespace softreel {
namespace {

/// Text that troff prints as it is: backslashes, hyphens and quotes keep their shape for copying, lines stay lines, and
/// none begins with a request.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
    if (c == '\n') {
      out += "\n.br\n";
    } else if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else if (c == '\'') {
      out += "\\(aq";
    } else if (c == '`') {
      out += "\\(ga";
    } else if (c == '^') {
      out += "\\(ha";
    } else if (c == '~') {
      out += "\\(ti";
    } else {
      out += c;
    }
  }
  return out;
}

std::string section(const std::string& heading) {
  return fmt::format(".SH {}\n", heading);
}

/// A term in bold (and what follows it in roman), and its meaning.
std::string entry(const std::string& bold, const std::string& rest, const std::string& sentence) {
  return fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", escaped(bold), rest, escaped(sentence));
}

std::string option_entry(const OptionText& option) {
  std::string head;
  for (const std::string& name : option.names)
    head += fmt::format("{}\\fB{}\\fR", head.empty() ? "" : ", ", escaped(name));
  if (option.positional)
    head = fmt::format("\\fI{}\\fR", escaped(option.argument));
  else if (!option.argument.empty())
    head += fmt::format(" \\fI{}\\fR", escaped(option.argument));
  std::string sentence = option.sentence;
  // The choices, where the sentence does not begin with them.
  if (!option.choices.empty() && sentence.find(" | ") == std::string::npos)
    sentence += fmt::format(" ({})", fmt::join(option.choices, ", "));
  return fmt::format(".TP\n{}\n{}\n", head, escaped(sentence));
}

std::string command_section(const CommandText& command) {
  std::string page = fmt::format(".SS \"softreel {} {}\"\n{}.\n", escaped(command.name), escaped(synopsis(command)),
                                 escaped(command.sentence));
  for (const OptionText& option : command.options) page += option_entry(option);
  return page;
}

}  // namespace

std::string man_page(const CLI::App& app, const std::string& version) {
  const CommandText program = program_text(app);
  std::string page = fmt::format(".TH SOFTREEL 1 \"\" \"{}\" \"User Commands\"\n", escaped(version));
  page += section("NAME") + "softreel \\- soft\\-body animation from a text file\n";
  page += section("SYNOPSIS") + "\\fBsoftreel\\fR \\fICOMMAND\\fR [\\fIOPTION\\fR ...]\n";
  page += section("DESCRIPTION") + escaped(program.sentence) +
          "\n.PP\nA shot is a TOML file. \\fBsoftreel fields\\fR lists all that it may say, \\fBsoftreel explain\\fR "
          "\\fIFIELD\\fR one of it.\n";
  page += section("OPTIONS");
  for (const OptionText& option : program.options) page += option_entry(option);
  page += entry("--help", "", "Of the program, or after a command of that.");
  page += section("COMMANDS");
  for (const CommandText& command : command_texts(app)) page += command_section(command);
  for (const Topic& topic : topics()) {
    if (topic.heading.empty()) continue;
    page += section(topic.heading);
    for (const TopicLine& line : topic.lines) page += entry(line.name, "", line.sentence);
  }
  page += section("EXAMPLES");
  for (const CommandExample& example : command_examples()) page += entry(example.command, "", example.sentence);
  page += section("SEE ALSO") + "ffmpeg(1)\n";
  return page;
}

}  // namespace softreel
