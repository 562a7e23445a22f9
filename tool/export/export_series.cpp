#include "tool/export/export_series.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "core/base/check.h"
#include "tool/bodies/simulate_key.h"
#include "tool/cache/byte_hasher.h"
#include "tool/export/body_samples.h"
#include "tool/export/export_colors.h"
#include "tool/export/usda_look.h"
#include "tool/stages/appearance_key.h"
#include "tool/stages/shot_camera.h"

namespace softreel {
namespace {

/// Frames of the simulation that a sample is made of: the one at or after it, and whether it lies before that.
struct SimulatedFrame {
  int frame = 0;
  bool is_between = false;
};

SimulatedFrame simulated_frame(const ExportFrames& frames, int per_frame, int sample) {
  return {frames.first + (sample + per_frame - 1) / per_frame, sample % per_frame != 0};
}

void add(KeyHasher& key, const Camera& c) {
  key.add(c.position).add(c.target).add(c.up).add(c.focal_length_mm).add(c.sensor_width_mm).add(c.f_number);
  key.add(c.focus_distance);
}

/// With the bytes of its textures, and the colours that it shows: no key of a mesh has them.
StageKey look_key(ExportBody body) {
  KeyHasher key("export look 2");
  key.add(body.material);
  add(key, body.appearance);
  TextureSettings& t = body.textures;
  key.add(t.wrap).add(t.scale.x()).add(t.scale.y()).add(t.offset.x()).add(t.offset.y()).add(t.normal_strength);
  for (const std::string* path : t.paths()) key.add(*path).add(path->empty() ? StageKey() : hash_file(*path));
  key.add(shows_vertex_colors(body));
  if (shows_vertex_colors(body)) key.add(body.mesh->colors);
  return key.key();
}

}  // namespace

SampleTimes sample_times(const ExportSettings& settings, const ExportFrames& frames) {
  const int per_frame = settings.subframes + 1;
  return {static_cast<double>(frames.first), per_frame, (frames.last - frames.first) * per_frame + 1};
}

struct ExportSeries::Growing {
  Growing(std::string path, StageKey made_of) : key(std::move(made_of)), file(std::move(path)) {}

