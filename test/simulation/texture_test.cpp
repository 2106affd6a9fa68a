#include "camera_self_calibration/simulation/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "camera_self_calibration/simulation/texture_paint.h"

namespace camera_self_calibration {
namespace {

cv::Mat ramp(int width, int height) {
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(x + y);
  }
  return image;
}

TEST(Texture, LevelsDoNotMoveThePicture) {
  const Texture texture(ramp(128, 96));
  ASSERT_GE(texture.levels(), 4);
  // The value at a continuous position is that of the texel centres around it, on every level;
  // away from the edges, and up to the rounding of each level to whole gray values.
  for (const float level : {0.0f, 0.5f, 1.0f, 2.0f, 2.7f, 3.0f}) {
    for (float x = 40.0f; x < 88.0f; x += 3.3f) {
      EXPECT_NEAR(texture.sample(x, 47.0f, level), x - 0.5f + 46.5f, 0.6f) << "level " << level;
    }
  }
}

TEST(Texture, PositionsBeyondTheEdgeTakeItsValue) {
  const Texture texture(ramp(64, 64));
  EXPECT_NEAR(texture.sample(-5.0f, -5.0f, 0.0f), 0.0f, 1e-3f);
  EXPECT_NEAR(texture.sample(100.0f, 100.0f, 0.0f), 126.0f, 1e-3f);
  EXPECT_TRUE(std::isfinite(texture.sample(64.0f, 64.0f, 99.0f)));
}

TEST(Texture, ObliqueFootprintsAverageAlongTheirLongSideOnly) {
  // Stripes along y, 8 texels wide: averaged away across them, kept along them.
  cv::Mat stripes(256, 256, CV_8UC1);
  for (int x = 0; x < 256; ++x) stripes.col(x) = cv::Scalar((x / 8) % 2 == 0 ? 50 : 200);
  const Texture texture(stripes);
  EXPECT_NEAR(texture.sampleFootprint(100.0f, 128.0f, 1.0f, 0.0f, 0.0f, 8.0f), 50.0f, 2.0f);
  EXPECT_NEAR(texture.sampleFootprint(108.0f, 128.0f, 1.0f, 0.0f, 0.0f, 8.0f), 200.0f, 2.0f);
  EXPECT_NEAR(texture.sampleFootprint(100.0f, 128.0f, 16.0f, 0.0f, 0.0f, 2.0f), 125.0f, 20.0f);
}

TEST(Texture, RefusesOtherImages) {
  EXPECT_THROW(Texture(cv::Mat()), std::invalid_argument);
  EXPECT_THROW(Texture(cv::Mat(8, 8, CV_32FC1)), std::invalid_argument);
}

TEST(PaintTexture, FollowsItsSeedAndHasTheGrayAskedFor) {
  for (int kind = 0; kind < static_cast<int>(TextureKind::kImage); ++kind) {
    TextureRecipe recipe;
    recipe.kind = static_cast<TextureKind>(kind);
    recipe.seed = 5;
    const cv::Mat a = paintTexture(recipe, 1.5, 1.0);
    ASSERT_EQ(a.size(), cv::Size(384, 256));
    EXPECT_EQ(cv::norm(a, paintTexture(recipe, 1.5, 1.0), cv::NORM_INF), 0.0);
    EXPECT_NEAR(cv::mean(a)[0], 128.0, 50.0) << kind;
    recipe.seed = 6;
    EXPECT_GT(cv::norm(a, paintTexture(recipe, 1.5, 1.0), cv::NORM_L1), 0.5 * 384 * 256) << kind;
  }
}

// Corners at many scales: the picture keeps gradients when it is halved again and again.
TEST(PaintTexture, HasDetailAtSeveralScales) {
  for (const TextureKind kind : {TextureKind::kPlaster, TextureKind::kBricks, TextureKind::kPanels,
                                 TextureKind::kPlanks, TextureKind::kTiles, TextureKind::kCarpet,
                                 TextureKind::kPoster, TextureKind::kBooks, TextureKind::kCrate}) {
    TextureRecipe recipe;
    recipe.kind = kind;
    recipe.seed = 7;
    cv::Mat image = paintTexture(recipe, 2.0, 2.0);
    for (int scale = 0; scale < 4; ++scale) {
      cv::Mat strength;
      cv::cornerMinEigenVal(image, strength, 5);
      double strongest = 0.0;
      cv::minMaxLoc(strength, nullptr, &strongest);
      EXPECT_GT(strongest, 1e-3) << static_cast<int>(kind) << " at scale " << scale;
      cv::resize(image, image, image.size() / 2, 0.0, 0.0, cv::INTER_AREA);
    }
  }
}

}  // namespace
}  // namespace camera_self_calibration
