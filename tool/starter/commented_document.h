/// A shot's document as a text for people: every field with a comment that says what it means, in which unit.
#pragma once

#include <map>
#include <string>

#include "tool/shot/toml_tree.h"

namespace softreel {

/// Why a field has its value, or what else it could be, by its path in the document ("body.creature.tets"); put after
/// what the table of fields says. Of a table ("body.creature.pin[0]") it stands above the heading.
using Remarks = std::map<std::string, std::string>;

/// The document as TOML. Comments come from the table of fields (tool/shot/schema): short lines have theirs beside
/// them, long ones above. Every field must be one of the table.
std::string commented_document(const TomlValue& document, const Remarks& remarks);

/// Text as lines of a comment, "# " before each, at most 110 characters wide with `indent` before them.
std::string comment_lines(const std::string& text, std::size_t indent = 0);

}  // namespace softreel
