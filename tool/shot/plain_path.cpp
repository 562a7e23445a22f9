#include "tool/shot/plain_path.h"

#include <algorithm>

namespace softreel {

std::filesystem::path plain_path(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  fs::path text = path.lexically_normal();
  if (std::find(path.begin(), path.end(), "..") == path.end()) return text;
  std::error_code failed;
  fs::path real = fs::weakly_canonical(fs::absolute(path, failed), failed);
  if (failed) return text;
  const bool leads_there = fs::weakly_canonical(fs::absolute(text, failed), failed) == real;
  return leads_there ? text : real;
}

}  // namespace softreel
