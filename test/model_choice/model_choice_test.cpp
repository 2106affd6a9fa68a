#include "camera_self_calibration/model_choice/model_choice.h"

#include <gtest/gtest.h>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "model_choice/model_queues.h"

namespace camera_self_calibration {
namespace {

const Camera kPinhole = camera640(CameraModel::kPinhole, {420, 415, 325, 236});
const Camera kRadtan = camera640(CameraModel::kRadtan, {400, 404, 315, 243, -0.25, 0.05, 0, 0});
// As rectified images often keep it, but of the shape that fov cannot take.
const Camera kPincushion = camera640(CameraModel::kRadtan, {420, 415, 325, 236, 0.03, -0.01, 0, 0});
const Camera kMildFov = camera640(CameraModel::kFov, {420, 415, 325, 236, 0.35});
const Camera kFov = camera640(CameraModel::kFov, {311.2, 309.8, 327.4, 233.1, 0.93});

// How far each segment's own estimate is from the joint one.
Scatter scatterOf(const std::vector<Candidate>& candidates, const Camera& joint) {
  Scatter scatter;
  for (const Candidate& candidate : candidates) {
    const Intrinsics off =
        (joint.parameters() - candidate.camera.parameters()).head(candidate.information.rows());
    scatter.chi_square += off.dot(candidate.information * off);
  }
  scatter.freedom = (static_cast<int>(candidates.size()) - 1) * joint.estimatedCount();
  return scatter;
}

// A queue would refuse segments that hardly tell the present model.
LensComparison compared(const Camera& truth, CameraModel present, int segments = 4) {
  const Camera start = as(present, truth);
  std::vector<Candidate> candidates;
  for (const Segment& segment : separateSegments(truth, segments)) {
    candidates.push_back(evaluateCandidate(CandidateOptions(), segment, start));
  }
  LensObservations observations = observationsOf(candidates, Scatter());
  const LensTrial joint = tryLens(observations, start, 1);
  observations.segments = joint.segments;
  observations.scatter = scatterOf(candidates, joint.camera);
  return compareWithRicher(observations, joint.camera, 1);
}

TEST(LensTrial, WhatPromisesNothingIsNotFitted) {
  EXPECT_TRUE(compared(kPinhole, CameraModel::kPinhole).richer.empty());
  EXPECT_FALSE(compared(kRadtan, CameraModel::kPinhole).richer.empty());
}

TEST(LensTrial, ALeadIsJudgedByItsDegreesOfFreedom) {
  LensTrial pinhole, fov, radtan, equidistant;
  pinhole.camera = kPinhole;
  fov.camera = as(CameraModel::kFov, kPinhole);
  radtan.camera = as(CameraModel::kRadtan, kPinhole);
  equidistant.camera = as(CameraModel::kEquidistant, kPinhole);
  for (LensTrial* trial : {&pinhole, &fov, &radtan, &equidistant}) trial->usable = true;
  for (LensTrial* behind : {&pinhole, &fov, &radtan}) behind->cost = 10.0;
  const auto byChance = [](const LensTrial& ahead, const LensTrial& behind) {
    return leadByChance(ahead, behind, LensKnowledge());
  };
  EXPECT_NEAR(byChance(equidistant, pinhole), 5.0e-4, 0.1e-4);   // 20 of 4
  EXPECT_NEAR(byChance(equidistant, fov), 1.7e-4, 0.1e-4);       // of 3
  EXPECT_NEAR(byChance(equidistant, radtan), 1.03e-2, 0.01e-2);  // of 8: not contained
  EXPECT_EQ(byChance(pinhole, equidistant), 1.0);
  EXPECT_NEAR(leadByChance(equidistant, pinhole, {2.0, 0, {}}), 4.04e-2, 0.01e-2);
  // Where the disagreement of segments is estimated from little.
  EXPECT_NEAR(leadByChance(equidistant, pinhole, {1.0, 10, {}}), 1.78e-2, 0.01e-2);
}

TEST(LensTrial, WhatChanceExplainsDoesNotCount) {
  LensTrial pinhole, equidistant;
  pinhole.camera = kPinhole;
  equidistant.camera = as(CameraModel::kEquidistant, kPinhole);
  pinhole.usable = equidistant.usable = true;
  const auto share = [&](double ratio, double variance) {
    pinhole.cost = 0.5 * ratio;
    return shareBeyondChance(equidistant, pinhole, {{variance, 0}, {}});
  };
  EXPECT_EQ(share(3.0, 1.0), 0.0);  // of 4 degrees of freedom
  EXPECT_DOUBLE_EQ(share(8.0, 1.0), 0.5);
  EXPECT_EQ(share(8.0, 2.0), 0.0);
  EXPECT_DOUBLE_EQ(share(400.0, 1.0), 0.99);
  EXPECT_EQ(shareBeyondChance(pinhole, equidistant, LensKnowledge()), 0.0);
  pinhole.usable = false;
  EXPECT_EQ(shareBeyondChance(equidistant, pinhole, LensKnowledge()), 1.0);
}

TEST(ModelChoice, WhatDescribesTheLensStays) {
  for (const Camera& truth : {kPinhole, kRadtan, kFov}) {
    ModelChoice choice{ModelChoiceOptions()};
    EXPECT_FALSE(choice.choose(compared(truth, truth.model()), {}, 1)) << toString(truth.model());
    ASSERT_FALSE(choice.evidence().empty());
    EXPECT_NE(choice.sentence().find("lens model " + toString(truth.model())), std::string::npos)
        << choice.sentence();
  }
}

void expectFound(const Camera& truth, CameraModel present) {
  SCOPED_TRACE(toString(present));
  ModelChoice choice{ModelChoiceOptions()};
  const auto other = choice.choose(compared(truth, present), {}, 1);
  ASSERT_TRUE(other) << choice.sentence();
  EXPECT_EQ(other->name(), toString(truth.model()));
  EXPECT_LT(pixelDistance(truth, other->camera).rms, 1.0);
  for (const ModelEvidence& evidence : choice.evidence()) {
    EXPECT_EQ(evidence.chosen, evidence.model == other->name());
    if (evidence.model == toString(present)) {
      EXPECT_GT(evidence.behind, 8.0);
    }
  }
  EXPECT_NE(choice.sentence().find("lens model " + other->name()), std::string::npos);
  EXPECT_NE(choice.sentence().find(" times as likely)"), std::string::npos) << choice.sentence();
}

TEST(ModelChoice, SaysHowManyTimesAsLikelyInNumbersThatCanBeRead) {
  EXPECT_EQ(timesAsLikely(0.0), "1");
  EXPECT_EQ(timesAsLikely(0.5), "1.6");
  EXPECT_EQ(timesAsLikely(2.26), "10");  // 9.58
  EXPECT_EQ(timesAsLikely(6.9), "992");
  EXPECT_EQ(timesAsLikely(38.0), "10^17");
  EXPECT_EQ(timesAsLikely(-2.0), "0.14");
  EXPECT_EQ(timesAsLikely(-38.0), "10^-17");
  EXPECT_EQ(timesAsLikely(21000.0), "more than 10^20");
  EXPECT_EQ(timesAsLikely(-21000.0), "less than 10^-20");
}

TEST(ModelChoice, FindsDistortionThatTheModelLacks) {
  expectFound(kPincushion, CameraModel::kPinhole);
  expectFound(kRadtan, CameraModel::kFov);
}

TEST(ModelChoice, TakesTheSimplestOfThoseThatDescribeTheLens) {
  expectFound(kMildFov, CameraModel::kPinhole);
}

TEST(ModelChoice, GoesBackToASimplerOne) {
  for (const CameraModel present :
       {CameraModel::kFov, CameraModel::kRadtan, CameraModel::kEquidistant}) {
    ModelChoice choice{ModelChoiceOptions()};
    const auto other = choice.choose(compared(kPinhole, present), {}, 1);
    ASSERT_TRUE(other) << toString(present);
    EXPECT_EQ(other->name(), "pinhole");
    EXPECT_LT(pixelDistance(kPinhole, other->camera).rms, 0.5);
  }
}

// What is right but hardly known would be further from the truth.
TEST(ModelChoice, AWrongModelStaysUntilABetterOneIsKnown) {
  // The segments disagree under all of them.
  const LensComparison comparison = compared(kRadtan, CameraModel::kPinhole);
  EXPECT_FALSE(comparison.richer.empty());
  ModelChoice choice{ModelChoiceOptions()};
  EXPECT_FALSE(choice.choose(comparison, {}, 1));
  EXPECT_NE(choice.sentence().find("lens model pinhole"), std::string::npos) << choice.sentence();
}

TEST(ModelChoice, ComparesAtGeometricIntervals) {
  ModelChoice choice{ModelChoiceOptions()};
  EXPECT_EQ(choice.sentence(), "");
  EXPECT_TRUE(choice.isDue(8));
  EXPECT_FALSE(choice.isDue(12));
  EXPECT_TRUE(choice.isDue(40));
  EXPECT_FALSE(choice.isDue(49));
  EXPECT_TRUE(choice.isDue(50));
}

}  // namespace
}  // namespace camera_self_calibration
