#pragma once

#include <cstdint>

namespace camera_self_calibration {

/// The fast watch over the lens, frame by frame: raises a suspicion when the tracks fit the map
/// worse than they used to, held intrinsics and all. A cumulated sum (CUSUM) of the logarithm of
/// the frames' residual scales against their own running mean and spread. A suspicion is no alarm:
/// it costs a closer look (testLensChange), which decides.
class InnovationMonitor {
 public:
  /// Frames in the order of time; `residual_scale` > 0 is that of the frame's pose
  /// (PoseEstimate::residual_scale). True while suspicious.
  bool add(std::int64_t stamp_ns, double residual_scale);

  bool suspicious() const { return suspicious_; }
  /// Stamp of the frame in which the present suspicion began [ns].
  std::int64_t onsetNs() const { return onset_ns_; }

  /// Ends a suspicion that was looked into: what is now usual is learnt anew.
  void reset() { *this = InnovationMonitor(); }

 private:
  int frames_ = 0;
  double mean_ = 0.0;
  double spread_ = 0.0;  // mean absolute deviation
  double sum_ = 0.0;
  bool suspicious_ = false;
  std::int64_t onset_ns_ = 0;
};

}  // namespace camera_self_calibration
