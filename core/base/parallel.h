/// Parallel loops and ordered sums whose results do not depend on the number of threads (design sec. 4.6).
///
/// Work is cut by the data: chunk k covers [k * grain, (k + 1) * grain), whatever the thread count. Sums add one
/// partial result per chunk, in the order of the chunks.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>

namespace softreel {

/// A fixed number of threads that loops run on; passed by reference, never global.
class Threads {
 public:
  using ChunkBody = std::function<void(std::int64_t begin, std::int64_t end)>;
  using ChunkSum = std::function<double(std::int64_t begin, std::int64_t end)>;

  /// count: number of threads, at least 1; 0 takes all processors of the machine. stop: once it is set, loops that are
  /// begun or under way end with an Error of kind Interrupt, so that whatever works through them can be stopped.
  explicit Threads(int count = 0, const std::atomic<bool>* stop = nullptr);
  ~Threads();
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  int count() const noexcept { return count_; }

  /// Runs body on every chunk of [0, n). An exception thrown by a body is rethrown here: of several, the one of the
  /// first chunk, so that the message does not depend on timing.
  void for_chunks(std::int64_t n, std::int64_t grain, const ChunkBody& body) const;

  /// Sum of body over all chunks of [0, n), added in the order of the chunks.
  double sum_chunks(std::int64_t n, std::int64_t grain, const ChunkSum& body) const;

  /// Runs `work` so that a library's own parallel loops (Embree) use these threads only.
  void run(const std::function<void()>& work) const;

 private:
  struct Arena;
  void stop_if_asked() const;

  int count_;
  const std::atomic<bool>* stop_;
  std::unique_ptr<Arena> arena_;
};

}  // namespace softreel
