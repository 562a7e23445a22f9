#include "tool/stages/picture_stage.h"

#include <algorithm>

#include "render/image/image_io.h"

namespace softreel {

PictureStage::PictureStage(const Shot& shot, Outputs& outputs, const RunContext& context)
    : shot_(shot), outputs_(outputs), context_(context) {}

std::vector<PictureStage::Wanted> PictureStage::wanted_files(int frame, const StageKey& picture) const {
  std::vector<Wanted> wanted;
  const OutputSettings& output = shot_.output;
  if (output.png)
    wanted.push_back({outputs_.frame_path(frame, "png"),
                      KeyHasher("png 1").add(picture).add(output.view).add(output.exposure).key()});
  if (output.exr) wanted.push_back({outputs_.frame_path(frame, "exr"), KeyHasher("exr 1").add(picture).key()});
  return wanted;
}

std::vector<std::uint8_t> PictureStage::encode(const std::string& path, const Image& image) const {
  const ScopedStage stage(context_.times, "write");
  if (path.ends_with(".exr")) return encode_exr(image);
  return encode_png(to_display(image, shot_.output.view, static_cast<float>(shot_.output.exposure)));
}

PictureSource PictureStage::make(int frame, const Scene& scene) {
  std::vector<Wanted> missing = wanted_files(frame, picture_key(scene, shot_.render.params));
  std::erase_if(missing, [&](const Wanted& file) { return outputs_.is_done(file.path, file.key); });
  if (missing.empty()) return PictureSource::Done;
  std::erase_if(missing, [&](const Wanted& file) {
    const auto equal = outputs_.find_equal(file.key);
    if (equal) outputs_.write(file.path, file.key, *equal);
    return equal.has_value();
  });
  if (missing.empty()) return PictureSource::Linked;
  if (!tracer_) tracer_ = std::make_unique<PathTracer>(context_.threads, context_.times);
  Image image;
  {
    const ScopedStage stage(context_.times, "render");
    image = tracer_->render(scene, shot_.render.params, [this] { return context_.cancelled.load(); });
  }
  for (const Wanted& file : missing) outputs_.write(file.path, file.key, encode(file.path, image));
  return PictureSource::Traced;
}

}  // namespace softreel
