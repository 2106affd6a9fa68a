#include "camera_self_calibration/tracking/carried_features.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <random>
#include <set>

namespace camera_self_calibration {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kSigma = 0.1;  // [px]
const Eigen::Vector2d kCentre(320.0, 240.0);

// Features on a grid of 40 px; each image leads all of them from where they began.
class Video {
 public:
  using Motion = std::function<Eigen::Vector2d(const Eigen::Vector2d& begin, int image)>;

  Video() {
    for (double y = 20.0; y < kHeight; y += 40.0) {
      for (double x = 20.0; x < kWidth; x += 40.0) begins_.emplace_back(x, y);
    }
  }

  // Those that are found out, by where they began.
  std::vector<Eigen::Vector2d> play(int images, const Motion& motion, CarriedFeatures* carried) {
    std::set<std::int64_t> ended;
    std::vector<Eigen::Vector2d> found;
    for (int image = 0; image < images; ++image) {
      const TrackedFrame frame = show(image, motion, ended);
      for (const std::int64_t id : carried->add(frame)) {
        EXPECT_TRUE(ended.insert(id).second);
        found.push_back(begins_[static_cast<std::size_t>(id)]);
      }
    }
    return found;
  }

 private:
  TrackedFrame show(int image, const Motion& motion, const std::set<std::int64_t>& ended) {
    TrackedFrame frame;
    frame.width = kWidth;
    frame.height = kHeight;
    for (std::size_t i = 0; i < begins_.size(); ++i) {
      const auto id = static_cast<std::int64_t>(i);
      const Eigen::Vector2d pixel = motion(begins_[i], image);
      const bool inside =
          pixel.x() > 0.0 && pixel.x() < kWidth && pixel.y() > 0.0 && pixel.y() < kHeight;
      if (!inside || ended.count(id) > 0) continue;
      const Eigen::Vector2d noise(kSigma * normal_(random_), kSigma * normal_(random_));
      frame.tracks.push_back({id, pixel + noise, begins_[i], kSigma});
    }
    return frame;
  }

  std::vector<Eigen::Vector2d> begins_;
  std::mt19937_64 random_{5};
  std::normal_distribution<double> normal_;
};

bool onTheArm(const Eigen::Vector2d& begin) { return begin.y() > 300.0 && begin.x() < 400.0; }

// The camera turns, 3 px an image.
Eigen::Vector2d turning(const Eigen::Vector2d& begin, int image) {
  return begin + Eigen::Vector2d(3.0 * image, -1.0 * image);
}

Eigen::Vector2d turningWithAnArm(const Eigen::Vector2d& begin, int image) {
  return onTheArm(begin) ? begin : turning(begin, image);
}

TEST(CarriedFeatures, AreThoseThatStandStillWhileTheSceneMoves) {
  CarriedFeatures carried;
  const std::vector<Eigen::Vector2d> found = Video().play(60, turningWithAnArm, &carried);
  EXPECT_EQ(found.size(), 4u * 10u);
  for (const Eigen::Vector2d& begin : found) EXPECT_TRUE(onTheArm(begin)) << begin.transpose();
  EXPECT_TRUE(carried.near({180.0, 400.0}, 30.0));
  EXPECT_FALSE(carried.near({500.0, 100.0}, 30.0));
  carried.clear();
  EXPECT_FALSE(carried.near({180.0, 400.0}, 30.0));
}

// Whatever passes before it.
TEST(CarriedFeatures, ACameraAtRestCarriesNothing) {
  const auto passing = [](const Eigen::Vector2d& begin, int image) {
    return onTheArm(begin) ? turning(begin, image) : begin;
  };
  CarriedFeatures carried;
  EXPECT_TRUE(Video().play(60, passing, &carried).empty());
}

TEST(CarriedFeatures, NeitherTheAxisOfARollNorThePointDrivenToIsCarried) {
  const auto rolling = [](const Eigen::Vector2d& begin, int image) -> Eigen::Vector2d {
    return kCentre + Eigen::Rotation2Dd(0.02 * image) * (begin - kCentre);
  };
  const auto driving = [](const Eigen::Vector2d& begin, int image) -> Eigen::Vector2d {
    return kCentre + (begin - kCentre) / (1.0 - 0.01 * image);
  };
  CarriedFeatures carried;
  EXPECT_TRUE(Video().play(150, rolling, &carried).empty());
  carried.clear();
  EXPECT_TRUE(Video().play(70, driving, &carried).empty());
}

// Twenty times as far as what passes before it, and no rotation.
TEST(CarriedFeatures, TheDistanceIsNotCarried) {
  const auto sideways = [](const Eigen::Vector2d& begin, int image) -> Eigen::Vector2d {
    return begin + Eigen::Vector2d(begin.y() < 160.0 ? 0.15 * image : 3.0 * image, 0.0);
  };
  CarriedFeatures carried;
  EXPECT_TRUE(Video().play(150, sideways, &carried).empty());
}

TEST(CarriedFeatures, APlaceIsTriedAgain) {
  CarriedFeatures carried;
  ASSERT_FALSE(Video().play(60, turningWithAnArm, &carried).empty());
  const auto swaying = [](const Eigen::Vector2d& begin, int image) -> Eigen::Vector2d {
    return begin + Eigen::Vector2d(image % 2 == 0 ? 0.0 : 20.0, 0.0);
  };
  // It took about 50 px to find them out.
  Video().play(100, swaying, &carried);
  EXPECT_TRUE(carried.near({180.0, 400.0}, 30.0));
  Video().play(900, swaying, &carried);
  EXPECT_FALSE(carried.near({180.0, 400.0}, 30.0));
}

}  // namespace
}  // namespace camera_self_calibration
