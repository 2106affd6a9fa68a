#include "camera_self_calibration/queue/candidate_window.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <iostream>

#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

SimulatedSegment segmentOf(const Camera& camera, MotionKind motion, std::uint64_t seed,
                           double reported_sigma = 0.0, int features = 80) {
  SegmentOptions options;
  options.camera = camera;
  options.motion = motion;
  options.tracks.max_features = features;
  options.tracks.pixel_sigma = 0.3;
  options.tracks.reported_sigma = reported_sigma;
  return makeSegment(options, seed);
}

Candidate evaluated(const SimulatedSegment& made, std::uint64_t seed,
                    const SegmentPerturbation& perturbation = {}) {
  return evaluateCandidate(CandidateOptions(), perturbed(made.segment, perturbation, seed),
                           perturbedCamera(made.camera, seed));
}

TEST(Candidate, OfGoodMotionIsWellPosedAndRight) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Camera truth = ordinaryCameras()[seed % 4];
    const Candidate candidate = evaluated(segmentOf(truth, MotionKind::kHandheld, seed), seed);
    ASSERT_TRUE(candidate.well_posed) << candidate.reason;
    EXPECT_TRUE(candidate.reason.empty());
    EXPECT_TRUE(std::isfinite(candidate.entropy));
    EXPECT_GT(candidate.uncertainty.rms, 0.0);
    EXPECT_NEAR(candidate.residual_scale, 1.0, 0.15);
    const auto covariance = covarianceFromInformation(candidate.information);
    ASSERT_TRUE(covariance);
    for (int i = 0; i < truth.estimatedCount(); ++i) {
      EXPECT_LT(std::abs(candidate.camera.parameters()(i) - truth.parameters()(i)),
                4.5 * std::sqrt((*covariance)(i, i)))
          << truth.parameterNames()[i];
    }
  }
}

// A tracker that believes itself twice as good as it is: the residuals tell.
TEST(Candidate, ScalesItsCovarianceByTheResiduals) {
  const Camera truth = ordinaryCameras()[1];
  const Candidate honest = evaluated(segmentOf(truth, MotionKind::kHandheld, 3), 3);
  const Candidate boastful = evaluated(segmentOf(truth, MotionKind::kHandheld, 3, 0.15), 3);
  EXPECT_NEAR(boastful.residual_scale, 2.0, 0.25);
  EXPECT_NEAR(boastful.sigma_scale * boastful.segment.observations[0].sigma, 0.3, 0.06);
  EXPECT_NEAR(honest.sigma_scale * honest.segment.observations[0].sigma, 0.3, 0.06);
  EXPECT_NEAR(boastful.entropy, honest.entropy, 0.5 * truth.estimatedCount() * 0.2);
  EXPECT_NEAR(boastful.uncertainty.rms / honest.uncertainty.rms, 1.0, 0.2);
}

TEST(Candidate, RefusesMotionThatDoesNotInform) {
  for (const MotionKind motion :
       {MotionKind::kSidewaysOnly, MotionKind::kForwardOnly, MotionKind::kStill}) {
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      const Camera truth = ordinaryCameras()[seed % 4];
      const Candidate candidate = evaluated(segmentOf(truth, motion, seed), seed);
      const double share = candidate.uncertainty.rms / truth.width();
      EXPECT_FALSE(candidate.well_posed)
          << toString(motion) << " " << toString(truth.model()) << " rms " << share
          << " of the width, scaled eigenvalue " << scaledEigenvalues(candidate.information)(0);
      EXPECT_FALSE(candidate.reason.empty());
    }
  }
}

TEST(Candidate, RefusesTooLittle) {
  const Camera truth = ordinaryCameras()[1];
  const SimulatedSegment few = segmentOf(truth, MotionKind::kHandheld, 1, 0.0, 12);
  ASSERT_LT(few.segment.landmarks.size(), 40u);
  Segment starved = few.segment;
  std::vector<int> surplus;
  for (int l = 15; l < static_cast<int>(starved.landmarks.size()); ++l) surplus.push_back(l);
  removeLandmarks(surplus, &starved);
  const Candidate thin = evaluateCandidate(CandidateOptions(), starved, truth);
  EXPECT_FALSE(thin.well_posed);
  EXPECT_NE(thin.reason.find("landmarks"), std::string::npos) << thin.reason;

  Segment brief = few.segment;
  brief.keyframes.resize(3);
  const Candidate short_one = evaluateCandidate(CandidateOptions(), brief, truth);
  EXPECT_FALSE(short_one.well_posed);
  EXPECT_NE(short_one.reason.find("keyframes"), std::string::npos) << short_one.reason;

  Segment empty;
  EXPECT_FALSE(evaluateCandidate(CandidateOptions(), empty, truth).well_posed);
  empty.keyframes.resize(10);
  const Candidate nothing = evaluateCandidate(CandidateOptions(), empty, truth);
  EXPECT_FALSE(nothing.well_posed);
  EXPECT_FALSE(nothing.reason.empty());
}

TEST(Candidate, RefusesResidualsThatNoSigmaExplains) {
  const Camera truth = ordinaryCameras()[1];
  const Candidate candidate = evaluated(segmentOf(truth, MotionKind::kHandheld, 5, 0.02), 5);
  EXPECT_FALSE(candidate.well_posed);
  EXPECT_NE(candidate.reason.find("residuals"), std::string::npos) << candidate.reason;
}

}  // namespace
}  // namespace camera_self_calibration
