#include "camera_self_calibration/estimation/gate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

const Camera kCamera = ordinaryCameras()[1];

SimulatedSegment segmentOf(double sigma, std::uint64_t seed) {
  return smallSegment(kCamera, LandmarkOrigin::kMixed, sigma, seed, 8, 60);
}

SegmentBlock blockOf(Segment* segment) { return {segment, 1, 0, 1.0}; }

// An observation of a landmark with more than three.
int someObservation(const Segment& segment) {
  for (std::size_t o = 3; o < segment.observations.size(); ++o) {
    const int l = segment.observations[o].landmark;
    if (segment.observations[o - 3].landmark == l) return static_cast<int>(o);
  }
  return -1;
}

TEST(Misfits, NoneInCleanData) {
  SimulatedSegment made = segmentOf(0.0, 1);
  EXPECT_TRUE(misfits(blockOf(&made.segment), kCamera).empty());
}

// At the true state the sums have all their degrees of freedom, a few more than the test counts on.
TEST(Misfits, FewInNoise) {
  int landmarks = 0, found = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SimulatedSegment made = segmentOf(0.3, seed);
    landmarks += static_cast<int>(made.segment.landmarks.size());
    found += static_cast<int>(misfits(blockOf(&made.segment), kCamera).size());
  }
  EXPECT_GT(landmarks, 300);
  EXPECT_LT(found, 0.015 * landmarks);
}

TEST(Misfits, FindTheLandmarkOfAGrossError) {
  SimulatedSegment made = segmentOf(0.3, 2);
  const std::vector<int> before = misfits(blockOf(&made.segment), kCamera);
  Observation& bad = made.segment.observations[someObservation(made.segment)];
  bad.pixel.x() += 3.0;  // ten sigma
  const std::vector<int> after = misfits(blockOf(&made.segment), kCamera);
  EXPECT_EQ(std::count(before.begin(), before.end(), bad.landmark), 0);
  EXPECT_EQ(std::count(after.begin(), after.end(), bad.landmark), 1);
  EXPECT_EQ(after.size(), before.size() + 1);
  // With ten times the sigma it fits.
  SegmentBlock wide = blockOf(&made.segment);
  wide.sigma_scale = 10.0;
  EXPECT_TRUE(misfits(wide, kCamera).empty());
}

TEST(Misfits, FindPointsThatCannotBePredicted) {
  SimulatedSegment made = segmentOf(0.0, 3);
  made.segment.landmarks[4].inverse_depth = -50.0;
  const std::vector<int> found = misfits(blockOf(&made.segment), kCamera);
  EXPECT_EQ(found, std::vector<int>{4});
  EXPECT_EQ(grossMisfits(blockOf(&made.segment), kCamera, 5.0, 1e6), std::vector<int>{4});
}

TEST(GrossMisfits, AreBeyondBothLimits) {
  SimulatedSegment made = segmentOf(0.0, 4);
  for (Observation& o : made.segment.observations) o.sigma = 0.2;
  Observation& bad = made.segment.observations[someObservation(made.segment)];
  const Eigen::Vector2d right = bad.pixel;
  const SegmentBlock block = blockOf(&made.segment);
  bad.pixel = right + Eigen::Vector2d(0.9, 1.2);  // 1.5 px, 7.5 sigma
  EXPECT_EQ(grossMisfits(block, kCamera, 5.0, 1.4), std::vector<int>{bad.landmark});
  EXPECT_TRUE(grossMisfits(block, kCamera, 5.0, 1.6).empty());
  EXPECT_TRUE(grossMisfits(block, kCamera, 8.0, 1.0).empty());
  SegmentBlock wide = block;
  wide.sigma_scale = 2.0;
  EXPECT_TRUE(grossMisfits(wide, kCamera, 5.0, 1.4).empty());
}

