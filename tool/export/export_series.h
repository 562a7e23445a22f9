/// The files that one format makes of one body, or of the whole shot: which are kept, which grow, which are done.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tool/cache/atomic_file.h"
#include "tool/export/exporter.h"
#include "tool/outputs/outputs.h"
#include "tool/stages/shot_run.h"

namespace softreel {

/// The frames of an export, both included.
struct ExportFrames {
  int first = 1, last = 1;
};

/// What a series cost and saved.
struct SeriesCounts {
  int written = 0, kept = 0;
  double saved_seconds = 0;
};

/// What is left to do for a series.
struct SeriesPlan {
  std::vector<int> frames;  ///< of the simulation, that samples are made of
  int missing = 0, of = 0;  ///< files
  int outdated = 0;         ///< files that would be removed or replaced
};

/// Samples come in order of time; a file under construction has no name before it is whole.
class ExportSeries {
 public:
  /// bodies: of the run, one or all. run and outputs are kept by reference.
  ExportSeries(const ExportFormat& format, const ExportSettings& settings, const ExportFrames& frames,
               std::vector<std::size_t> bodies, ShotRun& run, Outputs& outputs);
  ExportSeries(ExportSeries&&) noexcept;
  ~ExportSeries();

  const ExportFormat& format() const { return format_; }
  bool has(std::size_t body) const;
  /// Throws input_error if any of its files is one that the shot reads.
  void require_free_paths() const;
  /// False if the file that holds this sample is there, made of the same.
  bool wants(int sample);
  /// What finishing it would take and remove, without reading a file of it.
  SeriesPlan plan();
  /// A wanted sample; sample.body counts in the run. seconds: what making it took.
  void append(int sample, const ExportSample& data, double seconds);
  /// After the last sample.
  void finish();

  /// Of a file per sample: removes what is under their names and not theirs, so that a killed run leaves no mixture.
  /// Returns how many.
  int remove_outdated();
  /// Of a file per sample: finished files of this name that are of none of its samples, nor of those of `whole`, the
  /// series of all frames of the shot. They are of an older state of the shot, or of other sub-frames.
  std::vector<std::string> leftovers(ExportSeries& whole);

  /// "FIRST .. LAST", or the file.
  std::string made_line() const;
  const SeriesCounts& counts() const { return counts_; }

 private:
  /// A file that grows sample by sample.
  struct Growing;

  bool one_file() const { return format_.file_per != FilePer::Sample; }
  std::string stem() const;
  std::string path(int sample) const;
  std::map<std::string, StageKey> sample_keys();  ///< by path
  bool is_sample_path(const std::string& path) const;
  StageKey sample_key(int sample) const;
  double aspect() const;  ///< of the picture, width over height
  const StageKey& whole_key();
  StageKey key(int sample) { return one_file() ? whole_key() : sample_key(sample); }
  ExportTarget target(int sample) const;
  void close();
  void write_index();

  const ExportFormat& format_;
  ExportSettings settings_;
  ExportFrames frames_;
  SampleTimes times_;
  std::vector<std::size_t> bodies_;
  ShotRun& run_;
  Outputs& outputs_;
  std::function<Camera(double frame)> camera_;
  std::vector<StageKey> look_keys_;  ///< per body: its look, its mesh's colours; what the format has of them
  StageKey whole_key_;               ///< empty until it is needed
  std::optional<bool> wants_all_;    ///< of a single file
  std::unique_ptr<Growing> growing_;
  SeriesCounts counts_;
};

/// When an export's samples are taken.
SampleTimes sample_times(const ExportSettings& settings, const ExportFrames& frames);

}  // namespace softreel
