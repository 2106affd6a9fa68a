#include "camera_self_calibration/queue/queue_residuals.h"

#include <gtest/gtest.h>

#include "camera_self_calibration/queue/segment_queue.h"
#include "estimation/sample_segments.h"
#include "lens_change/change_samples.h"

namespace camera_self_calibration {
namespace {

TEST(QueueResiduals, AreAsLargeAsExpectedWhereTheSigmasAreRight) {
  const Camera truth = ordinaryCameras()[1];
  SegmentQueue queue(QueuePolicy(6, 0.95), 1);
  for (int seed = 0; seed < 6; ++seed) {
    queue.offer(candidateOf(truth, perturbedCamera(truth, seed), seed, MotionKind::kHandheld),
                {truth});
  }
  ASSERT_TRUE(queue.solution().usable);
  const std::vector<QueueResidual> residuals =
      queueResiduals(queue.candidates(), queue.solution().camera);
  ASSERT_GT(residuals.size(), 1000u);
  double found = 0.0;
  double expected = 0.0;
  for (const QueueResidual& seen : residuals) {
    EXPECT_GT(seen.expected_square, 0.0);
    EXPECT_LT(seen.expected_square, 1.0) << "something is always fitted";
    found += seen.residual.squaredNorm() / (seen.sigma * seen.sigma);
    expected += 2.0 * seen.expected_square;
  }
  EXPECT_NEAR(found / expected, 1.0, 0.1);
}

}  // namespace
}  // namespace camera_self_calibration
