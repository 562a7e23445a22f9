#include "tests/support/program.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/wait.h>

#include "tests/support/test_folder.h"

namespace softreel::testing {
namespace fs = std::filesystem;

std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string stored_content(const std::string& path) {
  const std::string text = read_text(path);
  return text.starts_with("softreel cache") ? text.substr(text.find('\n')) : text;
}

bool exists(const std::string& path) {
  return fs::exists(path);
}

std::string new_folder(const std::string& name) {
  const fs::path folder = test_folder() / name;
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder.string();
}

Outcome run(const std::string& command_line) {
  const std::string folder = new_folder("run");
  const std::string script = fmt::format("softreel() {{ exec '{}' \"$@\"; }}\n({}) >{}/out 2>{}/err </dev/null",
                                         SOFTREEL_PROGRAM, command_line, folder, folder);
  const int status = std::system(script.c_str());
  if (status == -1) throw std::runtime_error("no shell");
  Outcome outcome;
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = read_text(folder + "/out");
  outcome.err = read_text(folder + "/err");
  return outcome;
}

bool has_no_egl(const Outcome& preview) {
  return (preview.status == 1 && preview.err.find("The preview cannot draw: ") != std::string::npos) ||
         (preview.status == 2 && preview.err.find("This build of softreel has no preview: ") != std::string::npos);
}

std::vector<std::string> files_under(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), folder).string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string sphere_obj(int rings) {
  const int segments = 2 * rings;
  std::string text = "v 0 1 0\n";
  for (int r = 1; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      const double polar = std::numbers::pi * r / rings, azimuth = 2 * std::numbers::pi * s / segments;
      text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", 0.5 * std::sin(polar) * std::sin(azimuth),
                          0.5 + 0.5 * std::cos(polar), 0.5 * std::sin(polar) * std::cos(azimuth));
    }
  text += "v 0 0 0\ng sphere\n";
  const auto vertex = [&](int r, int s) { return 2 + (r - 1) * segments + s % segments; };
  for (int s = 0; s < segments; ++s) text += fmt::format("f 1 {} {}\n", vertex(1, s), vertex(1, s + 1));
  for (int r = 1; r + 1 < rings; ++r)
    for (int s = 0; s < segments; ++s)
      text += fmt::format("f {} {} {} {}\n", vertex(r, s), vertex(r + 1, s), vertex(r + 1, s + 1), vertex(r, s + 1));
  const int last = 2 + (rings - 1) * segments;
  for (int s = 0; s < segments; ++s)
    text += fmt::format("f {} {} {}\n", last, vertex(rings - 1, s + 1), vertex(rings - 1, s));
  return text;
}

std::string sphere_shot(const std::string& more) {
  return R"(schema = 1
[shot]
name = "ball"
frames = [1, 4]
[body.ball]
mesh = "sphere.obj"
fit = 1.0
tets = 700
material = "soft"
[[body.ball.pin]]
select = { box = { min = [0, 0, 0], max = [1, 0.2, 1] }, unit = "box" }
[[body.ball.pull]]
select = { nearest = { point = [0.5, 1, 0.5], count = 4 }, unit = "box" }
stiffness = 500
keys = [ { frame = 1 }, { frame = 4, translate = [0.2, 0.2, 0] } ]
[material.soft]
youngs_modulus = 2e4
[environment]
zenith = [0.6, 0.7, 0.9]
[ground]
size = 20
[render]
width = 64
height = 36
samples = 2
[output]
movie = false
)" + more;
}

std::string shot_folder(const std::string& name, const std::string& more) {
  const std::string folder = new_folder(name);
  write_text(folder + "/sphere.obj", sphere_obj(12));
  write_text(folder + "/shot.toml", sphere_shot(more));
  return folder;
}

}  // namespace softreel::testing
