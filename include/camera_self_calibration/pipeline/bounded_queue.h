#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>

namespace camera_self_calibration {

/// A queue between two threads that never holds more than `capacity` items: the oldest gives way.
template <typename Item>
class BoundedQueue {
 public:
  explicit BoundedQueue(std::size_t capacity) : capacity_(capacity) {}

  /// False if an older item was dropped for this one.
  bool push(Item item) {
    std::lock_guard<std::mutex> lock(mutex_);
    const bool full = items_.size() >= capacity_;
    if (full) items_.pop_front();
    items_.push_back(std::move(item));
    changed_.notify_all();
    return !full;
  }

  /// Waits for an item; none once the queue is closed. The taker is busy until it calls pop again.
  std::optional<Item> pop() {
    std::unique_lock<std::mutex> lock(mutex_);
    busy_ = false;
    changed_.notify_all();
    changed_.wait(lock, [this] { return closed_ || !items_.empty(); });
    if (closed_) return std::nullopt;
    Item item = std::move(items_.front());
    items_.pop_front();
    busy_ = true;
    return item;
  }

  /// Waits until there is no item and its taker waits for the next.
  void waitUntilIdle() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || (items_.empty() && !busy_); });
  }

  /// Wakes everybody up; items still waiting are not delivered.
  void close() {
    std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  const std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  bool busy_ = false;
  bool closed_ = false;
};

}  // namespace camera_self_calibration
