/// Any text as part of HTML or XML.
#pragma once

#include <string>

namespace softreel {

/// The text with &, <, > and " as entities; bytes that are no UTF-8 and control characters that XML 1.0 cannot carry
/// become U+FFFD. Tab and line feed stay.
std::string markup_text(const std::string& text);

}  // namespace softreel
