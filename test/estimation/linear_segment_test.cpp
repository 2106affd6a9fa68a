#include "camera_self_calibration/estimation/linear_segment.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <random>

#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/pseudo_inverse.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "estimation/dense_problem.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

constexpr double kNoHuber = 0.0;
constexpr double kHuber = 2.0;

// What varies: the lens, where landmarks come from, what is held, and the loss.
struct Case {
  int camera;
  LandmarkOrigin origin;
  int fixed_keyframes;
  int fixed_landmark;
  bool intrinsics;
  double huber;
};

class LinearSegmentTest : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    const Case& c = GetParam();
    truth_ = ordinaryCameras()[c.camera];
    made_ = smallSegment(truth_, c.origin, 0.3, 11 + c.camera);
    segment_ = perturbed(made_.segment, SegmentPerturbation{0.005, 0.003, 0.03, 0.001}, 3);
    camera_ = perturbedCamera(truth_, 5, 0.3);
    block_ = {&segment_, c.fixed_keyframes, c.fixed_landmark, 1.7};
    count_ = c.intrinsics ? camera_.estimatedCount() : 0;
    linear_.linearize(block_, camera_, count_, c.huber, true);
  }

  Camera truth_;
  SimulatedSegment made_;
  Segment segment_;
  Camera camera_;
  SegmentBlock block_;
  int count_ = 0;
  LinearSegment linear_;
};

// b = J^T W r, in the order of DenseProblem.
Eigen::VectorXd gradientOf(const LinearSegment& linear, const DenseProblem& dense) {
  Eigen::VectorXd own(linear.variables());
  linear.copyGradient(own);
  return dense.join(own, linear.intrinsicsGradient());
}

// H entry by entry, out of its quadratic form.
Eigen::MatrixXd hessianOf(const LinearSegment& linear, const DenseProblem& dense) {
  const int n = dense.variables();
  const auto form = [&](const Eigen::VectorXd& v) {
    return linear.curvature(dense.ownStep(v), dense.intrinsicsStep(v));
  };
  // Scaled to a unit diagonal, which keeps the polarisation's digits.
  Eigen::VectorXd scale(n);
  for (int i = 0; i < n; ++i) scale(i) = 1.0 / std::sqrt(form(Eigen::VectorXd::Unit(n, i)));
  Eigen::MatrixXd hessian(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      const Eigen::VectorXd a = scale(i) * Eigen::VectorXd::Unit(n, i);
      const Eigen::VectorXd b = scale(j) * Eigen::VectorXd::Unit(n, j);
      const double value = 0.25 * (form(a + b) - form(a - b)) / (scale(i) * scale(j));
      hessian(i, j) = hessian(j, i) = value;
    }
  }
  return hessian;
}

TEST_P(LinearSegmentTest, GradientIsThatOfTheCost) {
  const DenseProblem dense(block_, camera_, count_);
  const double huber = GetParam().huber;
  ASSERT_EQ(linear_.variables() + linear_.intrinsicsCount(), dense.variables());
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(dense.variables());
  EXPECT_NEAR(linear_.cost(), dense.cost(zero, huber), 1e-9 * linear_.cost());
  EXPECT_NEAR(linear_.cost(), robustCost(block_, camera_, huber), 1e-12 * linear_.cost());
  const Eigen::VectorXd gradient = gradientOf(linear_, dense);
  const Eigen::VectorXd sizes = dense.stepSizes();
  for (int i = 0; i < dense.variables(); ++i) {
    // Steps so small that hardly a residual crosses Huber's threshold, where its second derivative
    // jumps.
    const Eigen::VectorXd step = 1e-3 * sizes(i) * Eigen::VectorXd::Unit(dense.variables(), i);
    const double numeric =
        -(dense.cost(step, huber) - dense.cost(-step, huber)) / (2e-3 * sizes(i));
    EXPECT_NEAR(gradient(i), numeric, 1e-5 * std::abs(numeric) + 1e-6 * gradient.norm()) << i;
  }
}

