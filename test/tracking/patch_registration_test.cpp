#include "camera_self_calibration/tracking/patch_registration.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace camera_self_calibration {
namespace {

constexpr int kSide = 96;
constexpr int kCentre = 48;

// A smooth pattern, known at any real coordinates.
class Waves {
 public:
  explicit Waves(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < 12; ++i) {
      const double length = 6.0 + 14.0 * unit(random), angle = 2.0 * M_PI * unit(random);
      const double k = 2.0 * M_PI / length;
      waves_.push_back({k * std::cos(angle), k * std::sin(angle), 2.0 * M_PI * unit(random)});
    }
  }

  double at(const Eigen::Vector2d& p) const {
    double sum = 0.0;
    for (const Eigen::Vector3d& wave : waves_) {
      sum += std::sin(wave.x() * p.x() + wave.y() * p.y() + wave.z());
    }
    return sum;
  }

  // The image in which the offset u from the pattern's centre is seen at pixel + linear * u.
  ImagePyramid image(const Warp& warp, double gain = 20.0, double offset = 128.0) const {
    std::vector<std::uint8_t> pixels(kSide * kSide);
    const Eigen::Matrix2d inverse = warp.linear.inverse();
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const double gray = gain * at(inverse * (Eigen::Vector2d(x, y) - warp.pixel)) + offset;
        pixels[static_cast<std::size_t>(y * kSide + x)] =
            static_cast<std::uint8_t>(std::lround(std::min(255.0, std::max(0.0, gray))));
      }
    }
    ImagePyramid pyramid;
    pyramid.build({nullptr, pixels.data(), kSide, kSide, kSide, 0});
    return pyramid;
  }

 private:
  std::vector<Eigen::Vector3d> waves_;
};

Warp at(double x, double y) { return {{x, y}, Eigen::Matrix2d::Identity()}; }

ReferencePatch referenceOf(const Waves& waves) {
  ReferencePatch reference;
  reference.cut(waves.image(at(kCentre, kCentre)).level(0), kCentre, kCentre);
  return reference;
}

TEST(PatchRegistration, WholePixelsDoNotAttract) {
  PatchRegistration registration;
  for (int step = 0; step <= 10; ++step) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const Waves waves(seed);
      ReferencePatch reference = referenceOf(waves);
      const Warp truth = at(kCentre + 0.1 * step, kCentre - 0.07 * step);
      const Registration result =
          registration.run(&reference, waves.image(truth), at(kCentre + 0.5, kCentre - 0.3));
      ASSERT_EQ(result.status, Registration::Status::kGood);
      // What rounding to whole gray values leaves.
      EXPECT_LT((result.pixel - truth.pixel).norm(), 0.03);
      sum += result.pixel - truth.pixel;
    }
    EXPECT_LT(sum.norm() / 10.0, 0.006) << step;
  }
}

TEST(PatchRegistration, FindsAffineWarpGainAndOffset) {
  PatchRegistration registration;
  Warp truth = at(49.3, 46.8);
  truth.linear << 1.12, -0.21, 0.16, 0.94;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Waves waves(seed);
    ReferencePatch reference = referenceOf(waves);
    Warp start = at(48.7, 47.4);
    start.linear << 1.08, -0.18, 0.18, 0.97;
    const Registration result =
        registration.run(&reference, waves.image(truth, 15.0, 110.0), start);
    ASSERT_EQ(result.status, Registration::Status::kGood);
    EXPECT_LT((result.pixel - truth.pixel).norm(), 0.02);
    EXPECT_LT((result.warp.linear - truth.linear).norm(), 0.02);
    EXPECT_NEAR(result.gain, 0.75, 0.03);
    EXPECT_LT(result.residual, 0.005 * result.contrast);
  }
}

TEST(PatchRegistration, TheAnchorOfACornerIsItsTip) {
  // A dark quadrant whose tip lies beside the patch's centre.
  std::vector<std::uint8_t> pixels(kSide * kSide, 180);
  for (int y = kCentre + 1; y < kSide; ++y) {
    for (int x = kCentre + 2; x < kSide; ++x) {
      pixels[static_cast<std::size_t>(y * kSide + x)] = 60;
    }
  }
  ImagePyramid pyramid;
  pyramid.build({nullptr, pixels.data(), kSide, kSide, kSide, 0});
  ReferencePatch reference;
  reference.cut(pyramid.level(0), kCentre, kCentre);
  ASSERT_TRUE(PatchRegistration().prepare(&reference));
  reference.chooseAnchor(4.0);
  EXPECT_NEAR(reference.anchor().x(), 1.5, 0.3);
  EXPECT_NEAR(reference.anchor().y(), 0.5, 0.3);
}

TEST(PatchRegistration, SaysWhyItFails) {
  const Waves waves(1);
  ReferencePatch reference = referenceOf(waves);
  const ImagePyramid image = waves.image(at(kCentre, kCentre));
  PatchRegistration registration;
  const auto status = [&](const Warp& start) {
    return registration.run(&reference, image, start).status;
  };
  EXPECT_EQ(status(at(kCentre, kCentre)), Registration::Status::kGood);
  EXPECT_EQ(status(at(2.0, kCentre)), Registration::Status::kOutside);
  EXPECT_EQ(status(at(-1e9, 1e30)), Registration::Status::kOutside);
  EXPECT_EQ(status(at(std::nan(""), 4.0)), Registration::Status::kDeformed);
  Warp mirrored = at(kCentre, kCentre);
  mirrored.linear(0, 0) = -1.0;
  EXPECT_EQ(status(mirrored), Registration::Status::kDeformed);
  Warp thin = at(kCentre, kCentre);
  thin.linear.diagonal() << 2.0, 0.5;
  EXPECT_EQ(status(thin), Registration::Status::kDeformed);
  const Registration elsewhere =
      registration.run(&reference, Waves(2).image(at(48, 48)), at(48, 48));
  EXPECT_TRUE(elsewhere.status != Registration::Status::kGood ||
              elsewhere.residual > 0.1 * elsewhere.contrast);
}

}  // namespace
}  // namespace camera_self_calibration
