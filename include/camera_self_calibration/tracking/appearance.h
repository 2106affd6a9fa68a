#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "camera_self_calibration/tracking/image_view.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// What the surroundings of a corner look like (ORB): 256 comparisons of gray values, turned with
/// the image. Equal corners differ in few bits.
using Descriptor = std::array<std::uint8_t, 32>;

/// Of a corner that is not followed.
constexpr std::int64_t kNoTrack = -1;

/// A feature with its descriptor.
struct Appearance {
  std::int64_t track_id = kNoTrack;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Descriptor descriptor = {};
};

/// Describes tracks of the newest image and, after them, up to a number of its other corners, which
/// have no track.
using Describe = std::function<std::vector<Appearance>(const std::vector<Track>&, int corners)>;

/// Of tracks and, after them, of other corners. What lies outside the image or in its outermost
/// pixels has no appearance; without an image nothing has.
std::vector<Appearance> describe(const ImageView& image, const std::vector<Track>& tracks,
                                 const std::vector<Eigen::Vector2d>& corners = {});

/// Number of bits that differ.
int differingBits(const Descriptor& a, const Descriptor& b);

/// Descriptors that differ in more bits than this are not of the same corner.
constexpr int kMaxDifferingBits = 64;

/// Pairs of indices into `a` and `b` that look alike: the one of `b` is clearly nearer than the
/// second nearest, and no two of `a` have the same.
std::vector<std::pair<int, int>> matchAppearances(const std::vector<Descriptor>& a,
                                                  const std::vector<Descriptor>& b);

}  // namespace camera_self_calibration
