#include "tests/tool/farm/shell.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/test_folder.h"

namespace softreel::testing {
namespace fs = std::filesystem;
namespace {

constexpr const char* kStandIn = R"bash(#!/bin/bash
if [ "$1" = --version ]; then
  echo "softreel 9.8.7 (of this test)"
  echo "more lines"
  exit 0
fi
printf '%s\0' "$@" >"$0.arguments"
pwd >"$0.directory"
[ -e "$0.status" ] && exit "$(cat "$0.status")"
exit 0
)bash";

/// Replaces the process by bash; does not return.
[[noreturn]] void become_bash(const std::string& script_path, const std::string& output,
                              const std::vector<std::string>& arguments, const std::vector<std::string>& environment) {
  const int out = ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  ::dup2(out, 1);
  ::dup2(out, 2);
  for (const std::string& word : environment) {
    const std::size_t equals = word.find('=');
    ::setenv(word.substr(0, equals).c_str(), word.substr(equals + 1).c_str(), 1);
  }
  std::vector<std::string> words{"bash", script_path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  ::execvp("bash", argv.data());
  ::_exit(127);
}

}  // namespace

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string farm_folder(const std::string& name) {
  const fs::path folder = testing::test_folder() / name;
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder.string();
}

ShellOutcome run_bash(const std::string& script, const std::vector<std::string>& arguments,
                      const std::vector<std::string>& environment) {
  const std::string folder = farm_folder("shell");
  write(folder + "/script.sh", script);
  const pid_t child = ::fork();
  if (child == 0) become_bash(folder + "/script.sh", folder + "/said", arguments, environment);
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child) throw std::runtime_error("no bash");
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), text_of(folder + "/said")};
}

FarmShot stand_in_shot(const std::string& folder) {
  FarmShot shot;
  shot.name = kNasty;
  shot.shot = folder + "/the shot.toml";
  shot.output = folder + "/out";
  shot.cache = folder + "/cache";
  shot.records = shot.output + "/.farm/name";
  shot.token = "farm-0123";
  shot.directory = folder + "/work";
  shot.program = folder + "/softreel";
  shot.version = "softreel 9.8.7";
  for (const std::string& made : {shot.cache, shot.directory, shot.records + "/tasks", shot.records + "/logs"})
    fs::create_directories(made);
  write(shot.shot, "a shot");
  write(shot.records + "/" + shot.token, "");
  write(cache_token_path(shot), "");
  write(shot.program, kStandIn);
  fs::permissions(shot.program, fs::perms::owner_all);
  shot.checksum = run_bash("sha256sum <\"$1\"", {shot.program}).said.substr(0, 64);
  return shot;
}

std::vector<std::string> arguments_of(const FarmShot& shot) {
  const std::string text = text_of(shot.program + ".arguments");
  std::vector<std::string> arguments;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\0', begin);
    arguments.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return arguments;
}

std::string argument_after(const std::vector<std::string>& arguments, const std::string& name) {
  const auto found = std::find(arguments.begin(), arguments.end(), name);
  return found == arguments.end() || found + 1 == arguments.end() ? std::string() : *(found + 1);
}

}  // namespace softreel::testing
