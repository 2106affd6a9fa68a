#include "camera_self_calibration/tools/synchronised_images.h"

#include <algorithm>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/median.h"

namespace camera_self_calibration {

SynchronisedImages::SynchronisedImages(std::vector<ImageSource> sources)
    : sources_(std::move(sources)), monitors_(sources_.size()), waiting_(sources_.size()) {
  for (InputMonitor& monitor : monitors_) monitor.takeZeroAsTime();
}

bool SynchronisedImages::load(std::size_t camera) {
  while (!waiting_[camera]) {
    const std::optional<GrayImage> image = sources_[camera].next();
    if (!image) return false;
    if (monitors_[camera].check(*image) == InputVerdict::kUse) waiting_[camera] = image->view;
  }
  return true;
}

std::optional<std::vector<ImageView>> SynchronisedImages::next() {
  while (true) {
    for (std::size_t c = 0; c < sources_.size(); ++c) {
      if (!load(c)) return std::nullopt;
    }
    const auto earlier = [](const auto& a, const auto& b) { return a->stamp_ns < b->stamp_ns; };
    const auto [first, last] = std::minmax_element(waiting_.begin(), waiting_.end(), earlier);
    const std::int64_t gap = (*last)->stamp_ns - (*first)->stamp_ns;
    if (gap > kToleranceNs) {
      // An image stands between two of another camera: the nearer one counts.
      nearest_s_.push_back(1e-9 * static_cast<double>(std::min(gap, last_gap_)));
      last_gap_ = gap;
      ++unmatched_;
      first->reset();
      continue;
    }
    std::vector<ImageView> images;
    for (std::optional<ImageView>& image : waiting_) {
      images.push_back(*image);
      image.reset();
    }
    last_gap_ = kNoGap;
    ++sets_;
    return images;
  }
}

std::string SynchronisedImages::problem() const {
  const auto cameras = static_cast<std::int64_t>(sources_.size());
  if (sets_ * cameras >= unmatched_) return {};
  return formatted(
      "the images of the cameras are not taken at once: their stamps differ by %.1f ms (median), "
      "and 1 ms is allowed. Trigger the cameras together, or let their stamps say when they took "
      "the "
      "images",
      1e3 * median(nearest_s_, 0.0));
}

}  // namespace camera_self_calibration
