/// What holds for all commands and stands in no table of fields or options: exit statuses, environment variables,
/// files, units; said by `softreel explain`, --help and the manual page.
#pragma once

#include <string>
#include <vector>

namespace softreel {

/// A name with what it means.
struct TopicLine {
  std::string name, sentence;
};

/// Something that `softreel explain` knows beside fields.
struct Topic {
  std::string name;      ///< "exit-status"
  std::string sentence;  ///< what it is about, on a line
  std::string heading;   ///< in the manual page; empty: left out there
  std::vector<TopicLine> lines;
};

const std::vector<Topic>& topics();

/// Null if there is no such topic.
const Topic* find_topic(const std::string& name);

std::string to_text(const Topic& topic);

/// A command with what it does, for the manual page.
struct CommandExample {
  std::string command, sentence;
};
const std::vector<CommandExample>& command_examples();

}  // namespace softreel
