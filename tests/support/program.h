/// Runs the built softreel program, as a user would, in a folder of its own.
#pragma once

#include <string>
#include <vector>

namespace softreel::testing {

struct Outcome {
  int status = 0;  ///< exit status; 128 + signal if it was killed
  std::string out, err;
};

/// Runs a shell command line with `softreel` on it standing for the built program.
Outcome run(const std::string& command_line);

/// Whether a preview ended because there is no EGL to draw with: none on this machine, or none in this build. Whatever
/// else it ended with is a failure.
bool has_no_egl(const Outcome& preview);

/// A new empty folder under the test's temporary folder; its path has no blanks.
std::string new_folder(const std::string& name);

std::string read_text(const std::string& path);
void write_text(const std::string& path, const std::string& text);
/// What a stored result holds besides how long making it took, which its first line says; other files whole.
std::string stored_content(const std::string& path);
bool exists(const std::string& path);
/// Names of the regular files under a folder, with folders, sorted; those that start with '.' at the top excepted.
std::vector<std::string> files_under(const std::string& folder);

/// An OBJ file of a sphere of radius 0.5 around (0, 0.5, 0) with quads, as a modeller would make it.
std::string sphere_obj(int rings);

/// A shot of one soft sphere, small enough to render in a second; `more` is appended, keys of tables win over it not.
std::string sphere_shot(const std::string& more = "");

/// A folder with sphere.obj and shot.toml.
std::string shot_folder(const std::string& name, const std::string& more = "");

}  // namespace softreel::testing
