#include "camera_self_calibration/estimation/solver.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

const LandmarkOrigin kOrigins[] = {LandmarkOrigin::kAnchored, LandmarkOrigin::kInherited,
                                   LandmarkOrigin::kMixed};

SolverOptions thorough() {
  SolverOptions options;
  options.max_iterations = 100;
  return options;
}

// Largest difference of two information matrices, scaled to a unit diagonal.
double scaledDifference(const IntrinsicsMatrix& a, const IntrinsicsMatrix& b) {
  const Eigen::VectorXd scale = a.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

TEST(Solve, ReachesTheTruthWithoutNoise) {
  for (const Camera& truth : ordinaryCameras()) {
    for (const LandmarkOrigin origin : kOrigins) {
      const SimulatedSegment made = smallSegment(truth, origin, 0.0, 21, 8, 60);
      Segment segment = perturbed(made.segment, SegmentPerturbation(), 4);
      Camera camera = perturbedCamera(truth, 4);
      const SolveSummary summary =
          solve({&camera, true, {freeBlock(&segment, camera)}}, thorough());
      EXPECT_TRUE(summary.usable);
      EXPECT_TRUE(summary.converged);
      EXPECT_LT(summary.final_cost, 1e-8);
      EXPECT_LT((camera.parameters() - truth.parameters()).cwiseAbs().maxCoeff(), 1e-6)
          << toString(truth.model()) << " " << static_cast<int>(origin);
    }
  }
}

TEST(Solve, HoldsWhatIsHeld) {
  const Camera truth = ordinaryCameras()[1];
  const SimulatedSegment made = smallSegment(truth, LandmarkOrigin::kMixed, 0.3, 5, 8, 40);
  Segment segment = perturbed(made.segment, SegmentPerturbation(), 4);
  const Segment start = segment;
  Camera camera = perturbedCamera(truth, 4);
  const Camera camera_before = camera;
  const SegmentBlock block{&segment, 3, 2, 1.0};
  EXPECT_TRUE(solve({&camera, false, {block}}, thorough()).usable);
  EXPECT_EQ(camera.parameters(), camera_before.parameters());
  EXPECT_EQ(segment.landmarks[2].inverse_depth, start.landmarks[2].inverse_depth);
  for (int k = 0; k < 8; ++k) {
    const bool same = segment.keyframes[k].world_from_camera.translation ==
                      start.keyframes[k].world_from_camera.translation;
    EXPECT_EQ(same, k < 3);
  }
}

// Intrinsics that are held do not say when the rest has settled.
TEST(Solve, HeldIntrinsicsEndNothingEarly) {
  const Camera truth = ordinaryCameras()[1];
  const SimulatedSegment made = smallSegment(truth, LandmarkOrigin::kMixed, 0.3, 5, 8, 40);
  Segment segment = perturbed(made.segment, SegmentPerturbation(), 4);
  Segment other = segment;
  Camera camera = truth;
  SolverOptions options = thorough();
  const double settled = solve({&camera, false, {freeBlock(&segment, camera)}}, options).final_cost;
  options.intrinsics_precision = 0.02;
  EXPECT_EQ(solve({&camera, false, {freeBlock(&other, camera)}}, options).final_cost, settled);
}

TEST(Solve, NeverEndsWorseThanItBegan) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Camera truth = ordinaryCameras()[seed % 4];
    const SimulatedSegment made = smallSegment(truth, LandmarkOrigin::kMixed, 0.5, seed, 6, 30);
    SegmentPerturbation wild;
    wild.translation_m = 0.3;
    wild.rotation_rad = 0.2;
    wild.inverse_depth = 1.0;
    Segment segment = perturbed(made.segment, wild, seed);
    Camera camera = perturbedCamera(truth, seed, 10.0);
    const SegmentBlock block = freeBlock(&segment, camera);
    const SolveSummary summary = solve({&camera, true, {block}}, SolverOptions());
    ASSERT_TRUE(summary.usable);
    EXPECT_LE(summary.final_cost, summary.initial_cost);
    EXPECT_NEAR(robustCost(block, camera, SolverOptions().huber), summary.final_cost,
                1e-9 * summary.final_cost);
    EXPECT_TRUE(camera.valid());
  }
}