TEST_P(LinearSegmentTest, HessianIsThatOfTheNumericJacobian) {
  const DenseProblem dense(block_, camera_, count_);
  const Eigen::MatrixXd weighted =
      dense.rootWeights(GetParam().huber).asDiagonal() * dense.jacobian();
  const Eigen::MatrixXd numeric = weighted.transpose() * weighted;
  const Eigen::MatrixXd hessian = hessianOf(linear_, dense);
  for (int i = 0; i < dense.variables(); ++i) {
    for (int j = 0; j <= i; ++j) {
      EXPECT_NEAR(hessian(i, j), numeric(i, j), 1e-6 * std::sqrt(numeric(i, i) * numeric(j, j)))
          << i << " " << j;
    }
  }
  Eigen::VectorXd own(linear_.variables());
  linear_.copyDiagonal(own);
  const Eigen::VectorXd diagonal = dense.join(own, linear_.intrinsicsDiagonal());
  EXPECT_TRUE(diagonal.isApprox(hessian.diagonal(), 1e-9));
}

TEST_P(LinearSegmentTest, ReducedCostIsTheLeastOverTheSegmentsVariables) {
  const DenseProblem dense(block_, camera_, count_);
  const Eigen::VectorXd weights = dense.rootWeights(GetParam().huber);
  const Eigen::VectorXd residuals =
      weights.cwiseProduct(dense.residuals(Eigen::VectorXd::Zero(dense.variables())));
  Eigen::MatrixXd own = (weights.asDiagonal() * dense.jacobian()).leftCols(linear_.variables());
  own.colwise().normalize();
  const Eigen::VectorXd least = residuals - own * own.colPivHouseholderQr().solve(residuals);
  linear_.eliminate(0.0);
  EXPECT_NEAR(linear_.reducedCost(), 0.5 * least.squaredNorm(), 1e-4 * linear_.cost());
  EXPECT_LT(linear_.reducedCost(), 0.9 * linear_.cost());
}

TEST_P(LinearSegmentTest, EliminationSolvesTheFullNormalEquations) {
  const DenseProblem dense(block_, camera_, count_);
  const Eigen::MatrixXd hessian = hessianOf(linear_, dense);
  const Eigen::VectorXd scale = hessian.diagonal().cwiseSqrt().cwiseInverse();
  for (const double damping : {0.0, 1e-3}) {
    Eigen::MatrixXd damped = hessian;
    damped.diagonal() *= 1.0 + damping;
    const Eigen::MatrixXd scaled = scale.asDiagonal() * damped * scale.asDiagonal();
    const Eigen::LDLT<Eigen::MatrixXd> factor(scaled);
    const Eigen::VectorXd gradient = gradientOf(linear_, dense);
    const Eigen::VectorXd step =
        scale.asDiagonal() * factor.solve(scale.asDiagonal() * gradient).eval();

    linear_.eliminate(damping);
    Intrinsics intrinsics_step(count_);
    if (count_ > 0) {
      intrinsics_step = Eigen::MatrixXd(linear_.reducedHessian())
                            .ldlt()
                            .solve(Eigen::VectorXd(linear_.reducedGradient()));
    }
    Eigen::VectorXd own(linear_.variables());
    linear_.backSubstitute(intrinsics_step, own);
    const Eigen::VectorXd nested = dense.join(own, intrinsics_step);
    // In units of each variable's conditional sigma.
    const Eigen::VectorXd difference = (nested - step).cwiseQuotient(scale);
    EXPECT_LT(difference.norm(), 1e-6 * step.cwiseQuotient(scale).norm());

    if (count_ == 0) continue;
    const Eigen::MatrixXd inverse =
        scale.asDiagonal() *
        factor.solve(Eigen::MatrixXd::Identity(dense.variables(), dense.variables())) *
        scale.asDiagonal();
    const Eigen::MatrixXd marginal = inverse.bottomRightCorner(count_, count_).inverse();
    const Eigen::VectorXd unit = marginal.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd off = unit.asDiagonal() *
                                (Eigen::MatrixXd(linear_.reducedHessian()) - marginal) *
                                unit.asDiagonal();
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-6);
  }
}

