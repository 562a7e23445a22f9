#include <cstdio>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/commands/commands.h"
#include "tool/help/field_explanation.h"
#include "tool/help/topics.h"
#include "tool/shot/schema.h"

namespace softreel {
namespace {

/// What can be asked for.
std::string overview() {
  std::string text = "Tables of a shot (softreel explain NAME, then a field of it; softreel fields prints all):\n";
  for (const FieldText& field : field_texts())
    if (field.is_table && field.path.find_first_of(".[") == std::string::npos)
      text += fmt::format("  {:<12}  {}\n", field.path, field.sentence);
  text += "Topics:\n";
  for (const Topic& topic : topics()) text += fmt::format("  {:<12}  {}\n", topic.name, topic.sentence);
  return text;
}

}  // namespace

int run_explain(const ExplainOptions& options) {
  const bool is_topic = options.shot.empty() && find_topic(options.field) != nullptr;
  if (options.json && (options.field.empty() || is_topic))
    throw input_error("--json: tables and topics are for people.\n  Accepted with a field. Leave out --json.");
  if (options.field.empty()) {
    std::printf("%s", overview().c_str());
    return 0;
  }
  if (const Topic* topic = find_topic(options.field); topic != nullptr && options.shot.empty()) {
    std::printf("%s", to_text(*topic).c_str());
    return 0;
  }
  if (options.shot.empty() && !options.sets.empty())
    throw input_error(
        "--set, --quality: there is no shot that they could change.\n  Accepted: both beside --shot SHOT. Name the "
        "shot.");
  const FieldExplanation explanation = explain(options.field);
  if (!options.shot.empty() && explanation.text.is_table)
    throw input_error(
        fmt::format("--shot: {0} is a table, which has no value.\n"
                    "  Accepted with one of its fields: softreel explain {0} lists them.",
                    options.field));
  std::vector<FieldValue> values;
  if (!options.shot.empty()) {
    std::vector<Override> overrides;
    for (const std::string& text : options.sets) overrides.push_back(parse_override(text));
    values = field_values_in(options.field, explanation.text, options.shot, overrides);
  }
  if (options.json) {
    std::printf("%s\n", to_json(explanation, values).c_str());
    return 0;
  }
  std::printf("%s", to_text(explanation).c_str());
  if (!options.shot.empty()) std::printf("%s", to_text(values, explanation.text, options.shot).c_str());
  return 0;
}

int run_fields(const std::string& path) {
  if (!path.empty()) return run_explain({path, "", {}, false});
  std::printf("%s\n", shot_reference().c_str());
  return 0;
}

}  // namespace softreel
