/// What a shot must have become after all that was done to the program: runs in peace, and comparisons of folders.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/abused_program.h"

namespace softreel::testing {

/// Runs `softreel render` of FOLDER/shot.toml to an undisturbed end; returns the report.
nlohmann::json render_in_peace(const std::string& folder, const std::string& output, const std::string& options = "",
                               const std::string& command = "render");

/// Names of files under a folder whose bytes a finished run promises: no dot-files and dot-folders, no report (times),
/// no resolved shot (paths). None if there is no such folder.
std::vector<std::string> final_files(const std::string& folder);
/// Every final file of two folders has the same bytes.
void expect_equal_final_files(const std::string& a, const std::string& b);

/// Forms of the names of all files under a folder, digits and keys taken out: what a finished run may leave. A
/// temporary file has a form that none of them has.
std::set<std::string> name_forms(const std::string& folder);

/// Bytes of the final pictures of a folder by name.
std::map<std::string, std::string> pictures_in(const std::string& folder);

}  // namespace softreel::testing