// Of each track by itself, with everything but the intrinsics projected out.
TEST_P(LinearSegmentTest, TrackScoresAreThoseOfTheDenseSystem) {
  if (count_ == 0) return;
  const DenseProblem dense(block_, camera_, count_);
  const Eigen::VectorXd roots = dense.rootWeights(GetParam().huber);
  const Eigen::VectorXd residuals =
      roots.cwiseProduct(dense.residuals(Eigen::VectorXd::Zero(dense.variables())));
  const Eigen::MatrixXd jacobian = roots.asDiagonal() * dense.jacobian();
  const int rest = dense.variables() - count_;
  const Eigen::MatrixXd hessian = jacobian.transpose() * jacobian;
  const Eigen::MatrixXd gain =  // H_cr H_rr^-1
      hessian.topLeftCorner(rest, rest)
          .ldlt()
          .solve(hessian.topRightCorner(rest, count_))
          .transpose();
  Eigen::MatrixXd gradients = Eigen::MatrixXd::Zero(dense.variables(), segment_.landmarks.size());
  for (std::size_t o = 0; o < segment_.observations.size(); ++o) {
    gradients.col(segment_.observations[o].landmark) +=
        jacobian.middleRows(2 * o, 2).transpose() * residuals.segment<2>(2 * o);
  }
  const Eigen::MatrixXd scores = gradients.bottomRows(count_) - gain * gradients.topRows(rest);
  const Eigen::MatrixXd expected = scores * scores.transpose();
  linear_.eliminate(0.0);
  const Eigen::VectorXd scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd difference =
      scale.asDiagonal() * (Eigen::MatrixXd(linear_.trackScores()) - expected) * scale.asDiagonal();
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-5);
}

std::vector<Case> cases() {
  std::vector<Case> list;
  for (int camera = 0; camera < 4; ++camera) {
    list.push_back({camera, LandmarkOrigin::kAnchored, 1, 0, true, kNoHuber});
    list.push_back({camera, LandmarkOrigin::kInherited, 1, 0, true, kHuber});
    list.push_back({camera, LandmarkOrigin::kMixed, 1, 3, true, kHuber});
    list.push_back({camera, LandmarkOrigin::kMixed, 1, 3, false, kNoHuber});
    list.push_back({camera, LandmarkOrigin::kMixed, 3, -1, false, kHuber});
    list.push_back({camera, LandmarkOrigin::kMixed, 2, -1, true, kNoHuber});
  }
  return list;
}

INSTANTIATE_TEST_SUITE_P(Cases, LinearSegmentTest, testing::ValuesIn(cases()));

TEST(LinearSegment, SegmentsAddInTheMarginal) {
  const Camera camera = ordinaryCameras()[1];
  SimulatedSegment a = smallSegment(camera, LandmarkOrigin::kMixed, 0.3, 1);
  SimulatedSegment b = smallSegment(camera, LandmarkOrigin::kMixed, 0.3, 2);
  Camera shared = camera;
  const SegmentBlock block_a{&a.segment, 1, 0, 1.0};
  const SegmentBlock block_b{&b.segment, 1, 0, 2.0};
  const Marginal both = marginalize({&shared, true, {block_a, block_b}}, kHuber);
  const Marginal one = marginalize({&shared, true, {block_a}}, kHuber);
  const Marginal two = marginalize({&shared, true, {block_b}}, kHuber);
  EXPECT_TRUE(both.information.isApprox(one.information + two.information, 1e-12));
  EXPECT_NEAR(both.cost, one.cost + two.cost, 1e-9 * both.cost);
  EXPECT_EQ(both.observations, one.observations + two.observations);
  EXPECT_EQ(both.variables, one.variables + two.variables - camera.estimatedCount());
}

// The map's unit is anybody's choice, and runs away where the camera turns on the spot.
TEST(LinearSegment, TheUnitOfTheMapDoesNotMatter) {
  Camera camera = ordinaryCameras()[2];
  const SimulatedSegment made = smallSegment(camera, LandmarkOrigin::kMixed, 0.3, 7);
  const auto marginalIn = [&](double unit, InverseDepthNoise noise) {
    Segment segment = made.segment;
    for (Keyframe& keyframe : segment.keyframes) keyframe.world_from_camera.translation /= unit;
    for (Landmark& landmark : segment.landmarks) landmark.inverse_depth *= unit;
    return marginalize({&camera, true, {{&segment, 1, 0, 1.0}}}, kHuber, 1, noise);
  };
  for (const InverseDepthNoise noise :
       {InverseDepthNoise::kCounts, InverseDepthNoise::kDiscounted}) {
    const Marginal metric = marginalIn(1.0, noise);
    for (const double unit : {1e-30, 1e-15, 1e-9, 1e9, 1e15, 1e30}) {
      const Marginal other = marginalIn(unit, noise);
      EXPECT_TRUE(other.information.isApprox(metric.information, 1e-6)) << unit;
      EXPECT_TRUE(other.track_scores.isApprox(metric.track_scores, 1e-6)) << unit;
    }
  }
}

