// A lens beyond all models: its basis, its information, and what is found of it.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/camera/pixel_grid.h"
#include "camera_self_calibration/camera/rotation_compensation.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/model_choice/displacement_basis.h"
#include "camera_self_calibration/model_choice/displacement_marginal.h"
#include "camera_self_calibration/model_choice/free_displacement.h"
#include "model_choice/displaced_segments.h"

namespace camera_self_calibration {
namespace {

constexpr int kCount = DisplacementBasis::kCount;
const Camera kRadtan = camera640(CameraModel::kRadtan, {400, 404, 315, 243, -0.25, 0.05, 0, 0});
const Camera kWide = camera640(CameraModel::kFov, {311.2, 309.8, 327.4, 233.1, 0.93});

// Two bumps across the image, `height` [px] high.
Displace bumps(double height) {
  return [height](const Eigen::Vector2d& pixel) {
    const double x = 2.0 * M_PI * pixel.x() / 640.0;
    const double y = M_PI * pixel.y() / 480.0;
    return Eigen::Vector2d(pixel + height * std::sin(x) * std::sin(y) * Eigen::Vector2d(0.6, 0.8));
  };
}

// Distance between the lens and what its pixels are displaced to, a rotation removed.
double trueDistance(const Camera& camera, const Displace& displace) {
  std::vector<PixelRay> rays = pixelGrid(camera);
  for (PixelRay& ray : rays) ray.pixel = displace(ray.pixel);
  return bestRotation(rays, camera).error.rms;
}

LensObservations observationsOf(const std::vector<Segment>& segments) {
  return {segments, std::vector<double>(segments.size(), 1.0), Scatter()};
}

FreeDisplacement found(const std::vector<Segment>& segments, const Camera& start) {
  const LensObservations observations = observationsOf(segments);
  const LensTrial trial = tryLens(observations, start, 1);
  EXPECT_TRUE(trial.usable);
  return freeDisplacement(observations, trial, 1);
}

TEST(DisplacementBasis, HasShapesOfAPixelEach) {
  const DisplacementBasis basis(640, 480);
  // All polynomials are 1 where x = y = 1; the shear moves x by y.
  const DisplacementBasis::Displacements corner = basis.at({639, 479});
  for (int k = 0; k + 1 < kCount; ++k) {
    EXPECT_NEAR(corner(k % 2, k), 1.0, 1e-12) << k;
    EXPECT_EQ(corner(1 - k % 2, k), 0.0) << k;
  }
  EXPECT_NEAR(corner(0, kCount - 1), 1.0, 1e-12);
  EXPECT_EQ(corner(1, kCount - 1), 0.0);
  // Of degree two: P_2(y), x y, P_2(x).
  const DisplacementBasis::Displacements inner =
      basis.at({319.5 + 0.2 * 319.5, 239.5 - 0.6 * 239.5});
  EXPECT_NEAR(inner(0, 0), 0.5 * (3.0 * 0.36 - 1.0), 1e-12);
  EXPECT_NEAR(inner(1, 3), 0.2 * -0.6, 1e-12);
  EXPECT_NEAR(inner(0, 4), 0.5 * (3.0 * 0.04 - 1.0), 1e-12);
}

// With the displacement's rows and columns left out it is the marginal of the lens alone.
TEST(DisplacementMarginal, ContainsThatOfTheIntrinsics) {
  for (const Camera& truth : {kRadtan, kWide}) {
    std::vector<Segment> segments = separateSegments(truth, 2);
    Camera camera = truth;
    Problem problem;
    problem.camera = &camera;
    for (Segment& segment : segments) problem.blocks.push_back(freeBlock(&segment, camera));
    problem.blocks[1].sigma_scale = 1.3;
    const Marginal lens = marginalize(problem, 2.0);
    const DisplacementMarginal both = displacementMarginal(problem, 2.0, 1);
    const int n = camera.estimatedCount();
    ASSERT_EQ(both.sum.gradient.size(), n + kCount);
    EXPECT_LT((both.sum.information.topLeftCorner(n, n) - lens.information).norm(),
              1e-6 * lens.information.norm());
    EXPECT_LT((both.sum.gradient.head(n) - lens.gradient).norm(), 1e-6 * lens.gradient.norm());
    EXPECT_EQ(both.observations, lens.observations);
    EXPECT_EQ(both.variables, lens.variables);
    EXPECT_NEAR(both.cost, lens.cost, 1e-9 * lens.cost);
    EXPECT_LT((both.track_scores.topLeftCorner(n, n) - lens.track_scores).norm(),
              1e-6 * lens.track_scores.norm());
  }
}

// Without noise, from the true lens, poses and points, a small displacement is found to first
// order: its derivatives are right, those of the references' rays among them.
TEST(DisplacementMarginal, FindsACoefficientFromExactObservations) {
  for (const LandmarkOrigin origin : {LandmarkOrigin::kAnchored, LandmarkOrigin::kInherited}) {
    SegmentOptions options;
    options.camera = kRadtan;
    options.origin = origin;
    options.tracks.pixel_sigma = 0.0;
    const DisplacementBasis basis(640, 480);
    constexpr int kShape = 10;  // P_2(x) P_1(y), along x
    const auto bend = [&](const Eigen::Vector2d& pixel) {
      return Eigen::Vector2d(pixel + 0.01 * basis.at(pixel).col(kShape));
    };
    Segment segment = displaced(makeSegment(options, 5).segment, bend);
    Camera camera = kRadtan;
    const DisplacementMarginal marginal =
        displacementMarginal({&camera, true, {freeBlock(&segment, camera)}}, 0.0, 1);
    // All else is at its best.
    Eigen::VectorXd coefficient = Eigen::VectorXd::Zero(marginal.sum.gradient.size());
    coefficient(camera.estimatedCount() + kShape) = 0.01;
    const Eigen::VectorXd predicted = marginal.sum.information * coefficient;
    EXPECT_LT((marginal.sum.gradient - predicted).norm(), 0.02 * predicted.norm());
  }
}

TEST(FreeDisplacement, FindsWhatGoesBeyondTheModel) {
  for (const Camera& truth : {kRadtan, kWide}) {
    const Displace displace = bumps(0.6);
    const FreeDisplacement free = found(displacedSegments(truth, displace, 6), truth);
    EXPECT_LT(free.p_value, 1e-6);
    const double left = trueDistance(free.camera, displace);
    EXPECT_NEAR(free.distance({}).rms, left, 0.25 * left);
    EXPECT_LT(free.uncertainty({}).rms, 2.0 * left);
  }
}

TEST(FreeDisplacement, IsChanceWhereTheModelIsTrue) {
  int below_a_tenth = 0, below_six_tenths = 0;
  constexpr int kQueues = 12;
  for (int seed = 0; seed < kQueues; ++seed) {
    const Camera& truth = seed % 2 == 0 ? kRadtan : kWide;
    const FreeDisplacement free =
        found(separateSegments(truth, 3, static_cast<std::uint64_t>(100 + seed)), truth);
    EXPECT_GT(free.p_value, 1e-3) << seed;
    below_a_tenth += free.p_value < 0.1;
    below_six_tenths += free.p_value < 0.6;
    EXPECT_LT(free.distance({}).rms, 3.0 * free.uncertainty({}).rms) << seed;
  }
  EXPECT_LE(below_a_tenth, kQueues / 3);
  EXPECT_GE(below_six_tenths, kQueues / 6);
}

}  // namespace
}  // namespace camera_self_calibration
