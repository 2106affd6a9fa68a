#include "camera_self_calibration/ros/publisher_watch.h"

#include <algorithm>

namespace camera_self_calibration {

std::string PublisherWatch::check(const std::string& name) {
  ++images_;
  Publisher* publisher = find(name);
  const bool known = publisher != nullptr && (publisher->beside || isThere(*publisher));
  if (!known) publisher = begin(name);
  publisher->last = images_;
  if (name == current_) return {};
  Publisher* current = find(current_);
  const bool gone = !isThere(*current);
  // Whoever comes back was there all the time: it was the other one that came beside it.
  const bool was_before = !publisher->beside && publisher < current;
  if (!gone && !was_before) {
    publisher->beside = true;
    return problem();
  }
  current->beside = !gone;
  publisher->beside = false;
  current_ = name;
  return {};
}

PublisherWatch::Publisher* PublisherWatch::find(const std::string& name) {
  const auto found = std::find_if(recent_.begin(), recent_.end(),
                                  [&name](const Publisher& p) { return p.name == name; });
  return found != recent_.end() ? &*found : nullptr;
}

bool PublisherWatch::isThere(const Publisher& publisher) const {
  return images_ - publisher.last <= kPatience;
}

// As a camera that is started anew, whose images are used at once.
PublisherWatch::Publisher* PublisherWatch::begin(const std::string& name) {
  const auto with_name = [&name](const Publisher& p) { return p.name == name; };
  const auto older = [](const Publisher& a, const Publisher& b) { return a.last < b.last; };
  recent_.erase(std::remove_if(recent_.begin(), recent_.end(), with_name), recent_.end());
  if (recent_.size() == kMostPublishers) {
    recent_.erase(std::min_element(recent_.begin(), recent_.end(), older));
  }
  recent_.push_back({name});
  current_ = name;
  return &recent_.back();
}

std::string PublisherWatch::problem() const {
  std::vector<std::string> names = {current_};
  for (const Publisher& publisher : recent_) {
    if (publisher.beside && isThere(publisher)) names.push_back(publisher.name);
  }
  std::string all = names.front();
  for (std::size_t i = 1; i < names.size(); ++i) {
    all += (i + 1 < names.size() ? ", " : " and ") + names[i];
  }
  return std::to_string(names.size()) + " nodes publish images on the topic, " + all +
         "; those of " + current_ + " are used: give each camera a topic of its own";
}

}  // namespace camera_self_calibration
