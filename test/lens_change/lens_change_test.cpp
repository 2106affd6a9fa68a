#include "camera_self_calibration/lens_change/lens_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/simulation/random.h"
#include "lens_change/change_samples.h"

namespace camera_self_calibration {
namespace {

// A window in which the lens becomes `after` before keyframe `change`.
Segment windowWithChange(const Camera& before, const Camera& after, int change,
                         std::uint64_t seed) {
  return perturbed(withChange(windowOf(before, seed).segment, before, after, change), {}, seed);
}

Reference known(const Camera& lens) {
  IntrinsicsMatrix information =
      IntrinsicsMatrix::Zero(lens.estimatedCount(), lens.estimatedCount());
  for (int i = 0; i < information.rows(); ++i) {
    const double sigma = i < 4 ? 0.1 : 1e-4;
    information(i, i) = 1.0 / (sigma * sigma);
  }
  return {lens, information, Scatter()};
}

TEST(LensChange, IsFoundAndMeasuredFromThreeKeyframes) {
  for (const Camera& lens : ordinaryCameras()) {
    const Camera after = zoomed(lens, 1.08);
    const Segment window = windowWithChange(lens, after, 7, 4);
    const LensChange change = testLensChange(window, 7, known(lens));
    ASSERT_TRUE(change.usable) << toString(lens.model());
    EXPECT_LT(change.p_value, 1e-9) << toString(lens.model());
    EXPECT_LT(change.residual_scale, 1.5);
    EXPECT_LT(pixelDistance(change.camera, after).rms, 0.1 * pixelDistance(lens, after).rms)
        << toString(lens.model());
    EXPECT_EQ(dateLensChange(window, known(lens)), 7) << toString(lens.model());
  }
}

TEST(LensChange, IsDatedAmongThePossibleKeyframes) {
  const Camera lens = ordinaryCameras()[1];
  const Segment window = windowWithChange(lens, zoomed(lens, 1.08), 7, 4);
  EXPECT_EQ(dateLensChange(window, known(lens), 6, 9), 7);
  EXPECT_EQ(dateLensChange(window, known(lens), 8, 9), 8);
  EXPECT_EQ(dateLensChange(window, known(lens), 2, 5), 5);
  EXPECT_EQ(dateLensChange(window, known(lens), 100, 100), 9);
}

TEST(LensChange, OfTheWholeWindowIsDatedToItsBeginning) {
  const Camera lens = ordinaryCameras()[1];
  const Segment window = windowWithChange(lens, zoomed(lens, 0.95), 0, 4);
  EXPECT_EQ(dateLensChange(window, known(lens)), 0);
  EXPECT_LT(testLensChange(window, 0, known(lens)).p_value, 1e-9);
}

TEST(LensChange, IsNotFoundWhereThereIsNone) {
  for (const Camera& lens : ordinaryCameras()) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const Segment window = windowWithChange(lens, lens, 6, seed);
      for (const int earlier : {0, 6}) {
        EXPECT_GT(testLensChange(window, earlier, known(lens)).p_value, 1e-4)
            << toString(lens.model()) << " seed " << seed;
      }
    }
  }
}

// A third of the tracks on something that moves is no other lens.
TEST(LensChange, MovingObjectsAreNone) {
  const Camera lens = ordinaryCameras()[1];
  Segment window = windowWithChange(lens, lens, 6, 2);
  for (Observation& observation : window.observations) {
    if (observation.landmark % 3 == 0) {
      observation.pixel.x() += 4.0 * std::max(0, observation.keyframe - 5);
    }
  }
  EXPECT_GT(testLensChange(window, 6, known(lens)).p_value, 1e-4);
}

// Few and short tracks, some with a gross error: another lens would explain those, too.
TEST(LensChange, OutliersAreNone) {
  constexpr int kViews = 3;
  for (const Camera& lens : ordinaryCameras()) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      Segment window = windowWithChange(lens, lens, 6, seed);
      Random random(seed + 100);
      std::vector<int> views(window.landmarks.size(), 0);
      std::vector<Observation> kept;
      for (Observation observation : window.observations) {
        if (++views[observation.landmark] > kViews) continue;
        if (random.chance(0.04)) {
          const double angle = random.uniform(0.0, 2.0 * M_PI);
          observation.pixel +=
              random.uniform(3.0, 20.0) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        }
        kept.push_back(observation);
      }
      window.observations = kept;
      EXPECT_GT(testLensChange(window, 0, known(lens)).p_value, 1e-4)
          << toString(lens.model()) << " seed " << seed;
    }
  }
}

}  // namespace
}  // namespace camera_self_calibration
