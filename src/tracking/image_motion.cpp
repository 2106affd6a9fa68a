#include "camera_self_calibration/tracking/image_motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/base/stamp.h"

namespace camera_self_calibration {
namespace {

struct Sample {
  double time_s;  // from the moment that is asked for
  Eigen::Vector2d pixel;
};

// Derivatives at time 0 of the polynomial through all samples.
ImageMotion motionThrough(const std::vector<Sample>& samples) {
  // Divided differences (Newton), in place.
  std::vector<Eigen::Vector2d> coefficients;
  for (const Sample& sample : samples) coefficients.push_back(sample.pixel);
  const std::size_t count = samples.size();
  for (std::size_t order = 1; order < count; ++order) {
    for (std::size_t i = count - 1; i >= order; --i) {
      coefficients[i] =
          (coefficients[i] - coefficients[i - 1]) / (samples[i].time_s - samples[i - order].time_s);
    }
  }
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  ImageMotion motion;
  for (std::size_t i = count; i-- > 0;) {  // Horner
    const double step = -samples[i].time_s;
    motion.acceleration = step * motion.acceleration + 2.0 * motion.velocity;
    motion.velocity = step * motion.velocity + value;
    value = step * value + coefficients[i];
  }
  motion.images = static_cast<int>(count);
  return motion;
}

// For so many images a camera is taken to be as steady as it was: a few seconds.
constexpr double kMemoryImages = 100.0;

// By which share the mean of five steps leaves that of many at another rate; jitter of an eighth of
// a period moves it by a twentieth.
constexpr double kAnotherRate = 0.2;

// A feature cannot be seen to move faster than rows are read.
constexpr double kLeastPace = 0.2;

Eigen::Vector2d after(double seconds, const Eigen::Vector2d& pixel, const ImageMotion& motion) {
  return pixel + seconds * motion.velocity + 0.5 * seconds * seconds * motion.acceleration;
}

// Pixels as a function p(s) of the image's stamp, s from this one: p(s) was seen at
// s + (p_y(s) - middle_row) line_delay_s; the s for which this is 0. Contracts by a feature's
// motion in rows while one row is read.
double stampOfMiddleRow(const Eigen::Vector2d& pixel, const ImageMotion& motion, double middle_row,
                        double line_delay_s) {
  double s = 0.0;
  for (int i = 0; i < 4; ++i) {
    s = -(after(s, pixel, motion).y() - middle_row) * line_delay_s;
  }
  return s;
}

}  // namespace

Eigen::Vector2d asSeenAtOnce(const Eigen::Vector2d& pixel, const ImageMotion& motion,
                             double middle_row, double line_delay_s) {
  return after(stampOfMiddleRow(pixel, motion, middle_row, line_delay_s), pixel, motion);
}

ImageMotion motionInTime(const Eigen::Vector2d& pixel, const ImageMotion& stamped,
                         double middle_row, double line_delay_s) {
  const double s = stampOfMiddleRow(pixel, stamped, middle_row, line_delay_s);
  const Eigen::Vector2d velocity = stamped.velocity + s * stamped.acceleration;
  // t(s) = s + (p_y(s) - middle_row) line_delay_s, and q(t(s)) = p(s).
  const double pace = std::max(kLeastPace, 1.0 + line_delay_s * velocity.y());
  ImageMotion in_time;
  in_time.images = stamped.images;
  in_time.velocity = velocity / pace;
  in_time.acceleration =
      (stamped.acceleration - line_delay_s * stamped.acceleration.y() * in_time.velocity) /
      (pace * pace);
  return in_time;
}

Eigen::Vector2d asSeenAtOnceInTime(const Eigen::Vector2d& pixel, const ImageMotion& in_time,
                                   double middle_row, double line_delay_s) {
  // pixel = q + t q' + t^2 q'' / 2 with q and its derivatives at time 0.
  const double t = (pixel.y() - middle_row) * line_delay_s;
  return pixel - t * in_time.velocity - 0.5 * t * t * in_time.acceleration;
}

void MotionHistory::add(const TrackedFrame& frame) {
  Image next;
  next.stamp_ns = frame.stamp_ns;
  measureStep(&next);
  images_.push_back(std::move(next));
  if (size() > kImages) images_.pop_front();
  addDetected(frame.tracks);
  if (size() > 2) weighSteps();
}

void MotionHistory::measureStep(Image* next) {
  if (images_.empty()) return;
  const std::int64_t step_ns = next->stamp_ns - images_.back().stamp_ns;
  if (step_ns <= 0) return;
  newest_.add(step_ns);
  const FrameClock::Step step = clock_.add(step_ns);
  const auto usual = static_cast<double>(clock_.period());
  const auto now = static_cast<double>(newest_.period());
  if (usual > 0.0 && std::abs(now - usual) > kAnotherRate * usual) {
    clock_.clear();
    evenness_ = 0.0;
  }
  const std::int64_t period_ns = clock_.period();
  next->stamped_step_s = toSeconds(step_ns);
  next->even_step_s =
      period_ns == 0 || step.gap ? next->stamped_step_s : toSeconds((1 + step.missed) * period_ns);
}

void MotionHistory::weighSteps() {
  const Image& before = images_[images_.size() - 3];
  const Image& middle = images_[images_.size() - 2];
  const Image& newest = images_.back();
  if (!(middle.stamped_step_s > 0.0) || !(newest.stamped_step_s > 0.0)) return;
  // Squares, to which wrong times add in the mean even where an acceleration is larger.
  // How far features came from where they would be at the velocity of the step before.
  std::vector<double> by_stamps, by_periods;
  for (const auto& [id, pixel] : newest.pixels) {
    const auto at_middle = middle.pixels.find(id);
    const auto at_first = before.pixels.find(id);
    if (at_middle == middle.pixels.end() || at_first == before.pixels.end()) continue;
    const Eigen::Vector2d first = at_middle->second - at_first->second;
    const Eigen::Vector2d second = pixel - at_middle->second;
    by_stamps.push_back(
        (second - newest.stamped_step_s / middle.stamped_step_s * first).squaredNorm());
    by_periods.push_back((second - newest.even_step_s / middle.even_step_s * first).squaredNorm());
  }
  evenness_ += median(by_stamps, 0.0) - median(by_periods, 0.0) - evenness_ / kMemoryImages;
}

void MotionHistory::addDetected(const std::vector<Track>& tracks) {
  for (const Track& track : tracks) {
    images_.back().pixels[track.id] = track.pixel;
  }
}

std::map<std::int64_t, ImageMotion> MotionHistory::motions(int images_ago) const {
  std::map<std::int64_t, ImageMotion> result;
  const int index = size() - 1 - images_ago;
  const int begin = std::max(0, index - kReach);
  const int end = std::min(size(), index + kReach + 1);
  std::vector<double> times(images_.size(), 0.0);
  for (std::size_t i = 1; i < images_.size(); ++i) times[i] = times[i - 1] + stepOf(images_[i]);
  const double now = times[static_cast<std::size_t>(index)];
  std::vector<Sample> samples;
  for (const auto& [id, pixel] : image(images_ago).pixels) {
    samples.clear();
    for (int i = begin; i < end; ++i) {
      const auto& pixels = images_[static_cast<std::size_t>(i)].pixels;
      const auto found = pixels.find(id);
      const double time_s = times[static_cast<std::size_t>(i)] - now;
      const bool known = !samples.empty() && samples.back().time_s == time_s;  // one stamp, twice
      if (found != pixels.end() && !known) samples.push_back({time_s, found->second});
    }
    result[id] = motionThrough(samples);
  }
  return result;
}

}  // namespace camera_self_calibration
