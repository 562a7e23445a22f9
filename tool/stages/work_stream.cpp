#include "tool/stages/work_stream.h"

namespace softreel {

BehindStream::BehindStream(std::size_t depth) : depth_(depth) {
  if (depth > 0) thread_ = std::thread([this] { run(); });
}

BehindStream::~BehindStream() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void BehindStream::submit(std::function<void()> job) {
  if (depth_ == 0) return job();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return jobs_.size() < depth_ || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  jobs_.push_back(std::move(job));
  lock.unlock();
  changed_.notify_all();
}

void BehindStream::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return jobs_.empty() || failure_; });
  if (failure_) std::rethrow_exception(failure_);
}

void BehindStream::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return !jobs_.empty() || ended_; });
    if (jobs_.empty()) return;
    std::exception_ptr failure;
    const std::function<void()>& job = jobs_.front();  // stays in its place while others are added
    lock.unlock();
    try {
      job();
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    jobs_.pop_front();
    if (failure) {
      failure_ = failure;
      jobs_.clear();
    }
    changed_.notify_all();
    if (failure) return;
  }
}

}  // namespace softreel
