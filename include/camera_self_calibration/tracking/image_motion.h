#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>

#include "camera_self_calibration/base/frame_clock.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// Where a feature would have been seen if all rows had been read at the time of `middle_row`. A
/// rolling shutter reads row v at `(v - middle_row) line_delay_s` after that moment; the track's
/// own motion tells where the feature was at which image's stamp, so that neither camera model nor
/// pose is needed.
Eigen::Vector2d asSeenAtOnce(const Eigen::Vector2d& pixel, const ImageMotion& motion,
                             double middle_row, double line_delay_s);

/// A motion as images are stamped, turned into one in time at the moment of `middle_row`; the
/// feature was seen at `pixel`.
ImageMotion motionInTime(const Eigen::Vector2d& pixel, const ImageMotion& stamped,
                         double middle_row, double line_delay_s);

/// As asSeenAtOnce, from the motion in time.
Eigen::Vector2d asSeenAtOnceInTime(const Eigen::Vector2d& pixel, const ImageMotion& in_time,
                                   double middle_row, double line_delay_s);

/// The motion of features through the newest images, by the polynomial through up to five of them. A
/// parabola through three would be too stiff: a hand that shakes at 3 Hz, seen at 30 Hz, moves 7 %
/// faster than it says. A sensor takes images at a steady rate, but many drivers stamp them when
/// they arrive, some milliseconds early or late, which makes a velocity wrong by as large a part. So
/// steps of whole periods take the place of the stamps' for as long as features move more evenly by
/// them.
class MotionHistory {
 public:
  /// Images on either side of one whose motion is asked for, at most.
  static constexpr int kReach = 2;
  /// The images that are remembered: the newest is 0 images old.
  static constexpr int kImages = 2 * kReach + 1;

  /// The tracks of the next image.
  void add(const TrackedFrame& frame);

  /// Tracks that start in the newest image.
  void addDetected(const std::vector<Track>& tracks);

  /// Forgets the images, but not how steady the camera is.
  void clear() { images_.clear(); }

  /// Number of images remembered.
  int size() const { return static_cast<int>(images_.size()); }
  std::int64_t stampNs(int images_ago) const { return image(images_ago).stamp_ns; }

  /// The motion of each track of an image, up to kReach images ago: from all images within kReach,
  /// where the track was seen before and after, else from one side, and none where it was seen once.
  /// By track id.
  std::map<std::int64_t, ImageMotion> motions(int images_ago) const;

 private:
  struct Image {
    std::int64_t stamp_ns = 0;
    double stamped_step_s = 0.0;                     ///< From the image before it, by the stamps,
    double even_step_s = 0.0;                        ///< and in whole periods.
    std::map<std::int64_t, Eigen::Vector2d> pixels;  // by track id
  };

  const Image& image(int images_ago) const {
    return images_[images_.size() - 1 - static_cast<std::size_t>(images_ago)];
  }

  void measureStep(Image* next);
  void weighSteps();
  double stepOf(const Image& image) const {
    return evenness_ > 0.0 ? image.even_step_s : image.stamped_step_s;
  }

  std::deque<Image> images_;
  FrameClock clock_{60};  // jitter of a tenth of a period then makes velocities wrong by 0.3 %
  FrameClock newest_{5};  // notices another rate
  /// By how much less the features' steps in the image change in whole periods than by the stamps:
  /// squared, a sum over the newest images [px^2].
  double evenness_ = 0.0;
};

}  // namespace camera_self_calibration
