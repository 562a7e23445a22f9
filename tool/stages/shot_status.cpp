#include "tool/stages/shot_status.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/bodies/simulate_key.h"
#include "tool/cache/stage_names.h"
#include "tool/shot/shot_load.h"
#include "tool/stages/movie_stage.h"
#include "tool/stages/picture_stage.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/settings_snapshot.h"
#include "tool/stages/sheet_stage.h"
#include "tool/stages/shot_run.h"

namespace softreel {
namespace {

/// Identifies a result among all that a shot makes: stage, body or extension, frame (0 where there is one only).
struct ResultName {
  std::string stage, what;
  int frame = 0;

  friend auto operator<=>(const ResultName&, const ResultName&) = default;
};

using ResultKeys = std::map<ResultName, StageKey>;

constexpr const char* kPictures = "pictures";
constexpr const char* kMovie = "movie";
constexpr const char* kSheet = "sheet";

/// Keys of all results of a shot.
ResultKeys find_keys(ShotRun& run, Outputs& outputs) {
  ResultKeys keys;
  const Shot& shot = run.shot();
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    const std::string& name = run.settings(b).name;
    if (shot.dial.is_on()) keys[{kDialStage, name, 0}] = run.dial_key(b);
    keys[{kTetrahedraStage, name, 0}] = run.simulation(b).filled_key();
    for (int frame = first_simulated_frame(shot); frame <= shot.settings.last_frame; ++frame)
      keys[{kSimulationStage, name, frame}] = run.simulation(b).frame_key(frame);
  }
  const SceneStage scenes(run);
  const PictureStage pictures(scenes, shot, outputs, run.context());
  for (int frame = shot.settings.first_frame; frame <= shot.settings.last_frame; ++frame)
    for (const PictureStage::File& file : pictures.files(frame, pictures.trace_key(frame)))
      keys[{kPictures, file.extension, frame}] = file.key;
  return keys;
}

class StatusFinder {
 public:
  StatusFinder(const Shot& shot, Outputs& outputs, const RunContext& context)
      : shot_(shot),
        outputs_(outputs),
        context_(context),
        quiet_{context.threads, no_log_, context.times, context.cache, context.cancelled} {}

  std::vector<StageStatus> find() {
    ShotRun run(shot_, quiet_, DialUse::LookUp);
    keys_ = find_keys(run, outputs_);
    now_ = snapshot(run);
    for (const auto& [name, key] : keys_) {
      context_.stop_if_cancelled();
      StageStatus& status = status_of(name);
      const Condition condition = name.stage == kPictures ? picture_condition(name, key) : stored_condition(name, key);
      status.frames[condition].push_back(name.frame);
      if (condition == Condition::Stale) explain(status, name, key);
    }
    for (StageStatus& status : statuses_)
      if (status.frames.contains(Condition::Stale) && status.reasons.empty())
        status.cause = status.cause.empty() ? "another version of softreel made it" : status.cause;
    release_unneeded();
    add_movie();
    add_sheet();
    const auto place = [](const StageStatus& status) {
      constexpr std::array kOrder{kDialStage, kTetrahedraStage, kSimulationStage, kPictures, kMovie, kSheet};
      return std::find(kOrder.begin(), kOrder.end(), status.stage) - kOrder.begin();
    };
    std::stable_sort(statuses_.begin(), statuses_.end(),
                     [&](const StageStatus& a, const StageStatus& b) { return place(a) < place(b); });
    return std::move(statuses_);
  }

 private:
  StageStatus& status_of(const ResultName& name) {
    for (StageStatus& status : statuses_)
      if (status.stage == name.stage && status.what == name.what) return status;
    statuses_.push_back({name.stage, name.what, {}, name.stage != kTetrahedraStage && name.stage != kDialStage, {}});
    return statuses_.back();
  }

  Condition stored_condition(const ResultName& name, const StageKey& key) {
    if (context_.cache.has(name.stage, key))
      return context_.cache.damage(name.stage, key).empty() ? Condition::Done : Condition::Damaged;
    const auto before = keys_at(outputs_.simulated_settings());
    const auto old_key = before ? before->find(name) : ResultKeys::const_iterator();
    const bool stale =
        before && old_key != before->end() && old_key->second != key && context_.cache.has(name.stage, old_key->second);
    return stale ? Condition::Stale : Condition::Missing;
  }

  Condition picture_condition(const ResultName& name, const StageKey& key) {
    switch (outputs_.state(outputs_.frame_path(name.frame, name.what), key)) {
      case OutputState::Done:
        return Condition::Done;
      case OutputState::Damaged:
        return Condition::Damaged;
      case OutputState::Missing:
        return Condition::Missing;
      case OutputState::Unknown:
        status_of(name).cause =
            "the manifest does not know it: it is damaged or lost, or another program made the files";
        break;
      case OutputState::Stale:
        break;
    }
    return Condition::Stale;
  }

  /// Fields that change this result's key when they alone are put back to what they were.
  void explain(StageStatus& status, const ResultName& name, const StageKey& key) {
    std::string id = outputs_.simulated_settings();
    if (name.stage == kPictures) {
      const auto entry = outputs_.entry(outputs_.frame_path(name.frame, name.what));
      id = entry ? entry->settings : "";
    }
    for (const Undone& change : changes_since(id)) {
      const auto undone = change.keys.find(name);
      // The content of a picture cannot be undone, but it concerns pictures only.
      const bool concerns = change.is_known || change.is_mesh || name.stage == kPictures;
      const bool matters = concerns && (!change.is_known || undone == change.keys.end() || undone->second != key);
      if (matters) status.reasons[change.reason].push_back(name.frame);
    }
  }

