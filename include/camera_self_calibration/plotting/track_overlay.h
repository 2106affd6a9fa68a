#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "camera_self_calibration/plotting/palette.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// Where the live tracks were in the last images. Bounded: ended tracks are forgotten.
class TrackTrails {
 public:
  struct Trail {
    std::deque<Eigen::Vector2d> pixels;  ///< Oldest first, the newest is the last.
    int images = 0;                      ///< In how many images the track was seen since add().
  };

  explicit TrackTrails(std::size_t max_pixels = 8) : max_pixels_(max_pixels) {}

  void add(const TrackedFrame& frame);
  void clear() { trails_.clear(); }
  const std::map<std::int64_t, Trail>& trails() const { return trails_; }

 private:
  std::size_t max_pixels_;
  std::map<std::int64_t, Trail> trails_;  // by track id
};

/// What stands in the corner of a picture, with a dot in the colour of the state.
struct Caption {
  Colour colour;
  std::string text;
};

/// The gray image (8 bits) in BGR, with the tracks on it: a dot where each is, a tail where it was;
/// new tracks are orange, old ones green. Captions that are wider than the image go on in the next
/// line.
cv::Mat drawTracks(const cv::Mat& gray, const TrackTrails& trails,
                   const std::vector<Caption>& captions);

}  // namespace camera_self_calibration