TEST(UnexplainedSigma, IsWhatTheSigmasLeaveOut) {
  double mean = 0.0;
  constexpr int kTrials = 10;
  for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
    SegmentOptions options;
    options.camera = kCamera;
    options.tracks.pixel_sigma = 0.5;
    options.tracks.reported_sigma = 0.3;
    SimulatedSegment made = makeSegment(options, seed);
    // A third of the tracks say so themselves.
    for (Observation& o : made.segment.observations) {
      if (o.landmark % 3 == 0) o.sigma = 0.5;
    }
    SegmentBlock block = blockOf(&made.segment);
    const double unexplained = unexplainedSigma(block, kCamera);
    mean += unexplained / kTrials;
    for (Observation& o : made.segment.observations) o.sigma = std::hypot(o.sigma, unexplained);
    EXPECT_NEAR(medianResidualScale(block, kCamera), 1.0, 1e-3);
    EXPECT_NEAR(unexplainedSigma(block, kCamera), 0.0, 0.02);  // added once, it is explained
    for (Observation& o : made.segment.observations) o.sigma = 2.0;
    EXPECT_EQ(unexplainedSigma(block, kCamera), 0.0);
  }
  // 0.4 px of two thirds; the correction for what a fit would absorb, which there was none of,
  // makes it larger.
  EXPECT_GT(mean, 0.3);
  EXPECT_LT(mean, 0.6);
  Segment empty;
  EXPECT_EQ(unexplainedSigma(blockOf(&empty), kCamera), 0.0);
}

TEST(GateSegment, AddsWhatIsUnexplainedAndRemovesWhatDoesNotFit) {
  SegmentOptions options;
  options.camera = kCamera;
  options.tracks.pixel_sigma = 0.5;
  options.tracks.reported_sigma = 0.3;
  SimulatedSegment made = makeSegment(options, 4);
  Segment& segment = made.segment;
  Observation& bad = segment.observations[someObservation(segment)];
  bad.pixel.x() += 10.0;
  const std::int64_t bad_track = segment.landmarks[bad.landmark].track_id;
  const std::size_t landmarks = segment.landmarks.size();
  const double unexplained = unexplainedSigma(blockOf(&segment), kCamera);
  ASSERT_GT(unexplained, 0.2);
  const GateResult result = gateSegment(blockOf(&segment), kCamera);
  EXPECT_EQ(result.unexplained_sigma, unexplained);
  for (const Observation& o : segment.observations) {
    EXPECT_EQ(o.sigma, std::hypot(0.3, unexplained));
  }
  const auto& removed = result.removed_tracks;
  EXPECT_EQ(std::count(removed.begin(), removed.end(), bad_track), 1);
  EXPECT_EQ(segment.landmarks.size() + removed.size(), landmarks);
  for (const Landmark& landmark : segment.landmarks) EXPECT_NE(landmark.track_id, bad_track);
  EXPECT_TRUE(misfits(blockOf(&segment), kCamera).empty());
}

TEST(MedianResidualScale, IsTheNoiseOverTheSigma) {
  double mean = 0.0;
  constexpr int kTrials = 10;
  for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
    SegmentOptions options;
    options.camera = kCamera;
    options.tracks.pixel_sigma = 0.6;
    options.tracks.reported_sigma = 0.2;
    options.tracks.outlier_share = 0.1;
    SimulatedSegment made = makeSegment(options, seed);
    // At the true state nothing is fitted: take out the correction for what a fit would absorb.
    double variables = 6.0 * (made.segment.keyframes.size() - 1.0);
    for (const Landmark& l : made.segment.landmarks) variables += l.anchored ? 1.0 : 3.0;
    const double residuals = 2.0 * static_cast<double>(made.segment.observations.size());
    mean += medianResidualScale(blockOf(&made.segment), kCamera) *
            std::sqrt((residuals - variables) / residuals) / kTrials;
  }
  EXPECT_NEAR(mean, 3.0, 0.35);  // a tenth of outliers raises the median by a tenth
  Segment empty;
  EXPECT_EQ(medianResidualScale(blockOf(&empty), kCamera), 1.0);
}

}  // namespace
}  // namespace camera_self_calibration
