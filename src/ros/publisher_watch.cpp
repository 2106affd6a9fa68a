#include "camera_self_calibration/ros/publisher_watch.h"

#include <utility>

namespace camera_self_calibration {

std::string PublisherWatch::check(const std::string& publisher) {
  if (current_.empty()) current_ = publisher;
  if (publisher == current_) {
    of_rival_ = 0;
    return {};
  }
  // Whoever comes back was there all the time.
  if (rival_.empty() && publisher == previous_) {
    rival_ = std::exchange(current_, publisher);
    return {};
  }
  if (publisher == rival_ && ++of_rival_ <= kPatience) {
    return "two nodes publish images on the topic, " + current_ + " and " + publisher +
           "; those of " + current_ + " are used: give each camera a topic of its own";
  }
  previous_ = std::exchange(current_, publisher);
  rival_.clear();
  of_rival_ = 0;
  return {};
}

}  // namespace camera_self_calibration
