#include "two_views.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr double kNoise = 1e-3;

struct Pairs {
  Rigid3 second_from_first;
  std::vector<RayPair> rays;
  std::vector<double> inverse_depths;
};

// A camera that drives ahead between points that are `nearest` to 20 times as many of its steps
// away; the first of them are outliers in the second view.
Pairs driving(int count, std::uint64_t seed, double outlier_share = 0.25, double nearest = 3.0,
              double noise = kNoise) {
  Random random(seed);
  const auto unit = [&random] { return random.uniform(-1.0, 1.0); };
  Pairs pairs;
  pairs.second_from_first = {Eigen::Quaterniond(expSo3(Eigen::Vector3d(0.01, -0.03, 0.02))),
                             Eigen::Vector3d(0.05, 0.02, -1.0).normalized()};
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d first = Eigen::Vector3d(unit(), 0.4 * unit(), 1.0).normalized();
    const double depth = nearest * std::pow(20.0, random.uniform());
    Eigen::Vector3d second = pairs.second_from_first * (depth * first);
    second /= second.z();
    second.head<2>() += noise * random.normal2();
    const bool outlier = i < outlier_share * count;
    if (outlier) second += Eigen::Vector3d(0.3 * unit(), 0.3 + 0.1 * unit(), 0.0);
    pairs.rays.push_back({first, second.normalized()});
    pairs.inverse_depths.push_back(outlier ? 0.0 : 1.0 / depth);
  }
  return pairs;
}

TEST(RelateViews, FindsPoseAndDepthsAmongOutliers) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const Pairs truth = driving(80, seed);
    const auto views = relateViews(truth.rays, 3.0 * kNoise);
    ASSERT_TRUE(views);
    const Rigid3& found = views->second_from_first;
    EXPECT_LT(logSo3(found.rotation.conjugate() * truth.second_from_first.rotation).norm(), 0.005);
    EXPECT_NEAR(found.translation.norm(), 1.0, 1e-12);
    EXPECT_LT((found.translation - truth.second_from_first.translation).norm(), 0.1);
    int left_out = 0, near = 0;
    for (std::size_t i = 0; i < truth.rays.size(); ++i) {
      if (i < 20) {
        left_out += views->inverse_depths[i] == 0.0;
      } else {
        near += std::abs(views->inverse_depths[i] - truth.inverse_depths[i]) < 0.05;
      }
    }
    EXPECT_GE(left_out, 18);  // of 20; one may lie on its line by chance
    EXPECT_GE(near, 50);      // of 60; near the point driven to nothing tells depths
  }
}

// Keyframes of a long lens lie a hundredth of the distance apart and less.
TEST(RelateViews, FarPointsCountToo) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Pairs truth = driving(80, seed, 0.0, 60.0, 0.1 * kNoise);
    const auto views = relateViews(truth.rays, 0.3 * kNoise);
    ASSERT_TRUE(views) << seed;
    int known = 0;
    for (const double inverse_depth : views->inverse_depths) known += inverse_depth > 0.0;
    EXPECT_GE(known, 60) << seed;
  }
}

TEST(RelateViews, IsTheSameEachTime) {
  const Pairs pairs = driving(60, 7);
  const auto once = relateViews(pairs.rays, 3.0 * kNoise);
  const auto again = relateViews(pairs.rays, 3.0 * kNoise);
  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->inverse_depths, again->inverse_depths);
  EXPECT_EQ(once->second_from_first.translation, again->second_from_first.translation);
}

TEST(RelateViews, NeedsEnoughThatAgrees) {
  EXPECT_FALSE(relateViews({}, 0.01));
  EXPECT_FALSE(relateViews(driving(7, 1, 0.0).rays, 0.01));
  Pairs sideways = driving(40, 1, 0.0);
  for (RayPair& pair : sideways.rays) pair.second = Eigen::Vector3d::UnitX();  // no plane has them
  EXPECT_FALSE(relateViews(sideways.rays, 0.01));
}

}  // namespace
}  // namespace camera_self_calibration