TEST(Solve, IsTheSameForAnyNumberOfThreads) {
  const Camera truth = ordinaryCameras()[1];
  std::vector<Camera> cameras;
  std::vector<Rigid3> poses;
  std::vector<IntrinsicsMatrix> information;
  for (const int threads : {1, 2, 3}) {
    std::vector<Segment> segments;
    for (std::uint64_t s = 0; s < 5; ++s) {
      const SimulatedSegment made = smallSegment(truth, LandmarkOrigin::kMixed, 0.3, s, 6, 40);
      segments.push_back(perturbed(made.segment, SegmentPerturbation(), s));
    }
    Camera camera = perturbedCamera(truth, 9);
    Problem problem{&camera, true, {}};
    for (Segment& segment : segments) problem.blocks.push_back(freeBlock(&segment, camera));
    SolverOptions options;
    options.threads = threads;
    EXPECT_TRUE(solve(problem, options).usable);
    cameras.push_back(camera);
    poses.push_back(segments[3].keyframes.back().world_from_camera);
    information.push_back(marginalize(problem, options.huber, threads).information);
  }
  for (int i = 1; i < 3; ++i) {
    EXPECT_EQ(cameras[0].parameters(), cameras[i].parameters());
    EXPECT_EQ(poses[0].translation, poses[i].translation);
    EXPECT_EQ(poses[0].rotation.coeffs(), poses[i].rotation.coeffs());
    EXPECT_EQ(information[0], information[i]);
  }
}

TEST(Marginal, DoesNotDependOnTheGauge) {
  for (const Camera& truth : ordinaryCameras()) {
    for (const LandmarkOrigin origin : kOrigins) {
      SimulatedSegment made = smallSegment(truth, origin, 0.3, 31, 8, 40);
      Camera camera = truth;
      SegmentBlock block = freeBlock(&made.segment, camera);
      ASSERT_GE(block.fixed_landmark, 0);
      const Marginal first = marginalize({&camera, true, {block}}, 2.0);
      for (const int landmark : {0, 3, 7, 11}) {
        block.fixed_landmark = landmark;
        const Marginal other = marginalize({&camera, true, {block}}, 2.0);
        EXPECT_LT(scaledDifference(first.information, other.information), 1e-6)
            << toString(truth.model()) << " landmark " << landmark;
      }
    }
  }
}

TEST(Marginal, SurvivesPureRotation) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Camera truth = ordinaryCameras()[seed % 4];
    SegmentOptions options;
    options.camera = truth;
    options.motion = MotionKind::kRotationOnly;
    options.keyframes = 8;
    options.tracks.max_features = 50;
    SimulatedSegment made = makeSegment(options, seed);
    Segment segment = made.segment;
    Camera camera = perturbedCamera(truth, seed, 0.5);
    const Problem problem{&camera, true, {freeBlock(&segment, camera)}};
    const SolveSummary summary = solve(problem, thorough());
    ASSERT_TRUE(summary.usable) << seed;
    const Marginal marginal = marginalize(problem, 2.0);
    ASSERT_TRUE(marginal.information.allFinite()) << seed;
    EXPECT_GT(scaledEigenvalues(marginal.information)(0), 0.0) << seed;
    // Turning informs: the focal length is found, and known to be.
    const auto covariance = covarianceFromInformation(marginal.information);
    ASSERT_TRUE(covariance) << seed;
    EXPECT_LT(std::sqrt((*covariance)(0, 0)), 20.0) << seed;
    EXPECT_LT(std::abs(camera.parameters()(0) - truth.parameters()(0)),
              5.0 * std::sqrt((*covariance)(0, 0)) + 0.1)
        << seed;
  }
}

