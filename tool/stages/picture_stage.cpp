#include "tool/stages/picture_stage.h"

#include <algorithm>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "core/base/check.h"
#include "render/image/half_picture.h"
#include "render/image/image_io.h"

namespace softreel {
namespace {

/// Scene-linear pixels in half precision: what display pictures are developed from, now and later.
constexpr const char* kLinear = "half";

}  // namespace

PictureStage::PictureStage(const SceneStage& scenes, const Shot& shot, Outputs& outputs, const RunContext& context)
    : scenes_(scenes), shot_(shot), outputs_(outputs), context_(context), encoders_(context.threads.count()) {}

BurnIn frame_words(const ShotSettings& settings, int frame) {
  return {settings.name, fmt::format("{} / {}", frame, settings.last_frame)};
}

/// frame: matters only where it is written into the picture.
StageKey PictureStage::file_key(int frame, const std::string& extension, const StageKey& picture) const {
  KeyHasher key(extension + " 2");
  key.add(picture);
  if (extension == "png") key.add(shot_.output.view).add(shot_.output.exposure);
  if (extension == "png" && shot_.output.view == ViewTransform::Raw) key.add("linear");
  if (extension == "png" && shot_.output.burn_in) {
    const BurnIn words = frame_words(shot_.settings, frame);
    key.add(words.left).add(words.right);
  }
  return key.key();
}

PictureStage::File PictureStage::file_of(int frame, const std::string& extension, const StageKey& picture) const {
  return {outputs_.frame_path(frame, extension), extension, file_key(frame, extension, picture)};
}

std::vector<PictureStage::File> PictureStage::files(int frame, const StageKey& picture) const {
  std::vector<File> files;
  for (const auto& [extension, wanted] : {std::pair("png", shot_.output.png), std::pair("exr", shot_.output.exr)})
    if (wanted) files.push_back(file_of(frame, extension, picture));
  return files;
}

std::vector<CacheItem> PictureStage::items(int first, int last) const {
  std::vector<CacheItem> items;
  for (int frame = first; frame <= last; ++frame) {
    const StageKey trace = trace_key(frame);
    items.push_back(cache_item(kPictureStage, file_key(frame, kLinear, trace)));
    for (const File& file : files(frame, trace)) items.push_back(cache_item(kPictureStage, file.key));
  }
  return items;
}

bool PictureStage::is_kept(int frame) const {
  const std::vector<File> wanted = files(frame, trace_key(frame));
  return std::all_of(wanted.begin(), wanted.end(),
                     [&](const File& file) { return outputs_.is_done(file.path, file.key); });
}

bool PictureStage::is_stored(int frame) const {
  const StageKey trace = trace_key(frame);
  if (!shot_.output.exr && is_picture_stored(context_.cache, file_key(frame, kLinear, trace))) return true;
  const std::vector<File> wanted = files(frame, trace);
  return std::all_of(wanted.begin(), wanted.end(),
                     [&](const File& file) { return is_picture_stored(context_.cache, file.key); });
}

double PictureStage::seconds(int frame) const {
  double seconds = 0;
  for (const File& file : files(frame, trace_key(frame)))
    if (const auto entry = outputs_.entry(file.path)) seconds = std::max(seconds, entry->seconds);
  return seconds;
}

/// By path: of what the shot asks for, and of the known files of a kind that it asked for once.
std::map<std::string, StageKey> PictureStage::own_keys(int first, int last) const {
  std::map<std::string, StageKey> keys;
  for (int frame = first; frame <= last; ++frame) {
    const StageKey trace = trace_key(frame);
    for (const auto& [extension, wanted] : {std::pair("png", shot_.output.png), std::pair("exr", shot_.output.exr)}) {
      const File one = file_of(frame, extension, trace);
      if (wanted || outputs_.entry(one.path)) keys[one.path] = one.key;
    }
  }
  return keys;
}

int PictureStage::remove_outdated(int first, int last) {
  return outputs_.remove_outdated(own_keys(first, last));
}

bool PictureStage::has_outdated(int first, int last) const {
  return outputs_.has_outdated(own_keys(first, last));
}

PictureStage::Losses PictureStage::count_losses(int first, int last) const {
  Losses losses;
  for (int frame = first; frame <= last; ++frame) {
    const std::vector<File> wanted = files(frame, trace_key(frame));
    const auto any = [&](const auto& is_lost) {
      return std::any_of(wanted.begin(), wanted.end(),
                         [&](const File& file) { return is_lost(outputs_.entry(file.path), file.key); });
    };
    if (any([](const auto& entry, const StageKey& key) { return entry && entry->key != key; }))
      ++losses.replaced;
    else if (any([](const auto& entry, const StageKey&) { return !entry; }))
      ++losses.forgotten;
  }
  return losses;
}

bool PictureStage::recall(int frame, const StageKey& picture) {
  struct Found {
    File file;
    PictureRecord record;
    Bytes bytes;
  };
  const StageKey trace = trace_key(frame);
  std::vector<Found> found;
  for (const File& file : files(frame, trace)) {
    const auto record = load_picture_record(context_.cache, file_key(frame, file.extension, picture));
    if (!record) return false;
    auto bytes = context_.cache.load_file(record->checksum);
    if (!bytes) return false;
    found.push_back({file, *record, std::move(*bytes)});
  }
  for (const Found& one : found) {
    const std::string stored = context_.cache.file_path(one.record.checksum);
    outputs_.link(one.file.path, one.file.key, stored, one.bytes, one.record.seconds);
    if (picture != trace) store_picture_record(context_.cache, one.file.key, one.record);
  }
  const auto linear = load_picture_record(context_.cache, file_key(frame, kLinear, picture));
  if (linear) note_linear(frame, picture, *linear);
  return true;
}

/// So that a change of view or exposure can develop this frame as well, without looking at the scene.
void PictureStage::note_linear(int frame, const StageKey& picture, const PictureRecord& linear) {
  if (const StageKey trace = trace_key(frame); picture != trace)
    store_picture_record(context_.cache, file_key(frame, kLinear, trace), linear);
}

Bytes PictureStage::encode_display(int frame, const Bytes& half) const {
  const ScopedStage stage(context_.times, "write");
  DisplayImage picture =
      to_display(decode_half(half), shot_.output.view, static_cast<float>(shot_.output.exposure), &encoders_);
  scenes_.draw_legend(picture);
  if (shot_.output.burn_in) burn_in(picture, frame_words(shot_.settings, frame));
  return encode_png(picture, &encoders_);
}

bool PictureStage::develop(int frame, const StageKey& picture) {
  if (!shot_.output.png) return false;
  const auto linear = load_picture_record(context_.cache, file_key(frame, kLinear, picture));
  if (!linear) return false;
  const auto half = context_.cache.load_file(linear->checksum);
  if (!half) return false;
  // The display picture goes to the cache; then all files of the frame come from there, or the frame must be traced.
  note_linear(frame, picture, *linear);
  const Bytes png = encode_display(frame, *half);
  const Cache::StoredFile stored = context_.cache.store_file(png);
  if (stored.is_there)
    store_picture_record(context_.cache, file_key(frame, "png", picture), {stored.checksum, linear->seconds});
  if (shot_.output.exr) return recall(frame, picture);
  place(files(frame, trace_key(frame)).front(), stored, png, linear->seconds);
  return true;
}

/// Into the output folder: as a link to the stored file if that is there and whole, else written.
void PictureStage::place(const File& file, const Cache::StoredFile& stored, const Bytes& bytes, double seconds) {
  if (stored.is_there)
    outputs_.link(file.path, file.key, context_.cache.file_path(stored.checksum), bytes, seconds);
  else
    outputs_.write(file.path, file.key, bytes, seconds);
}

Image PictureStage::trace(const Scene& scene) {
  if (!tracer_) tracer_ = std::make_unique<PathTracer>(context_.threads, context_.times);
  const ScopedStage stage(context_.times, "render");
  Image image = tracer_->render(scene, shot_.render.params, [this] { return context_.cancelled.load(); });
  if (const Channel* samples = image.find("samples.N")) {
    const auto [least, most] = std::minmax_element(samples->pixels.begin(), samples->pixels.end());
    const double mean = std::accumulate(samples->pixels.begin(), samples->pixels.end(), 0.0) /
                        static_cast<double>(samples->pixels.size());
    context_.log.info(fmt::format("samples a pixel: {} to {}, {:.1f} on average", *least, *most, mean));
  }
  return image;
}

void PictureStage::keep(int frame, const StageKey& content, const Image& image, double seconds) {
  const StageKey trace = trace_key(frame);
  const auto store = [&](const std::string& extension, const Bytes& bytes) {
    const Cache::StoredFile stored = context_.cache.store_file(bytes);
    if (stored.is_there)
      for (const StageKey& picture : {trace, content})
        store_picture_record(context_.cache, file_key(frame, extension, picture), {stored.checksum, seconds});
    return stored;
  };
  const Bytes half = encode_half(image);
  store(kLinear, half);
  for (const File& file : files(frame, trace)) {
    const Bytes bytes = file.extension == "exr" ? encode_exr(image) : encode_display(frame, half);
    place(file, store(file.extension, bytes), bytes, seconds);
  }
}

}  // namespace softreel
