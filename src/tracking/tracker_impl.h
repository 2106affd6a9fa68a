#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "camera_self_calibration/tracking/carried_features.h"
#include "camera_self_calibration/tracking/field_mask.h"
#include "camera_self_calibration/tracking/flow_prediction.h"
#include "camera_self_calibration/tracking/harris.h"
#include "camera_self_calibration/tracking/level_balance.h"
#include "camera_self_calibration/tracking/local_motion.h"
#include "camera_self_calibration/tracking/lucas_kanade.h"
#include "camera_self_calibration/tracking/patch_registration.h"
#include "camera_self_calibration/tracking/pyramid.h"
#include "camera_self_calibration/tracking/stripes.h"
#include "camera_self_calibration/tracking/track_gate.h"
#include "camera_self_calibration/tracking/tracker.h"
#include "camera_self_calibration/tracking/usable_area.h"
#include "camera_self_calibration/tracking/zoom_search.h"

namespace camera_self_calibration {

/// A corner of the scene that is followed. While it is not found, its warp is where its neighbours
/// say that it would be.
struct Feature {
  std::int64_t id = 0;
  Eigen::Vector2d reference_pixel = Eigen::Vector2d::Zero();  // in the image of its detection
  std::size_t patch = 0;                                      // index in Tracker::Impl::patches
  Warp warp;                                                  // of that patch
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();         // [px per image]
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();            // when last found
  double sigma = 0.0;                                         // of that [px]
  int missed = 0;                                             // images since it was last found

  // Where it is, or would be.
  const Eigen::Vector2d& place() const { return missed > 0 ? warp.pixel : pixel; }
  // Others are in reserve: a new feature would tell more.
  bool good() const { return missed == 0 && sigma <= kGoodTrackSigma; }
};

struct Tracker::Impl {
  explicit Impl(const TrackerOptions& o);

  void restart();
  void load(const ImageView& image);
  // Whether the image shows what the one before it does: only then tracks advance.
  bool advance();
  std::vector<Track> detect();
  std::vector<Eigen::Vector2d> corners(int count);
  template <typename Keep>
  void keepIf(const Keep& keep);
  void end(const std::vector<std::int64_t>& ids);
  void listTracks();

  TrackerOptions options;
  bool usable = false;  // whether the image tracked last showed the scene
  TrackedFrame frame;
  TrackedFrame nothing;
  std::vector<Feature> features;

 private:
  void predict();
  // Images from the previous one that was taken to the present one.
  int steps() const { return unrelated_ + 1; }
  bool isSlow();
  bool isUnrelated() const;
  bool followsPrevious();
  void search();
  void find(std::size_t i, PatchRegistration* worker);
  bool findFrom(std::size_t i, const Warp& start, const Eigen::Vector2d& expected,
                PatchRegistration* worker);
  bool accepts(const Feature& feature, const Registration& result,
               const Eigen::Vector2d& expected) const;
  void learn();
  void limitReserve();
  bool mayReturn(const Feature& feature) const;

  double minDistance() const;
  int cell() const;
  int levelOf(const Feature& feature) const { return patches_[feature.patch].level(); }
  int marginOf(const Feature& feature) const;
  TrackGate& gateOf(const Feature& feature) {
    return gates_[static_cast<std::size_t>(levelOf(feature))];
  }
  const TrackGate& gateOf(const Feature& feature) const {
    return gates_[static_cast<std::size_t>(levelOf(feature))];
  }
  LevelBalance::Counts goodFeatures() const;
  bool allowed(const Corner& corner, int level) const;
  bool crowded(const Eigen::Vector2d& pixel, double distance) const;
  bool cut(const Corner& corner, int level, ReferencePatch* patch, Warp* warp) const;
  int levelFor(const Corner& corner, const LevelBalance::Counts& good) const;
  bool begin(const Corner& corner, int level);
  bool seenBefore(Feature* feature);

  std::int64_t next_id_ = 0;
  std::vector<ReferencePatch> patches_;
  std::vector<std::size_t> free_patches_;

  ImagePyramid previous_;
  ImagePyramid current_;
  FieldMask mask_;  // kept over a restart: the lens is the same
  UsableArea usable_area_;
  CarriedFeatures carried_;  // kept over a restart, as the mask
  FlowPrediction flow_;
  ZoomSearch zoom_search_;
  LocalMotion local_motion_;
  int unrelated_ = 0;    // images since the newest that follows the one before it
  int slow_images_ = 0;  // in a row
  LucasKanade backward_;
  std::array<PatchRegistration, kStripes> registrations_;
  std::vector<TrackGate> gates_;  // by level
  LevelBalance balance_;
  HarrisDetector harris_;
  // Of the features that were found in the previous image: where, and where the flow leads.
  std::vector<cv::Point2f> from_;
  std::vector<cv::Point2f> predicted_;
  std::vector<double> speeds_;            // of features [px per image]
  std::vector<int> flow_index_;           // of each feature in them; -1: none
  std::vector<Registration> registered_;  // how the features were found, where they were
  std::array<std::vector<Registration>, ReferencePatch::kLevels> accepted_;  // of those, by level
  std::vector<const Feature*> reserve_;                                      // not good
};

// Calls keep(feature) once for each feature, in order, and ends those for which it is false.
template <typename Keep>
void Tracker::Impl::keepIf(const Keep& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (keep(features[i])) {
      features[kept++] = features[i];
    } else {
      balance_.ended(levelOf(features[i]));
      free_patches_.push_back(features[i].patch);
    }
  }
  features.resize(kept);
}

}  // namespace camera_self_calibration
