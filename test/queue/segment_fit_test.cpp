#include "camera_self_calibration/queue/segment_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

SimulatedSegment segmentOf(double outlier_share, double reported_sigma, std::uint64_t seed) {
  SegmentOptions options;
  options.camera = ordinaryCameras()[1];
  options.tracks.max_features = 80;
  options.tracks.pixel_sigma = 0.3;
  options.tracks.reported_sigma = reported_sigma;
  options.tracks.outlier_share = outlier_share;
  return makeSegment(options, seed);
}

TEST(FitSegment, RemovesTracksWithGrossErrorsAndFewOthers) {
  int wrong = 0, found = 0, good = 0, lost = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const SimulatedSegment made = segmentOf(0.02, 0.0, seed);
    std::set<std::int64_t> bad;
    for (std::size_t o = 0; o < made.segment.observations.size(); ++o) {
      const Observation& observation = made.segment.observations[o];
      if (made.outliers[o]) bad.insert(made.segment.landmarks[observation.landmark].track_id);
    }
    Segment segment = perturbed(made.segment, {}, seed);
    Camera camera = perturbedCamera(made.camera, seed);
    const SegmentFit fit = fitSegment(SegmentFitOptions(), &segment, &camera);
    ASSERT_TRUE(fit.usable);
    wrong += static_cast<int>(bad.size());
    good += static_cast<int>(made.segment.landmarks.size() - bad.size());
    for (const std::int64_t id : fit.removed_tracks) (bad.count(id) > 0 ? found : lost) += 1;
    EXPECT_EQ(segment.landmarks.size() + fit.removed_tracks.size(), made.segment.landmarks.size());
    EXPECT_NEAR(fit.residual_scale, 1.0, 0.25);
  }
  EXPECT_GT(wrong, 80);
  EXPECT_GT(found, 0.9 * wrong);
  EXPECT_LT(lost, 0.03 * good);
}

TEST(FitSegment, AddsWhatTheSigmasLeaveOut) {
  const SimulatedSegment made = segmentOf(0.0, 0.1, 3);
  Segment segment = perturbed(made.segment, {}, 3);
  Camera camera = perturbedCamera(made.camera, 3);
  const SegmentFit fit = fitSegment(SegmentFitOptions(), &segment, &camera);
  ASSERT_TRUE(fit.usable);
  EXPECT_NEAR(fit.residual_scale, 3.0, 0.4);
  EXPECT_NEAR(fit.unexplained_sigma, std::sqrt(0.3 * 0.3 - 0.1 * 0.1), 0.04);
  EXPECT_NEAR(fit.marginal.residualScale(), 1.0, 0.1);
  EXPECT_LT(fit.removed_tracks.size(), 5u);
}

TEST(FitSegment, HoldsIntrinsicsIfTold) {
  const SimulatedSegment made = segmentOf(0.0, 0.0, 4);
  Segment segment = perturbed(made.segment, {}, 4);
  Camera camera = made.camera;
  SegmentFitOptions options;
  options.estimate_intrinsics = false;
  const SegmentFit fit = fitSegment(options, &segment, &camera);
  EXPECT_TRUE(fit.usable);
  EXPECT_EQ(camera.parameters(), made.camera.parameters());
  EXPECT_EQ(fit.marginal.information.size(), 0);
}

TEST(FitSegment, SaysWhereThereIsNothingToFit) {
  Segment empty;
  Camera camera = ordinaryCameras()[1];
  EXPECT_FALSE(fitSegment(SegmentFitOptions(), &empty, &camera).usable);
  EXPECT_EQ(camera.parameters(), ordinaryCameras()[1].parameters());
}

}  // namespace
}  // namespace camera_self_calibration
