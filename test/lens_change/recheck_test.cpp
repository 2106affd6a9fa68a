#include "camera_self_calibration/lens_change/recheck.h"

#include <gtest/gtest.h>

#include "camera_self_calibration/queue/segment_fit.h"
#include "estimation/sample_segments.h"
#include "lens_change/change_samples.h"

namespace camera_self_calibration {
namespace {

const Camera& lens() {
  static const Camera lens = ordinaryCameras()[1];
  return lens;
}

// What new images said: solved from them alone.
struct Fresh {
  Segment segment;
  Camera camera;
  PixelError error;
};

const Fresh& fresh() {
  static const Fresh fresh = [] {
    SegmentOptions options;
    options.camera = lens();
    options.keyframes = 14;
    options.tracks.max_features = 80;
    options.tracks.pixel_sigma = 0.25;
    Fresh result{makeSegment(options, 3).segment, lens(), {}};
    const SegmentFit fit = fitSegment(SegmentFitOptions(), &result.segment, &result.camera);
    EXPECT_TRUE(fit.usable);
    const auto covariance = fit.marginal.robustCovariance();
    EXPECT_TRUE(covariance);
    if (covariance) result.error = pixelUncertainty(result.camera, *covariance);
    return result;
  }();
  return fresh;
}

RecheckEvidence against(const Camera& known) {
  RecheckEvidence evidence;
  evidence.known = known;
  evidence.known_error = {0.05, 0.1};
  evidence.fresh = fresh().camera;
  evidence.fresh_error = fresh().error;
  return evidence;
}

Recheck recheck(const RecheckEvidence& evidence) {
  return recheckCalibration(RecheckOptions(), evidence, fresh().segment);
}

TEST(Recheck, ConfirmsTheSameLens) {
  ASSERT_LT(fresh().error.rms, 0.5);
  const Recheck result = recheck(against(lens()));
  EXPECT_EQ(result.verdict, RecheckVerdict::kSame) << result.sentence;
  EXPECT_NEAR(result.distance_px, pixelDistance(lens(), fresh().camera).rms, 1e-9);
}

// A few pixels are for the queue to take in: they are no other lens.
TEST(Recheck, ConfirmsALensThatMovedALittle) {
  const Recheck result = recheck(against(zoomed(lens(), 1.01)));
  EXPECT_EQ(result.verdict, RecheckVerdict::kSame) << result.sentence;
  EXPECT_GT(result.distance_px, 0.5);
}

TEST(Recheck, FindsAnotherLens) {
  for (const double factor : {0.9, 1.1, 1.4}) {
    const Recheck result = recheck(against(zoomed(lens(), factor)));
    EXPECT_EQ(result.verdict, RecheckVerdict::kDifferent) << factor << ": " << result.sentence;
    EXPECT_GT(result.likelihood_ratio, 1000.0) << factor;
    EXPECT_NE(result.sentence.find("likelihood ratio"), std::string::npos);
  }
}

// A start in a wrong minimum is far from the truth too, but the images do not support it.
TEST(Recheck, IsNotMisledByAnEstimateThatTheImagesContradict) {
  RecheckEvidence evidence = against(lens());
  evidence.fresh = zoomed(lens(), 1.1);
  const Recheck result = recheck(evidence);
  EXPECT_EQ(result.verdict, RecheckVerdict::kUndecided) << result.sentence;
  EXPECT_LT(result.likelihood_ratio, 100.0);
}

TEST(Recheck, IsUndecidedWhileTheImagesTellLittle) {
  for (const Camera& known : {lens(), zoomed(lens(), 1.2)}) {
    RecheckEvidence vague = against(known);
    vague.fresh_error = {2.1, 4.0};
    EXPECT_EQ(recheck(vague).verdict, RecheckVerdict::kUndecided);
    RecheckOptions patient;
    patient.min_keyframes = 15;
    EXPECT_EQ(recheckCalibration(patient, against(known), fresh().segment).verdict,
              RecheckVerdict::kUndecided);
  }
  // Near, but so is everything to what is vague.
  RecheckEvidence near = against(lens());
  near.fresh_error = {0.6, 1.2};
  EXPECT_EQ(recheck(near).verdict, RecheckVerdict::kUndecided);
}

}  // namespace
}  // namespace camera_self_calibration
