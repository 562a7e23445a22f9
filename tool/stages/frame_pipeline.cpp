#include "tool/stages/frame_pipeline.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "core/base/timer.h"
#include "tool/cache/stage_names.h"
#include "tool/stages/work_stream.h"

namespace softreel {
namespace {

/// Frames that are ready before they can be traced, or traced before they can be written.
constexpr std::size_t kDepth = 2;

/// A frame that is there already, or what is to be traced.
struct FrameJob {
  int frame = 0;
  std::optional<PictureSource> source;  ///< none: trace the scene
  Scene scene;
  StageKey content;
};

class Pipeline {
 public:
  Pipeline(ShotRun& run, SceneStage& scenes, PictureStage& pictures, CacheUse& use, const FrameDone& done)
      : run_(run),
        scenes_(scenes),
        pictures_(pictures),
        use_(use),
        done_(done),
        depth_(run.context().threads.count() > 1 ? kDepth : 0),
        writer_(depth_) {}

  PictureCounts run(int first, int last) {
    {
      int next = first;
      AheadStream<FrameJob> ahead(depth_, [&]() -> std::optional<FrameJob> {
        if (next > last) return std::nullopt;
        return prepare(next++);
      });
      while (auto job = next_job(ahead))
        if (!finish(*job)) busy_.push_back(job->frame);
    }
    for (const int frame : busy_) wait_for(frame);
    writer_.finish();
    return counts_;
  }

 private:
  std::optional<FrameJob> next_job(AheadStream<FrameJob>& ahead) {
    try {
      return ahead.next();
    } catch (...) {
      writer_.finish();  // the frames before are kept
      throw;
    }
  }

  FrameJob prepare(int frame) {
    run_.context().stop_if_cancelled();
    FrameJob job;
    job.frame = frame;
    const StageKey trace = pictures_.trace_key(frame);
    if (pictures_.is_kept(frame)) {
      job.source = PictureSource::Kept;
    } else if (pictures_.recall(frame, trace)) {
      job.source = sent_.count(trace) > 0 ? PictureSource::Linked : PictureSource::Recalled;
    } else if (pictures_.develop(frame, trace)) {
      job.source = sent_.count(trace) > 0 ? PictureSource::Linked : PictureSource::Developed;
    } else {
      sent_.insert(trace);
      job.scene = scenes_.at(frame, run_.skin(frame, skin_request(run_.shot().render)));
      job.content = scenes_.content_key(frame, job.scene);
      const bool is_own = !prepared_.insert(job.content).second;
      job.source = recall_equal(frame, job.content, is_own);
    }
    return job;
  }

  /// is_own: this run traces it, so that what may be found half stored is not developed from an earlier run.
  std::optional<PictureSource> recall_equal(int frame, const StageKey& content, bool is_own = false) {
    if (pictures_.recall(frame, content)) return PictureSource::Linked;
    if (pictures_.develop(frame, content)) return is_own ? PictureSource::Linked : PictureSource::Developed;
    return std::nullopt;
  }

  /// False if another process is tracing the same picture.
  bool finish(FrameJob& job) {
    if (!job.source && traced_.count(job.content) > 0) {
      writer_.finish();
      job.source = recall_equal(job.frame, job.content, true);
    }
    if (!job.source && !trace(job)) return false;
    count(job.frame, *job.source);
    return true;
  }

  bool trace(FrameJob& job) {
    run_.context().stop_if_cancelled();
    auto claim = run_.context().cache.try_claim(kPictureStage, job.content);
    if (!claim) return false;
    job.source = recall_equal(job.frame, job.content);  // another process may just have finished it
    if (job.source) return true;
    const auto start = std::chrono::steady_clock::now();
    auto image = std::make_shared<const Image>(pictures_.trace(job.scene));
    const double seconds = seconds_since(start);
    auto held = std::make_shared<const FileLock>(std::move(*claim));
    writer_.submit([this, frame = job.frame, content = job.content, image, held, seconds] {
      pictures_.keep(frame, content, *image, seconds);
    });
    traced_.insert(job.content);
    job.source = PictureSource::Traced;
    return true;
  }

  void wait_for(int frame) {
    FrameJob job = prepare(frame);
    while (!finish(job)) {
      run_.context().stop_if_cancelled();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      job.source = recall_equal(frame, job.content);
    }
  }

  void count(int frame, PictureSource source) {
    if (source == PictureSource::Kept) ++counts_.kept;
    if (source == PictureSource::Recalled) ++counts_.recalled;
    if (source == PictureSource::Developed) ++counts_.developed;
    if (source == PictureSource::Linked) ++counts_.linked;
    if (source == PictureSource::Traced) ++counts_.traced;
    if (source != PictureSource::Traced) counts_.saved_seconds += pictures_.seconds(frame);
    // The frame before is needed no more, not even for motion blur, but for a busy one that may have to be made yet.
    const bool is_needed =
        std::any_of(busy_.begin(), busy_.end(), [&](int busy) { return std::abs(busy - (frame - 1)) <= 1; });
    if (!is_needed && frame > run_.shot().settings.first_frame)
      for (std::size_t b = 0; b < run_.body_count(); ++b)
        use_.release(cache_item(kSimulationStage, run_.simulation(b).frame_key(frame - 1)));
    done_(frame, source);
  }

  ShotRun& run_;
  SceneStage& scenes_;
  PictureStage& pictures_;
  CacheUse& use_;
  const FrameDone& done_;
  std::size_t depth_;
  std::vector<int> busy_;        ///< frames that other processes are tracing
  std::set<StageKey> sent_;      ///< trace keys of frames that this run sent to be traced; of the preparing thread
  std::set<StageKey> prepared_;  ///< contents that this run has asked for; of the preparing thread
  std::set<StageKey> traced_;    ///< contents of this run
  PictureCounts counts_;
  BehindStream writer_;  ///< last: its jobs use the others
};

}  // namespace

PictureCounts& PictureCounts::operator+=(const PictureCounts& other) {
  kept += other.kept;
  recalled += other.recalled;
  developed += other.developed;
  linked += other.linked;
  traced += other.traced;
  saved_seconds += other.saved_seconds;
  return *this;
}

PictureCounts make_pictures(ShotRun& run, SceneStage& scenes, PictureStage& pictures, int first, int last,
                            CacheUse& use, const FrameDone& done) {
  return Pipeline(run, scenes, pictures, use, done).run(first, last);
}

}  // namespace softreel