TEST(Solve, ChangesNothingThatItCannotEstimate) {
  Camera camera = ordinaryCameras()[0];
  const Camera before = camera;
  EXPECT_TRUE(solve({&camera, true, {}}, SolverOptions()).usable);
  EXPECT_EQ(camera.parameters(), before.parameters());
  Segment empty;
  EXPECT_EQ(freeBlock(&empty, camera).fixed_landmark, -1);
  EXPECT_TRUE(solve({&camera, true, {{&empty, 1, -1, 1.0}}}, SolverOptions()).usable);
  EXPECT_EQ(camera.parameters(), before.parameters());

  // A keyframe that sees nothing stays where it is.
  SimulatedSegment made = smallSegment(camera, LandmarkOrigin::kMixed, 0.2, 8, 6, 40);
  Segment segment = made.segment;
  Keyframe blind;
  blind.world_from_camera.translation << 1, 2, 3;
  segment.keyframes.push_back(blind);
  EXPECT_TRUE(solve({&camera, true, {freeBlock(&segment, camera)}}, SolverOptions()).usable);
  EXPECT_EQ(segment.keyframes.back().world_from_camera.translation, Eigen::Vector3d(1, 2, 3));
}

// A vague prior holds what nothing observes and leaves alone what is observed.
TEST(Solve, PriorMattersOnlyWhereNothingIsObserved) {
  const Camera truth = ordinaryCameras()[1];
  for (const MotionKind motion : {MotionKind::kHandheld, MotionKind::kForwardOnly}) {
    SegmentOptions options;
    options.camera = truth;
    options.motion = motion;
    options.tracks.max_features = 60;
    const SimulatedSegment made = makeSegment(options, 3);
    std::vector<Camera> solved;
    IntrinsicsMatrix information;
    Camera guess = Camera::defaultGuess(truth.model(), truth.width(), truth.height());
    const Intrinsics sigma = 0.1 * guess.parameters().cwiseAbs();
    for (const bool has_prior : {false, true}) {
      Segment segment = made.segment;
      Camera camera = motion == MotionKind::kHandheld ? truth : guess;
      Problem problem{&camera, true, {freeBlock(&segment, camera)}};
      if (has_prior) problem.prior = {guess.parameters(), sigma};
      EXPECT_TRUE(solve(problem, thorough()).usable);
      information = marginalize(problem, 2.0).information;
      solved.push_back(camera);
    }
    const Eigen::VectorXd moved = solved[1].parameters() - solved[0].parameters();
    if (motion == MotionKind::kHandheld) {
      EXPECT_LT(std::sqrt(moved.dot(information * moved)), 0.2) << "sigma";
      EXPECT_GT(moved.norm(), 0.0);
    } else {
      const Eigen::VectorXd off = solved[1].parameters() - guess.parameters();
      EXPECT_LT(off.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 3.0);
    }
  }
}

// The length of the step that is still to go, in sigmas: none at the optimum, the distance nearby.
TEST(Marginal, TellsHowFarTheOptimumIs) {
  const Camera truth = ordinaryCameras()[1];
  const SimulatedSegment made = smallSegment(truth, LandmarkOrigin::kMixed, 0.3, 5, 8, 40);
  Segment segment = made.segment;
  Camera camera = truth;
  Problem problem{&camera, true, {freeBlock(&segment, camera)}};
  problem.blocks.front().sigma_scale = 1.0;
  ASSERT_TRUE(solve(problem, thorough()).usable);
  const Marginal best = marginalize(problem, 2.0);
  EXPECT_LT(best.remainingStep(), 1e-3);
  Intrinsics moved = camera.parameters();
  moved(4) += 0.5 / std::sqrt(best.information(4, 4));
  camera.setParameters(moved);
  EXPECT_NEAR(marginalize(problem, 2.0).remainingStep(), 0.5, 0.1);
}

TEST(IntrinsicsPrior, GradientIsThatOfItsCost) {
  const Camera camera = ordinaryCameras()[1];
  const IntrinsicsPrior prior{Intrinsics::Constant(4, 100.0), Intrinsics::Constant(4, 20.0), 0.2};
  const Intrinsics gradient = prior.gradient(camera.parameters(), 5);
  for (int i = 0; i < 5; ++i) {
    Intrinsics up = camera.parameters(), down = up;
    up(i) += 1e-3;
    down(i) -= 1e-3;
    EXPECT_NEAR(gradient(i), -(prior.cost(up, 5) - prior.cost(down, 5)) / 2e-3, 1e-6);
  }
  EXPECT_TRUE(prior.information(camera.parameters(), 5).col(4).isZero());
  EXPECT_EQ(IntrinsicsPrior().cost(camera.parameters(), 5), 0.0);
}

