/// Which softreel this is: its version, the libraries it stands on, the parts built in, and what it finds on the
/// machine.
#pragma once

#include <string>
#include <vector>

namespace softreel {

/// "softreel VERSION" and the versions of what it was built with, on one line, for reports.
std::string version_text();

/// "softreel VERSION".
std::string short_version();

struct LibraryVersion {
  std::string name;
  std::string version;  ///< of the library that is loaded where it tells, else of the headers it was built with
  bool at_run_time = false;
};

/// Something that may be missing: a part of softreel, or another program.
struct PartVersion {
  std::string name;     ///< "embree", "ffmpeg"
  std::string purpose;  ///< "path tracing"
  std::string version;  ///< of the library behind it when it was built, or what the program says; empty: not known
  std::string file;     ///< where it is; empty: nowhere, or linked into the program
  bool is_built_in = false;
  bool is_found = false;  ///< it can be used here
};

struct VersionFacts {
  std::string version, compiler;
  std::vector<LibraryVersion> libraries;
  std::vector<PartVersion> parts;  ///< no module is loaded to find out
  std::string instruction_set;     ///< that the program was built for
  bool has_avx512 = false;         ///< the processor does; Embree uses it
  std::string processor;
  int threads = 0;  ///< used where no option says otherwise
  std::string presets;
};

/// Cost: a look for files, and ffmpeg -version if there is one.
VersionFacts version_facts();

std::string to_text(const VersionFacts& facts);
std::string to_json(const VersionFacts& facts);

}  // namespace softreel
