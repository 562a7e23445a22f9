/// The versions of the libraries behind image_io, which nothing else includes.
#pragma once

#include <string>
#include <vector>

namespace softreel {

struct ImageLibraryVersion {
  std::string name, version;
  bool at_run_time = false;  ///< the library itself said so; else it is that of the headers
};

std::vector<ImageLibraryVersion> image_library_versions();

}  // namespace softreel
