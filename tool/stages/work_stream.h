/// Stages side by side: one thread works ahead of, or behind, the one that owns it, by a bounded number of items.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

namespace softreel {

/// Makes items in order on a thread of its own, at most `depth` ahead of who takes them; with depth 0 when they are
/// taken, on the taking thread.
template <typename T>
class AheadStream {
 public:
  /// make: the next item, or nothing at the end. What it throws comes out of `next` in the item's place.
  AheadStream(std::size_t depth, std::function<std::optional<T>()> make) : depth_(depth), make_(std::move(make)) {
    if (depth > 0) thread_ = std::thread([this] { run(); });
  }
  /// Waits for the item that is being made.
  ~AheadStream() {
    {
      const std::lock_guard lock(mutex_);
      abandoned_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  AheadStream(const AheadStream&) = delete;
  AheadStream& operator=(const AheadStream&) = delete;

  std::optional<T> next() {
    if (depth_ == 0) return make_();
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !items_.empty() || ended_; });
    if (items_.empty()) {
      if (failure_) std::rethrow_exception(failure_);
      return std::nullopt;
    }
    T item = std::move(items_.front());
    items_.pop_front();
    lock.unlock();
    changed_.notify_all();
    return item;
  }

 private:
  void run() {
    try {
      while (put(make_())) continue;
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      ended_ = true;
    }
    changed_.notify_all();
  }

  /// False at the end.
  bool put(std::optional<T> item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return items_.size() < depth_ || abandoned_; });
    ended_ = !item || abandoned_;
    if (!ended_) items_.push_back(std::move(*item));
    const bool more = !ended_;
    lock.unlock();
    changed_.notify_all();
    return more;
  }

  std::size_t depth_;
  std::function<std::optional<T>()> make_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> items_;
  std::exception_ptr failure_;
  bool ended_ = false, abandoned_ = false;
  std::thread thread_;
};

/// Does jobs in order on a thread of its own, at most `depth` behind; with depth 0 at once, on the calling thread.
class BehindStream {
 public:
  explicit BehindStream(std::size_t depth);
  /// Waits for the jobs that were submitted; what they throw is lost unless `finish` was called.
  ~BehindStream();
  BehindStream(const BehindStream&) = delete;
  BehindStream& operator=(const BehindStream&) = delete;

  /// Throws what an earlier job threw; no job after it is done.
  void submit(std::function<void()> job);
  /// Waits until all jobs are done. Throws what one threw.
  void finish();

 private:
  void run();

  std::size_t depth_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;  ///< the front one is being done
  std::exception_ptr failure_;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace softreel