  StageKey key;
  AtomicFile file;
  ByteHasher checksum;
  std::unique_ptr<ExportWriter> writer;
  double seconds = 0;
};

ExportSeries::ExportSeries(const ExportFormat& format, const ExportSettings& settings, const ExportFrames& frames,
                           std::vector<std::size_t> bodies, ShotRun& run, Outputs& outputs)
    : format_(format),
      settings_(settings),
      frames_(frames),
      times_(sample_times(settings, frames)),
      bodies_(std::move(bodies)),
      run_(run),
      outputs_(outputs),
      camera_(export_camera(run)) {
  for (const std::size_t body : bodies_) {
    if (format.needs_look) look_keys_.push_back(look_key(export_body(settings, run, body, times_.first)));
    if (format.has_colors)
      look_keys_.push_back(KeyHasher("export colours 1").add(run.loaded(body).file_mesh.colors).key());
  }
}

ExportSeries::ExportSeries(ExportSeries&&) noexcept = default;
ExportSeries::~ExportSeries() = default;

bool ExportSeries::has(std::size_t body) const {
  return std::find(bodies_.begin(), bodies_.end(), body) != bodies_.end();
}

void ExportSeries::require_free_paths() const {
  for (int sample = 0; sample < (one_file() ? 1 : times_.count); ++sample) outputs_.require_free(path(sample));
  if (!format_.index_extension.empty()) outputs_.require_free(outputs_.path(stem() + format_.index_extension));
}

SeriesPlan ExportSeries::plan() {
  SeriesPlan plan;
  plan.of = one_file() ? 1 : times_.count;
  OutputState state = OutputState::Missing;
  for (int sample = 0; sample < times_.count; ++sample) {
    if (sample < plan.of) {
      state = outputs_.claimed_state(path(sample), key(sample));
      if (state != OutputState::Done) ++plan.missing;
      if (state == OutputState::Stale || state == OutputState::Unknown) ++plan.outdated;
    }
    if (state == OutputState::Done) continue;
    const SimulatedFrame simulated = simulated_frame(frames_, times_.per_frame, sample);
    if (simulated.is_between) plan.frames.push_back(simulated.frame - 1);
    plan.frames.push_back(simulated.frame);
  }
  return plan;
}

bool ExportSeries::wants(int sample) {
  if (wants_all_) return *wants_all_;
  const bool is_done = outputs_.is_done(path(sample), key(sample));
  if (one_file()) wants_all_ = !is_done;
  if (is_done) {
    ++counts_.kept;
    if (const auto entry = outputs_.entry(path(sample))) counts_.saved_seconds += entry->seconds;
  }
  return !is_done;
}

void ExportSeries::append(int sample, const ExportSample& data, double seconds) {
  if (!growing_) {
    growing_ = std::make_unique<Growing>(path(sample), key(sample));
    growing_->writer = format_.make(target(sample));
  }
  ExportSample own = data;
  own.body = static_cast<std::size_t>(std::find(bodies_.begin(), bodies_.end(), data.body) - bodies_.begin());
  CHECK(own.body < bodies_.size());
  growing_->writer->append(own);
  growing_->seconds += seconds;
  if (!one_file()) close();
}

void ExportSeries::close() {
  growing_->writer->finish();
  growing_->writer.reset();
  outputs_.commit(growing_->file, growing_->key, growing_->checksum.key(), growing_->seconds);
  growing_.reset();
  ++counts_.written;
}

void ExportSeries::finish() {
  if (growing_) close();
  if (!format_.index_extension.empty()) write_index();
}

/// A list of all samples, kept or written.
void ExportSeries::write_index() {
  std::vector<SeriesEntry> entries;
  for (int sample = 0; sample < times_.count; ++sample)
    entries.push_back({std::filesystem::path(path(sample)).filename().string(), times_.frame(sample),
                       times_.frame(sample) / settings_.fps});
  const std::string text = format_.make_index(entries), where = outputs_.path(stem() + format_.index_extension);
  const StageKey key = KeyHasher("series").add(format_.name).add(text).key();
  if (outputs_.is_done(where, key)) {
    ++counts_.kept;
    return;
  }
  outputs_.write(where, key, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, 0);
  ++counts_.written;
}

std::map<std::string, StageKey> ExportSeries::sample_keys() {
  std::map<std::string, StageKey> keys;
  for (int sample = 0; sample < times_.count; ++sample) keys[path(sample)] = sample_key(sample);
  return keys;
}

/// SHOT.BODY.0001.obj, or between frames SHOT.BODY.0001.500.obj.
bool ExportSeries::is_sample_path(const std::string& path) const {
  const std::string begin = outputs_.path(stem()), end = "." + format_.name;  // "DIR/SHOT.BODY."
  if (path.size() <= begin.size() + end.size() || !path.starts_with(begin) || !path.ends_with(end)) return false;
  const std::string number = path.substr(begin.size(), path.size() - begin.size() - end.size());
  return number.find_first_not_of("-.0123456789") == std::string::npos;
}

int ExportSeries::remove_outdated() {
  return one_file() ? 0 : outputs_.remove_outdated(sample_keys());
}

std::vector<std::string> ExportSeries::leftovers(ExportSeries& whole) {
  std::vector<std::string> others;
  if (one_file()) return others;
  std::map<std::string, StageKey> own = sample_keys(), all = whole.sample_keys();
  for (const std::string& path : outputs_.paths()) {
    if (!is_sample_path(path) || own.contains(path)) continue;
    const OutputState state = outputs_.claimed_state(path, all[path]);  // no key: of no sample
    if (state == OutputState::Stale) others.push_back(path);
  }
  return others;
}

std::string ExportSeries::made_line() const {
  if (one_file() || times_.count == 1) return path(0);
  return path(0) + " .. " + path(times_.count - 1);
}

/// Outputs puts the shot's name before it; "BODY." or nothing.
std::string ExportSeries::stem() const {
  return format_.file_per == FilePer::Shot ? "" : run_.settings(bodies_[0]).name + ".";
}

/// Samples between frames are numbered by thousandths of a frame, as are frames beside them, so that names sort by
/// time.
std::string ExportSeries::path(int sample) const {
  if (one_file()) return outputs_.path(stem() + format_.name);
  const int frame = frames_.first + sample / times_.per_frame;
  if (times_.per_frame == 1) return outputs_.path(fmt::format("{}{:04}.{}", stem(), frame, format_.name));
  const int thousandths = 1000 * (sample % times_.per_frame) / times_.per_frame;
  return outputs_.path(fmt::format("{}{:04}.{:03}.{}", stem(), frame, thousandths, format_.name));
}

StageKey ExportSeries::sample_key(int sample) const {
  KeyHasher key("export 5");
  key.add(format_.name).add(format_.version).add(settings_.space).add(settings_.meters_per_unit).add(settings_.up);
  key.add(settings_.normals).add(format_.has_seconds ? settings_.fps : 0.0).add(times_.frame(sample));
  const SimulatedFrame simulated = simulated_frame(frames_, times_.per_frame, sample);
  for (const std::size_t body : bodies_) {
    const BodySimulation& simulation = run_.simulation(body);
    key.add(run_.settings(body).name).add(run_.loaded(body).file_key).add(run_.loaded(body).key);
    key.add(simulation.filled_key()).add(simulation.frame_key(simulated.frame));
    if (simulated.is_between) key.add(simulation.frame_key(simulated.frame - 1));
  }
  for (const StageKey& look : look_keys_) key.add(look);
  if (format_.needs_camera) {
    const double time = times_.frame(sample), before = times_.frame(std::max(sample - 1, 0));
    add(key, camera_(time));
    key.add(aspect());
    if (const std::optional<double> cut = last_cut(run_.shot().camera, before, time)) {
      key.add("cut").add(*cut);
      add(key, camera_(*cut));
      add(key, camera_(*cut - kBeforeCut));
    }
  }
  if (format_.has_voxel) key.add(settings_.voxel);
  if (format_.names_pictures)
    for (const std::size_t body : bodies_) {
      TextureSettings textures = run_.shot().materials.at(run_.settings(body).material).textures;
      for (const std::string* path : textures.paths())
        if (!path->empty()) key.add(usda_asset(*path, outputs_.folder()));
    }
  return key.key();
}

double ExportSeries::aspect() const {
  const RenderParams& picture = run_.shot().render.params;
  return static_cast<double>(picture.width) / picture.height;
}

const StageKey& ExportSeries::whole_key() {
  if (!whole_key_.empty()) return whole_key_;
  KeyHasher all("export of all frames 1");
  for (int sample = 0; sample < times_.count; ++sample) all.add(sample_key(sample));
  whole_key_ = all.key();
  return whole_key_;
}

ExportTarget ExportSeries::target(int sample) const {
  ExportTarget target;
  target.settings = settings_;
  target.shot = run_.shot().settings.name;
  for (const std::size_t body : bodies_) target.bodies.push_back(export_body(settings_, run_, body, times_.first));
  target.times = one_file() ? times_ : SampleTimes{times_.frame(sample), 1, 1};
  target.camera = camera_;
  target.camera_cut = [&run = run_](double after, double until) { return last_cut(run.shot().camera, after, until); };
  target.aspect = aspect();
  target.sink = [growing = growing_.get()](std::span<const std::uint8_t> bytes) {
    growing->checksum.add(bytes);
    growing->file.write(bytes);
  };
  target.threads = &run_.context().threads;
  target.folder = outputs_.folder();
  return target;
}

}  // namespace softreel
