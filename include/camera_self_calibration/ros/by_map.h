#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace camera_self_calibration {

/// What is kept of each map: of the present one, and of those that were left and may be found
/// again. Of more than `max_maps` maps the smallest that was left is forgotten. `Content` is made
/// without arguments and has a size().
template <typename Content>
class ByMap {
 public:
  /// `max_maps` is at least 1.
  explicit ByMap(std::size_t max_maps = 8) : max_maps_(max_maps) {}

  /// This map is the present one from now on, as it was when it was left, or else empty.
  Content& enter(std::uint64_t map_id) {
    present_ = map_id;
    contents_[map_id];
    while (contents_.size() > max_maps_) forgetSmallest();
    return contents_[map_id];
  }

  Content& present() { return contents_[present_]; }
  const Content& present() const {
    static const Content kNothing;
    const auto found = contents_.find(present_);
    return found == contents_.end() ? kNothing : found->second;
  }

  /// One map goes on in another: `merge(Content left, Content* into)` brings them together.
  template <typename Merge>
  void join(std::uint64_t from, std::uint64_t to, const Merge& merge) {
    const auto found = contents_.find(from);
    if (found == contents_.end() || from == to) return;
    Content left = std::move(found->second);
    contents_.erase(found);
    merge(std::move(left), &contents_[to]);
    if (present_ == from) present_ = to;
  }

 private:
  void forgetSmallest() {
    auto smallest = contents_.end();
    for (auto i = contents_.begin(); i != contents_.end(); ++i) {
      if (i->first == present_) continue;
      if (smallest == contents_.end() || i->second.size() < smallest->second.size()) smallest = i;
    }
    contents_.erase(smallest);
  }

  std::size_t max_maps_;
  std::uint64_t present_ = 0;
  std::map<std::uint64_t, Content> contents_;  // by map_id
};

}  // namespace camera_self_calibration