// As when k3 joins.
TEST(IntrinsicsPrior, KnowsNothingOfParametersWithoutASigma) {
  const IntrinsicsPrior prior{Intrinsics::Constant(9, 0.1), Intrinsics::Constant(8, 0.5)};
  const IntrinsicsPrior same{Intrinsics::Constant(8, 0.1), Intrinsics::Constant(8, 0.5)};
  const Intrinsics parameters = Intrinsics::Constant(9, 0.3);
  EXPECT_EQ(prior.cost(parameters, 9), same.cost(parameters, 9));
  EXPECT_EQ(prior.gradient(parameters, 9), same.gradient(parameters, 9));
  EXPECT_EQ(prior.gradient(parameters, 9)(8), 0.0);
  EXPECT_EQ(prior.information(parameters, 9)(8, 8), 0.0);
}

TEST(IntrinsicsPrior, AspectKnowsNothingOfTheFocalLength) {
  const IntrinsicsPrior prior{{}, {}, 0.2};
  const Intrinsics square = Eigen::Vector4d(300.0, 300.0, 320.0, 240.0);
  Intrinsics flat = square;
  flat(0) *= std::exp(0.2);
  EXPECT_EQ(prior.cost(square, 4), 0.0);
  EXPECT_NEAR(prior.cost(flat, 4), 0.5, 1e-12);
  Intrinsics longer = flat;
  longer.head<2>() *= 2.0;
  EXPECT_NEAR(prior.cost(longer, 4), 0.5, 1e-12);
  Intrinsics both = Intrinsics::Zero(4);
  both.head<2>() = flat.head<2>();
  EXPECT_NEAR((prior.information(flat, 4) * both).norm(), 0.0, 1e-12);
  // Gauss-Newton's step leads to square pixels, of one focal length as well as of another.
  const Intrinsics gradient = prior.gradient(flat, 4);
  EXPECT_LT(gradient(0), 0.0);
  EXPECT_GT(gradient(1), 0.0);
}

TEST(FreeBlock, TakesTheBestDepthAmongTheMostSeen) {
  const Camera camera = ordinaryCameras()[1];
  SimulatedSegment made = smallSegment(camera, LandmarkOrigin::kAnchored, 0.0, 12, 6, 30);
  const SegmentBlock block = freeBlock(&made.segment, camera);
  std::vector<int> counts(made.segment.landmarks.size(), 0);
  for (const Observation& o : made.segment.observations) ++counts[o.landmark];
  ASSERT_GE(block.fixed_landmark, 0);
  EXPECT_EQ(block.fixed_keyframes, 1);
  EXPECT_EQ(counts[block.fixed_landmark], *std::max_element(counts.begin(), counts.end()));
  // A point at infinity cannot fix the scale.
  made.segment.landmarks[block.fixed_landmark].inverse_depth = 0.0;
  EXPECT_NE(freeBlock(&made.segment, camera).fixed_landmark, block.fixed_landmark);
}

TEST(Covariance, InvertsOrRefuses) {
  Random random(1);
  Eigen::MatrixXd root(5, 5);
  for (int i = 0; i < 25; ++i) root(i) = random.normal();
  const IntrinsicsMatrix information = root * root.transpose();
  const auto covariance = covarianceFromInformation(information);
  ASSERT_TRUE(covariance);
  EXPECT_TRUE((*covariance * information).isApprox(Eigen::MatrixXd::Identity(5, 5), 1e-8));
  // The units of a parameter do not matter.
  Intrinsics units(5);
  units << 1e6, 1.0, 1e-6, 1e3, 1e-3;
  EXPECT_TRUE(scaledEigenvalues(units.asDiagonal() * information * units.asDiagonal())
                  .isApprox(scaledEigenvalues(information), 1e-6));
  IntrinsicsMatrix singular = information;
  singular.row(1) = singular.row(0);
  singular.col(1) = singular.col(0);
  EXPECT_FALSE(covarianceFromInformation(singular));
  EXPECT_FALSE(covarianceFromInformation(IntrinsicsMatrix::Zero(5, 5)));
  EXPECT_FALSE(covarianceFromInformation(IntrinsicsMatrix()));
}

}  // namespace
}  // namespace camera_self_calibration
