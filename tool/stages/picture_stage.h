/// One frame's picture files, traced only if they cannot be had otherwise.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "render/image/burn_in.h"
#include "render/pathtrace/path_tracer.h"
#include "tool/cache/picture_record.h"
#include "tool/outputs/outputs.h"
#include "tool/stages/scene_stage.h"

namespace softreel {

/// How a frame's pictures came to the output folder.
enum class PictureSource {
  Kept,       ///< they were there
  Recalled,   ///< the cache had them
  Developed,  ///< the cache had the scene-linear picture: only the view or the exposure changed
  Linked,     ///< another frame looks the same
  Traced
};

/// What a burned-in frame says: "SHOT" and "FRAME / LAST FRAME".
BurnIn frame_words(const ShotSettings& settings, int frame);

/// Files of pictures in the output folder and in the cache. Thread-safe but for `trace`.
class PictureStage {
 public:
  /// All are kept by reference.
  PictureStage(const SceneStage& scenes, const Shot& shot, Outputs& outputs, const RunContext& context);

  /// A file that the shot asks for.
  struct File {
    std::string path, extension;
    StageKey key;
  };
  /// `picture`: the frame's trace_key or content_key.
  std::vector<File> files(int frame, const StageKey& picture) const;
  /// What the cache keeps for the pictures of these frames.
  std::vector<CacheItem> items(int first, int last) const;
  StageKey trace_key(int frame) const { return scenes_.trace_key(frame); }

  /// True if all files are there and whole.
  bool is_kept(int frame) const;
  /// True if the cache has all files, or what they are developed from; their bytes are not read.
  bool is_stored(int frame) const;
  /// What making the frame's files took when they were made.
  double seconds(int frame) const;
  /// Removes what is under the names of these frames' files and is not theirs: pictures of an older shot, also of a
  /// kind, PNG or EXR, that the shot as it is now does not ask for; and files that nobody knows. Returns how many.
  int remove_outdated(int first, int last);
  /// Whether that would remove any.
  bool has_outdated(int first, int last) const;

  /// Frames that have a file which the manifest knows by another key, and others that have one it does not know.
  struct Losses {
    int replaced = 0, forgotten = 0;
  };
  Losses count_losses(int first, int last) const;

  /// Brings the frame's files from the cache under either key, if that can be done.
  bool recall(int frame, const StageKey& picture);
  /// Makes the display picture of the stored scene-linear one, if that is all that is missing.
  bool develop(int frame, const StageKey& picture);

  Image trace(const Scene& scene);
  /// Writes a traced frame's files, and stores them under both keys.
  void keep(int frame, const StageKey& content, const Image& image, double seconds);

 private:
  void place(const File& file, const Cache::StoredFile& stored, const Bytes& bytes, double seconds);
  void note_linear(int frame, const StageKey& picture, const PictureRecord& linear);
  Bytes encode_display(int frame, const Bytes& half) const;
  StageKey file_key(int frame, const std::string& extension, const StageKey& picture) const;
  File file_of(int frame, const std::string& extension, const StageKey& picture) const;
  std::map<std::string, StageKey> own_keys(int first, int last) const;

  const SceneStage& scenes_;
  const Shot& shot_;
  Outputs& outputs_;
  const RunContext& context_;
  Threads encoders_;                    ///< that nothing stops: a traced picture is written even after Ctrl-C
  std::unique_ptr<PathTracer> tracer_;  ///< made when the first picture has to be traced
};

}  // namespace softreel
