#include "camera_self_calibration/rig/synchronised_views.h"

#include <algorithm>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/base/stamp.h"

namespace camera_self_calibration {
namespace {

// Of one camera while another one is slow or silent: more than threads and queues hold back.
constexpr std::size_t kMaxWaiting = 30;
constexpr std::int64_t kMaxCounted = 1000;

}  // namespace

std::optional<std::vector<TimedView>> SynchronisedViews::add(int camera, TimedView view) {
  std::deque<TimedView>& own = waiting_[camera];
  if (!own.empty() && view.stamp_ns < own.back().stamp_ns) {
    for (std::deque<TimedView>& views : waiting_) views.clear();
  }
  own.push_back(std::move(view));
  if (own.size() > kMaxWaiting) own.pop_front();
  return take();
}

bool SynchronisedViews::complete() const {
  return std::none_of(waiting_.begin(), waiting_.end(),
                      [](const std::deque<TimedView>& views) { return views.empty(); });
}

std::optional<std::vector<TimedView>> SynchronisedViews::take() {
  const auto earlier = [](const std::deque<TimedView>& a, const std::deque<TimedView>& b) {
    return a.front().stamp_ns < b.front().stamp_ns;
  };
  while (complete()) {
    const auto [first, last] = std::minmax_element(waiting_.begin(), waiting_.end(), earlier);
    const std::int64_t gap = last->front().stamp_ns - first->front().stamp_ns;
    if (gap > kToleranceNs) {
      leaveOut(&*first, gap);
      continue;
    }
    std::vector<TimedView> set;
    for (std::deque<TimedView>& views : waiting_) {
      set.push_back(std::move(views.front()));
      views.pop_front();
    }
    last_gap_ = kNoGap;
    ++sets_;
    fade();
    return set;
  }
  return std::nullopt;
}

void SynchronisedViews::leaveOut(std::deque<TimedView>* views, std::int64_t gap) {
  // A view stands between two of another camera: the nearer one counts.
  nearest_s_.push_back(toSeconds(std::min(gap, last_gap_)));
  last_gap_ = gap;
  ++unmatched_;
  views->pop_front();
  fade();
}

void SynchronisedViews::fade() {
  if (sets_ + unmatched_ < kMaxCounted) return;
  sets_ /= 2;
  unmatched_ /= 2;
  nearest_s_.erase(nearest_s_.begin(), nearest_s_.end() - unmatched_);
}

std::string SynchronisedViews::problem() const {
  const auto cameras = static_cast<std::int64_t>(waiting_.size());
  if (sets_ * cameras >= unmatched_) return {};
  return formatted(
      "the images of the cameras are not taken at once: their stamps differ by %.1f ms (median), "
      "and 1 ms is allowed. Trigger the cameras together, or let their stamps say when they took "
      "the images",
      1e3 * median(std::vector<double>(nearest_s_.begin(), nearest_s_.end()), 0.0));
}

}  // namespace camera_self_calibration
