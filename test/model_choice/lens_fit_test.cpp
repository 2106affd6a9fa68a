#include "camera_self_calibration/model_choice/lens_fit.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/camera/pixel_grid.h"
#include "camera_self_calibration/camera/rotation_compensation.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "model_choice/displaced_segments.h"
#include "model_choice/model_queues.h"

namespace camera_self_calibration {
namespace {

const Camera kPinhole = camera640(CameraModel::kPinhole, {420, 415, 325, 236});
// As rectified images often keep it.
const Camera kAlmostPinhole =
    camera640(CameraModel::kRadtan, {420, 415, 325, 236, -0.03, 0.01, 0, 0});
const Camera kRadtan = camera640(CameraModel::kRadtan, {400, 404, 315, 243, -0.25, 0.05, 0, 0});
const Camera kWide = camera640(CameraModel::kFov, {311.2, 309.8, 327.4, 233.1, 0.93});

LensFitReport fitOf(const SegmentQueue& queue) {
  EXPECT_TRUE(queue.solution().usable);
  LensFit fit{LensFitOptions()};
  EXPECT_TRUE(fit.consider(40, true, queue.candidates(), queue.solution(), {}, 1).has_value());
  EXPECT_TRUE(fit.report().compared);
  return fit.report();
}

TEST(LensFit, ATrueModelFits) {
  for (const Camera& truth : {kPinhole, kRadtan, kWide, as(CameraModel::kEquidistant, kWide)}) {
    const SegmentQueue queue = queueOf(truth, truth.model(), 4);
    const LensFitReport report = fitOf(queue);
    EXPECT_FALSE(report.refuted) << report.sentence();
    EXPECT_EQ(report.better, "");
    const PixelError noise = pixelUncertainty(queue.solution().camera, queue.solution().covariance);
    EXPECT_LT(report.misfit.rms, noise.rms);
    EXPECT_TRUE(report.describesImage());
    EXPECT_EQ(report.sentence(),
              "no richer lens model fits better than " + toString(truth.model()));
  }
}

TEST(LensFit, FindsTheDistortionThatAPinholeLacks) {
  const SegmentQueue queue = queueOf(kAlmostPinhole, CameraModel::kPinhole, 4);
  const LensFitReport report = fitOf(queue);
  EXPECT_FALSE(report.better.empty());
  const PixelError error = pixelDistance(queue.solution().camera, kAlmostPinhole);
  EXPECT_NEAR(report.misfit.rms, error.rms, 0.3 * error.rms);
  const PixelError noise = pixelUncertainty(queue.solution().camera, queue.solution().covariance);
  EXPECT_GT(error.rms, 3.0 * noise.rms);  // what the noise alone states is a lie
  EXPECT_LT(error.rms, 3.0 * noise.inQuadrature(report.misfit).rms);
  EXPECT_NE(report.sentence().find("pinhole misses the lens by "), std::string::npos)
      << report.sentence();
  EXPECT_NE(report.sentence().find(report.better + " fits it"), std::string::npos);
}

// Whether the video refutes the pinhole or only casts doubt on it.
TEST(LensFit, ADistortionOfAnyStrengthCounts) {
  bool doubted = false;
  for (const double k1 : {-0.002, -0.004, -0.006, -0.008, -0.012, -0.02}) {
    const Camera truth = camera640(CameraModel::kRadtan, {420, 415, 325, 236, k1, 0, 0, 0});
    const SegmentQueue queue = queueOf(truth, CameraModel::kPinhole, 2);
    const LensFitReport report = fitOf(queue);
    const PixelError noise = pixelUncertainty(queue.solution().camera, queue.solution().covariance);
    const double error = pixelDistance(queue.solution().camera, truth).rms;
    EXPECT_LT(error, 3.0 * noise.inQuadrature(report.misfit).rms) << k1;
    doubted = doubted || (!report.refuted && report.misfit.rms > noise.rms);
  }
  EXPECT_TRUE(doubted);
}

TEST(LensFit, SaysWhatTheVideoDoesNotRuleOut) {
  LensFitReport report;
  report.compared = true;
  report.model = "pinhole";
  EXPECT_EQ(report.sentence(), "no richer lens model fits better than pinhole");
  report.misfit = {2.5, 6.0};
  EXPECT_EQ(report.sentence(),
            "the video does not rule out that pinhole misses the lens by 2.5 px rms (which the "
            "uncertainty "
            "includes)");
}

TEST(LensFit, FindsAWideLensThatRadtanCannotDescribe) {
  const LensFitReport report = fitOf(queueOf(kWide, CameraModel::kRadtan, 4));
  EXPECT_EQ(report.better, "equidistant") << report.sentence();
  EXPECT_GT(report.misfit.rms, 1.0);
}

// Decentring of a higher order than p1 and p2.
TEST(LensFit, FindsALensThatNoModelDescribes) {
  const Displace decentred = [](const Eigen::Vector2d& pixel) {
    const Eigen::Vector2d x = (pixel - Eigen::Vector2d(320, 240)) / 320.0;
    const Eigen::Vector2d p(2.0, -1.5);
    const double r2 = x.squaredNorm();
    return Eigen::Vector2d(pixel + r2 * (r2 * p + 2.0 * x.dot(p) * x));
  };
  const SegmentQueue queue = solvedQueue(displacedSegments(kRadtan, decentred, 6), kRadtan);
  const LensFitReport report = fitOf(queue);
  EXPECT_TRUE(report.refuted);
  EXPECT_EQ(report.better, "");
  const Camera& camera = queue.solution().camera;
  std::vector<PixelRay> rays = pixelGrid(kRadtan);
  for (PixelRay& ray : rays) ray.pixel = decentred(ray.pixel);
  const double error = bestRotation(rays, camera).error.rms;
  const PixelError noise = pixelUncertainty(camera, queue.solution().covariance);
  EXPECT_LT(error, 3.0 * noise.inQuadrature(report.misfit).rms);
  EXPECT_LT(report.misfit.rms, 2.0 * error);
  EXPECT_NE(report.sentence().find("no other model was found to fit"), std::string::npos)
      << report.sentence();
}

TEST(LensFit, SaysWhereTheImageHasNoRays) {
  LensFitReport report;
  report.compared = true;
  report.model = "radtan";
  report.refuted = true;
  report.better = "equidistant";
  report.misfit = {15.5, 50.0};
  report.undescribed = 0.1;
  EXPECT_EQ(report.sentence(),
            "radtan has no ray for 10 % of the image (which the uncertainty includes), but "
            "equidistant fits it");
}

// Of one segment, as the startup batch is one.
TEST(LensFit, ComparesBeforeThereIsAQueue) {
  const auto startOf = [](const Camera& truth, CameraModel model) {
    SegmentOptions options;
    options.camera = truth;
    options.keyframes = 30;
    options.tracks.pixel_sigma = 0.2;
    const Candidate batch =
        evaluateCandidate(CandidateOptions(), makeSegment(options, 3).segment, as(model, truth));
    EXPECT_TRUE(batch.well_posed) << batch.reason;
    LensFit fit{LensFitOptions()};
    for (int i = 0; i < 3; ++i) {
      EXPECT_FALSE(fit.report().compared) << "it may be a wrong minimum";
      fit.compareStart(batch.segment,
                       {batch.camera, covarianceFromInformation(batch.information).value()}, {}, 1);
    }
    return fit.report();
  };
  for (const Camera& truth : {kPinhole, kRadtan, kWide}) {
    const LensFitReport report = startOf(truth, truth.model());
    EXPECT_FALSE(report.refuted) << report.sentence();
  }
  const LensFitReport report = startOf(kAlmostPinhole, CameraModel::kPinhole);
  EXPECT_TRUE(report.refuted);
  EXPECT_FALSE(report.better.empty());
  EXPECT_GT(report.misfit.rms, 0.0);
}

TEST(LensFit, DoesNotGiveAMisfitWhereItAddsNothing) {
  LensFitReport report;
  report.compared = report.refuted = true;
  report.model = "pinhole";
  report.better = "radtan";
  EXPECT_EQ(report.sentence(), "pinhole does not fit the lens, but radtan fits it");
}

TEST(LensFit, ComparesWhenTheQueueHasChangedAndItIsTimeTo) {
  const SegmentQueue queue = queueOf(kPinhole, CameraModel::kPinhole, 3);
  const SegmentQueue longer = queueOf(kPinhole, CameraModel::kPinhole, 4);
  const auto consider = [](LensFit* fit, int keyframes, bool due, const SegmentQueue& seen) {
    return fit->consider(keyframes, due, seen.candidates(), seen.solution(), {}, 1).has_value();
  };
  LensFit fit{LensFitOptions()};
  EXPECT_EQ(fit.report().sentence(), "");
  EXPECT_TRUE(consider(&fit, 40, false, queue));
  EXPECT_FALSE(consider(&fit, 41, false, longer));
  EXPECT_FALSE(consider(&fit, 60, false, queue));
  EXPECT_TRUE(consider(&fit, 60, false, longer));
  // Not called good without a comparison.
  EXPECT_TRUE(consider(&fit, 61, true, queue));
  EXPECT_FALSE(consider(&fit, 62, true, queue));
}

}  // namespace
}  // namespace camera_self_calibration
