/// One frame's picture files, traced only if they cannot be had otherwise.
#pragma once

#include <memory>

#include "render/pathtrace/path_tracer.h"
#include "tool/stages/outputs.h"
#include "tool/stages/scene_stage.h"

namespace softreel {

enum class PictureSource { Done, Linked, Traced };

class PictureStage {
 public:
  PictureStage(const Shot& shot, Outputs& outputs, const RunContext& context);

  /// Leaves the frame's PNG and EXR, as the shot asks, in the output folder: nothing to do if they are there already,
  /// copied if an equal picture is there under another name, traced otherwise.
  PictureSource make(int frame, const Scene& scene);

 private:
  struct Wanted {
    std::string path;
    StageKey key;
  };
  std::vector<Wanted> wanted_files(int frame, const StageKey& picture) const;
  std::vector<std::uint8_t> encode(const std::string& path, const Image& image) const;

  const Shot& shot_;
  Outputs& outputs_;
  const RunContext& context_;
  std::unique_ptr<PathTracer> tracer_;  ///< made when the first picture has to be traced
};

}  // namespace softreel
