#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "camera_self_calibration/calibration/segment_fit.h"
#include "camera_self_calibration/estimation/marginal.h"
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

  double share() const { return static_cast<double>(inside) / parameters; }
  double rms() const { return std::sqrt(squares / parameters); }

  void add(const Camera& estimate, const Camera& truth, const IntrinsicsMatrix& covariance) {
    ++fits;
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
};

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
    const SimulatedSegment made = makeSegment(options, 1000 + seed);
    Segment segment = perturbed(made.segment, SegmentPerturbation(), seed);
    Camera camera = perturbedCamera(truth, seed);
    const SegmentFit fit = fitSegment(SegmentFitOptions(), &segment, &camera);
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
            << "\n";
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