  /// A change, and all keys as they would be without it.
  struct Undone {
    StaleReason reason;
    ResultKeys keys;
    bool is_known = false;  ///< keys are; else the old file is gone
    bool is_mesh = false;   ///< a change of a mesh file's content
  };

  const std::vector<Undone>& changes_since(const std::string& id) {
    if (const auto known = undone_.find(id); known != undone_.end()) return known->second;
    std::vector<Undone>& changes = undone_[id];
    const auto before = outputs_.settings(id);
    if (!before) return changes;
    for (const FieldChange& change : find_changes(*before, now_)) {
      Undone& undone =
          changes.emplace_back(Undone{{change.field, change.before, change.after}, {}, false, change.is_mesh});
      if (!change.undone) continue;
      if (auto keys = keys_of(*change.undone)) {
        undone.keys = std::move(*keys);
        undone.is_known = true;
      }
    }
    return changes;
  }

  std::optional<ResultKeys> keys_of(const TomlValue& document) {
    try {
      const Shot shot = parse_shot(shot_.path, document);
      ShotRun run(shot, quiet_, DialUse::LookUp);
      return find_keys(run, outputs_);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::Interrupt) throw;
      return std::nullopt;  // a mesh that is gone, say
    }
  }

  /// Keys of the shot as the manifest remembers it; null if it does not.
  const ResultKeys* keys_at(const std::string& id) {
    if (const auto known = past_.find(id); known != past_.end()) return known->second ? &*known->second : nullptr;
    const auto settings = outputs_.settings(id);
    std::optional<ResultKeys>& keys = past_[id];
    if (settings) keys = keys_of(parse_toml(settings->at("shot"), "the manifest's settings"));
    return keys ? &*keys : nullptr;
  }

  /// Where all pictures are there, nothing asks for the states and tetrahedra that led to them.
  void release_unneeded() {
    const auto is_picture = [](const StageStatus& status) { return status.stage == kPictures; };
    if (std::none_of(statuses_.begin(), statuses_.end(), is_picture)) return;
    for (const StageStatus& status : statuses_)
      if (is_picture(status) && !status.done()) return;
    for (StageStatus& status : statuses_) {
      for (const Condition condition : {Condition::Stale, Condition::Missing}) {
        const auto found = status.frames.find(condition);
        if (is_picture(status) || found == status.frames.end()) continue;
        std::vector<int>& unneeded = status.frames[Condition::NotNeeded];
        unneeded.insert(unneeded.end(), found->second.begin(), found->second.end());
        std::sort(unneeded.begin(), unneeded.end());
        status.frames.erase(condition);
      }
      if (is_picture(status)) continue;
      status.reasons.clear();
      status.cause.clear();
    }
  }

  void add_movie() {
    const ShotSettings& settings = shot_.settings;
    if (!shot_.output.movie || !shot_.output.png || settings.first_frame == settings.last_frame) return;
    StageStatus status{kMovie, "mp4", {}, false, {}};
    take_state(movie_state(shot_, settings.first_frame, settings.last_frame, outputs_), status);
    statuses_.push_back(std::move(status));
  }

  void add_sheet() {
    if (!shot_.output.contact_sheet || !shot_.output.png) return;
    StageStatus status{kSheet, "png", {}, false, {}};
    const std::vector<int> frames =
        sheet_frames(shot_.settings.first_frame, shot_.settings.last_frame, SheetOptions().count);
    take_state(sheet_state(shot_, frames, SheetOptions().columns, outputs_), status);
    statuses_.push_back(std::move(status));
  }

  /// Of a file that is made of all pictures. One that nobody knows is not of this shot.
  void take_state(OutputState state, StageStatus& status) const {
    const bool whole = state == OutputState::Done && pictures_done();
    const Condition condition = state == OutputState::Missing   ? Condition::Missing
                                : state == OutputState::Damaged ? Condition::Damaged
                                : whole                         ? Condition::Done
                                                                : Condition::Stale;
    status.frames[condition] = {0};
    if (condition != Condition::Stale) return;
    if (!pictures_done())
      status.cause = "not all pictures that it shows are done";
    else if (state == OutputState::Unknown)
      status.cause = "another program made it";
    else
      status.cause = "it was made of other pictures, or with other settings";
  }

  bool pictures_done() const {
    return std::all_of(statuses_.begin(), statuses_.end(), [](const StageStatus& status) {
      return status.stage != kPictures || status.what != "png" || status.done();
    });
  }

  const Shot& shot_;
  Outputs& outputs_;
  const RunContext& context_;
  const Log no_log_;
  RunContext quiet_;
  ResultKeys keys_;
  SettingsSnapshot now_;
  std::vector<StageStatus> statuses_;
  std::map<std::string, std::vector<Undone>> undone_;      ///< by id of settings
  std::map<std::string, std::optional<ResultKeys>> past_;  ///< by id of settings
};

}  // namespace

std::vector<StageStatus> find_status(const Shot& shot, Outputs& outputs, const RunContext& context) {
  return StatusFinder(shot, outputs, context).find();
}

std::string frame_ranges(const std::vector<int>& frames) {
  std::string text;
  for (std::size_t first = 0, last = 0; first < frames.size(); first = last + 1) {
    last = first;
    while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", frames[first]);
    if (last > first) text += fmt::format("-{}", frames[last]);
  }
  return text;
}

}  // namespace softreel