TEST(LinearSegment, PointsThatCannotBePredictedCostAndDoNotPull) {
  const Camera camera = ordinaryCameras()[0];
  SimulatedSegment made = smallSegment(camera, LandmarkOrigin::kAnchored, 0.0, 4);
  const SegmentBlock block{&made.segment, 1, -1, 1.0};
  const double before = robustCost(block, camera, kNoHuber);
  // Behind the camera.
  const int landmark = made.segment.observations[0].landmark;
  made.segment.landmarks[landmark].inverse_depth = -100.0;
  int lost = 0;
  for (const Observation& o : made.segment.observations) lost += o.landmark == landmark;
  const double sigma = made.segment.observations[0].sigma;
  EXPECT_NEAR(robustCost(block, camera, kNoHuber) - before, lost * 0.5 * 2500.0 / (sigma * sigma),
              1e-6 * lost / (sigma * sigma));
  LinearSegment linear;
  linear.linearize(block, camera, 4, kNoHuber);
  EXPECT_NEAR(linear.cost(), robustCost(block, camera, kNoHuber), 1e-6);
  Eigen::VectorXd own(linear.variables());
  const int row = linear.poseColumns() + landmark;
  linear.copyGradient(own);
  EXPECT_EQ(own(row), 0.0);
  linear.copyDiagonal(own);
  EXPECT_EQ(own(row), 0.0);
  linear.eliminate(0.0);
  EXPECT_TRUE(linear.reducedHessian().allFinite());
  linear.backSubstitute(Intrinsics::Zero(4), own);
  EXPECT_EQ(own(row), 0.0);
}

// Nothing depends on the order in which a segment lists its observations.
TEST(LinearSegment, ObservationsMayComeInAnyOrder) {
  const Camera camera = ordinaryCameras()[1];
  SimulatedSegment made = smallSegment(camera, LandmarkOrigin::kMixed, 0.3, 6);
  const SegmentBlock block{&made.segment, 1, 2, 1.0};
  const auto reduced = [&] {
    LinearSegment linear;
    linear.linearize(block, camera, camera.estimatedCount(), kHuber);
    linear.eliminate(0.0);
    return Eigen::MatrixXd(linear.reducedHessian());
  };
  const Eigen::MatrixXd grouped = reduced();
  std::mt19937 random(3);
  std::shuffle(made.segment.observations.begin(), made.segment.observations.end(), random);
  EXPECT_TRUE(reduced().isApprox(grouped, 1e-9));
}

TEST(PseudoInverse, OfRegularAndSingularMatrices) {
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(6, 6);
  const Eigen::MatrixXd regular = root * root.transpose() + Eigen::MatrixXd::Identity(6, 6);
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(6, 6);
  PseudoInverse inverse;
  inverse.compute(regular, 1e-12);
  EXPECT_EQ(inverse.rank(), 6);
  EXPECT_TRUE(inverse.solve(identity).isApprox(regular.inverse(), 1e-10));
  Eigen::MatrixXd whitened, back;
  inverse.whiten(regular, &whitened);
  EXPECT_TRUE((whitened.transpose() * whitened).isApprox(regular, 1e-10));
  inverse.unwhiten(whitened, &back);
  EXPECT_TRUE(back.isApprox(identity, 1e-10));

  const Eigen::MatrixXd thin = Eigen::MatrixXd::Random(6, 4);
  const Eigen::MatrixXd singular = thin * thin.transpose();
  inverse.compute(singular, 1e-12);
  EXPECT_EQ(inverse.rank(), 4);
  EXPECT_TRUE((singular * inverse.solve(singular)).isApprox(singular, 1e-9));
  inverse.whiten(singular, &whitened);
  EXPECT_TRUE((whitened.transpose() * whitened).isApprox(singular, 1e-9));

  inverse.compute(Eigen::MatrixXd::Zero(3, 3), 1e-12);
  EXPECT_EQ(inverse.rank(), 0);
  EXPECT_TRUE(inverse.solve(Eigen::VectorXd::Ones(3)).isZero(0.0));
  inverse.compute(Eigen::MatrixXd(0, 0), 1e-12);
  EXPECT_EQ(inverse.rank(), 0);
}

}  // namespace
}  // namespace camera_self_calibration
