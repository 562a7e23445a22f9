/// The manual page of softreel, in the man macros of troff, from the table of commands.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace softreel {

/// softreel(1). `version`: what stands in the footer.
std::string man_page(const CLI::App& app, const std::string& version);

}  // namespace softreel
