#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <iostream>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/reference/batch.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

double scaledDifference(const IntrinsicsMatrix& a, const IntrinsicsMatrix& b) {
  const Eigen::VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

// One joint problem, solved by this package and by Ceres from the same start.
class Agreement {
 public:
  Agreement(const Camera& truth, int segments, double outlier_share) {
    for (int s = 0; s < segments; ++s) {
      SegmentOptions options;
      options.camera = truth;
      options.keyframes = 8;
      options.tracks.max_features = 50;
      options.tracks.pixel_sigma = 0.3;
      options.tracks.outlier_share = outlier_share;
      const SimulatedSegment made = makeSegment(options, 300 + s);
      ours_.push_back(perturbed(made.segment, SegmentPerturbation{0.01, 0.005, 0.05, 0.002}, s));
    }
    theirs_ = ours_;
    our_camera_ = their_camera_ = perturbedCamera(truth, 3);
    for (std::size_t s = 0; s < ours_.size(); ++s) {
      const SegmentBlock block = freeBlock(&ours_[s], our_camera_);
      const double sigma_scale = 1.0 + 0.1 * static_cast<double>(s);
      blocks_.push_back({&ours_[s], 1, block.fixed_landmark, sigma_scale});
      batch_.push_back({&theirs_[s], 1, block.fixed_landmark, sigma_scale});
    }
  }

  void solveBoth(double huber) {
    SolverOptions options;
    options.huber = huber;
    options.max_iterations = 200;
    options.precision = 1e-8;
    const SolveSummary summary = solve({&our_camera_, true, blocks_}, options);
    EXPECT_TRUE(summary.usable);
    BatchOptions batch_options;
    batch_options.huber = huber;
    const BatchSummary batch = solveBatch(batch_, &their_camera_, batch_options);
    EXPECT_TRUE(batch.converged) << batch.message;
    EXPECT_NEAR(summary.final_cost, batch.final_cost, 1e-8 * batch.final_cost);
  }

  IntrinsicsMatrix ourCovariance(double huber) {
    const Marginal marginal = marginalize({&our_camera_, true, blocks_}, huber);
    const auto covariance = covarianceFromInformation(marginal.information);
    EXPECT_TRUE(covariance);
    return covariance.value_or(IntrinsicsMatrix());
  }

  // At our state, so that the covariances alone are compared.
  IntrinsicsMatrix ceresCovariance(double huber) {
    theirs_ = ours_;
    BatchOptions options;
    options.huber = huber;
    const auto covariance = batchCovariance(batch_, our_camera_, options);
    EXPECT_TRUE(covariance);
    return covariance.value_or(IntrinsicsMatrix());
  }

  // At our state: the sparse marginal of whole trajectories against that of nested elimination.
  void expectSameMarginal(double huber) {
    theirs_ = ours_;
    BatchOptions options;
    options.huber = huber;
    const auto theirs = batchMarginal(batch_, our_camera_, options);
    ASSERT_TRUE(theirs);
    const Marginal ours = marginalize({&our_camera_, true, blocks_}, huber);
    EXPECT_EQ(theirs->observations, ours.observations);
    EXPECT_EQ(theirs->variables, ours.variables);
    EXPECT_NEAR(theirs->cost, ours.cost, 1e-8 * ours.cost);
    EXPECT_LT(scaledDifference(theirs->information, ours.information), 1e-6);
    EXPECT_LT(scaledDifference(theirs->track_scores, ours.track_scores), 1e-4);
  }

  void expectSameEstimate(const IntrinsicsMatrix& covariance) const {
    const Eigen::VectorXd sigmas = covariance.diagonal().cwiseSqrt();
    const Eigen::VectorXd difference = our_camera_.parameters() - their_camera_.parameters();
    const double largest = difference.cwiseQuotient(sigmas).cwiseAbs().maxCoeff();
    std::cout << toString(our_camera_.model()) << ": estimates differ by " << largest << " sigma";
    EXPECT_LT(largest, 1e-4);
  }

 private:
  std::vector<Segment> ours_, theirs_;
  Camera our_camera_, their_camera_;
  std::vector<SegmentBlock> blocks_;
  std::vector<BatchSegment> batch_;
};

void expectAgreement(const Camera& truth, int segments, double outlier_share, double huber) {
  Agreement agreement(truth, segments, outlier_share);
  agreement.solveBoth(huber);
  const IntrinsicsMatrix ours = agreement.ourCovariance(huber);
  const IntrinsicsMatrix theirs = agreement.ceresCovariance(huber);
  agreement.expectSameEstimate(theirs);
  std::cout << ", covariances by " << scaledDifference(ours, theirs) << "\n";
  EXPECT_LT(scaledDifference(ours, theirs), 1e-6);
  agreement.expectSameMarginal(huber);
}

TEST(CeresAgreement, OneSegmentLeastSquares) {
  for (const Camera& truth : ordinaryCameras()) expectAgreement(truth, 1, 0.0, 0.0);
}

TEST(CeresAgreement, TenSegmentsLeastSquares) {
  for (const Camera& truth : ordinaryCameras()) expectAgreement(truth, 10, 0.0, 0.0);
}

TEST(CeresAgreement, OneSegmentHuber) {
  for (const Camera& truth : ordinaryCameras()) expectAgreement(truth, 1, 0.02, 2.0);
}

TEST(CeresAgreement, TenSegmentsHuber) {
  for (const Camera& truth : ordinaryCameras()) expectAgreement(truth, 10, 0.02, 2.0);
}

}  // namespace
}  // namespace camera_self_calibration
