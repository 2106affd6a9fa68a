#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <iostream>

#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/queue/segment_fit.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

// How the errors of the intrinsics compare with their sigmas.
struct Coverage {
  int fits = 0;
  int failed = 0;
  int parameters = 0;
  int inside = 0;  // 3 sigma
  double squares = 0.0;
  double chi_squares = 0.0;  // of a fit's intrinsics, per intrinsic

  double share() const { return static_cast<double>(inside) / parameters; }
  double rms() const { return std::sqrt(squares / parameters); }
  double chiSquare() const { return chi_squares / fits; }

  void add(const Camera& estimate, const Camera& truth, const IntrinsicsMatrix& covariance) {
    ++fits;
    const int count = truth.estimatedCount();
    const Eigen::VectorXd error = (estimate.parameters() - truth.parameters()).head(count);
    chi_squares += error.dot(covariance.ldlt().solve(error)) / count;
    for (int i = 0; i < truth.estimatedCount(); ++i) {
      const double z =
          (estimate.parameters()(i) - truth.parameters()(i)) / std::sqrt(covariance(i, i));
      ++parameters;
      inside += std::abs(z) < 3.0;
      squares += z * z;
    }
  }
};

// What differs from run to run.
struct Setting {
  LandmarkOrigin origin = LandmarkOrigin::kMixed;
  double outlier_share = 0.0;
  double reference_sigma = 0.0;  // of the reference pixel, which the whole track shares [px]
  double reported_sigma = 0.0;   // 0: the true one [px]
  bool robust = false;           // covariance as stated of the queue
  double motion_share = 1.0;     // of the translations of ordinary hand-held motion
};

// Hand-held motion with small translations: as if the room were larger by as much.
Trajectory lessMoved(const SegmentOptions& options, double share, std::uint64_t seed) {
  SyntheticMotionOptions motion;
  motion.seed = mixSeed(seed, 1);
  motion.speed = options.motion_speed;
  motion.box = makeRoom(options.room).free_space;
  motion.duration_s = options.start_s + (options.keyframes + 1) * options.keyframe_interval_s;
  const Trajectory full = syntheticMotion(motion);
  const Eigen::Vector3d middle = motion.box.center();
  const auto pose = [=](double t) {
    const Rigid3 there = full.worldFromCamera(t);
    return Rigid3(there.rotation, middle + share * (there.translation - middle));
  };
  return Trajectory(pose, motion.duration_s);
}

Coverage coverageOf(const Setting& setting) {
  Coverage coverage;
  double design_effect = 0.0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Camera truth = ordinaryCameras()[seed % 4];
    SegmentOptions options;
    options.camera = truth;
    options.origin = setting.origin;
    options.keyframes = 8;
    options.tracks.max_features = 50;
    options.tracks.pixel_sigma = 0.3;
    options.tracks.outlier_share = setting.outlier_share;
    options.tracks.reference_sigma = setting.reference_sigma;
    options.tracks.reported_sigma = setting.reported_sigma;
    if (setting.motion_share < 1.0) {
      options.keyframes = 10;
      options.keyframe_interval_s = 0.5;
      options.tracks.max_features = 100;
      options.tracks.pixel_sigma = 0.2;
      options.trajectory = lessMoved(options, setting.motion_share, 1000 + seed);
    }
    const SimulatedSegment made = makeSegment(options, 1000 + seed);
    SegmentPerturbation perturbation;
    perturbation.translation_m *= setting.motion_share;
    Segment segment = perturbed(made.segment, perturbation, seed);
    Camera camera = perturbedCamera(truth, seed);
    SegmentFitOptions fit_options;
    fit_options.inverse_depth_noise = InverseDepthNoise::kDiscounted;
    const SegmentFit fit = fitSegment(fit_options, &segment, &camera);
    const auto covariance = setting.robust ? fit.marginal.robustCovariance()
                                           : covarianceFromInformation(fit.marginal.information);
    if (!fit.usable || !covariance) {
      ++coverage.failed;
      continue;
    }
    design_effect += fit.marginal.designEffect() / 200.0;
    coverage.add(camera, truth, *covariance);
  }
  std::cout << coverage.inside << " of " << coverage.parameters << " intrinsics inside 3 sigma ("
            << 100.0 * coverage.share() << " %), rms z " << coverage.rms() << ", "
            << coverage.failed << " of 200 without a solution, design effect " << design_effect
            << ", chi-square " << coverage.chiSquare() << "\n";
  return coverage;
}

// Of exact covariances 99.7 % are inside and the rms is 1.
void expectHonest(const Coverage& coverage) {
  EXPECT_EQ(coverage.failed, 0);
  EXPECT_GE(coverage.share(), 0.98);
  EXPECT_GT(coverage.rms(), 0.85);
  EXPECT_LT(coverage.rms(), 1.2);
}

TEST(Coverage, WithNoise) { expectHonest(coverageOf({})); }

TEST(Coverage, WithOutliers) { expectHonest(coverageOf({LandmarkOrigin::kMixed, 0.05})); }

TEST(Coverage, OfInheritedTracksOnly) { expectHonest(coverageOf({LandmarkOrigin::kInherited})); }

TEST(Coverage, OfAnchoredTracksOnly) { expectHonest(coverageOf({LandmarkOrigin::kAnchored})); }

// A tracker that believes itself three times as good as it is.
TEST(Coverage, WithSigmasThatAreTooSmall) {
  expectHonest(coverageOf({LandmarkOrigin::kMixed, 0.0, 0.0, 0.1}));
}

// Independent noise needs no robust covariance, which then is hardly larger.
TEST(Coverage, OfTheRobustCovariance) {
  const Coverage coverage = coverageOf({LandmarkOrigin::kMixed, 0.0, 0.0, 0.0, true});
  EXPECT_GE(coverage.share(), 0.98);
  EXPECT_GT(coverage.rms(), 0.7);
}

// Where depths are as uncertain as they differ, the squares of their estimates tell more of
// translations than the depths do; taken for knowledge, that makes the sigmas too small by half.
TEST(Coverage, OfFarScenes) {
  for (const double share : {0.01, 0.003}) {
    Setting setting;
    setting.motion_share = share;
    const Coverage coverage = coverageOf(setting);
    EXPECT_EQ(coverage.failed, 0) << share;
    EXPECT_GE(coverage.share(), 0.98) << share;
    EXPECT_GT(coverage.rms(), 0.6) << share;
    EXPECT_LT(coverage.rms(), 1.1) << share;
    EXPECT_LT(coverage.chiSquare(), 1.7) << share;
  }
}

// Nor is rotation on the spot taken for far less than it tells.
TEST(Coverage, OfRotationOnTheSpot) {
  Setting setting;
  setting.motion_share = 0.0;
  const Coverage coverage = coverageOf(setting);
  EXPECT_EQ(coverage.failed, 0);
  EXPECT_GE(coverage.share(), 0.99);
  EXPECT_GT(coverage.rms(), 0.6);
}

// The error of the reference pixel is common to its whole track: with exact rays the plain
// covariance is too small, and the robust one is not.
TEST(Coverage, OfNoisyAnchors) {
  const Coverage plain = coverageOf({LandmarkOrigin::kAnchored, 0.0, 0.3, 0.0, false});
  const Coverage robust = coverageOf({LandmarkOrigin::kAnchored, 0.0, 0.3, 0.0, true});
  EXPECT_GT(plain.rms(), 1.2);
  EXPECT_GE(robust.share(), 0.97);
  EXPECT_LT(robust.rms(), 0.85 * plain.rms());
}

}  // namespace
}  // namespace camera_self_calibration
