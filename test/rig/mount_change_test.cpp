#include "camera_self_calibration/rig/mount_change.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <optional>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/rig/mount_watch.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr double kLevel = 1e-6;

Camera lens(double focal) {
  Intrinsics p(8);
  p << focal, focal, 322.0, 236.0, 0.02, 0.01, 0.0, 0.0;
  return Camera(CameraModel::kEquidistant, 640, 480, p);
}

Rig rigOf(int cameras) {
  Rig rig;
  for (int c = 0; c < cameras; ++c) {
    rig.cameras.push_back(lens(400.0 + 10.0 * c));
    rig.rig_from_camera.emplace_back(expSo3(0.1 * c * Eigen::Vector3d(0.2, -0.3, 0.5)),
                                     c * Eigen::Vector3d(0.12, 0.01 * c, -0.005));
  }
  return rig;
}

// What is seen of a rig in short segments of video: its poses and lenses with errors of a random
// covariance, in a map of random scale.
class SegmentsOfVideo {
 public:
  explicit SegmentsOfVideo(std::uint64_t seed) : random_(seed) {}

  const std::vector<RigLikelihood>& list() const { return list_; }

  void see(const Rig& truth, int count, double stated = 1.0) {
    for (int i = 0; i < count; ++i) list_.push_back(segmentOf(truth, stated));
  }

  // From now on the second camera's turns are told to this many degrees, but only against its
  // centre, as with a long focal length: a centre that moved looks the same.
  void tieTurnsToCentre(double degrees) { tied_degrees_ = degrees; }

 private:
  // Poses to 0.05 degrees and 5 mm, lenses to a pixel and 0.01, all correlated.
  RigLikelihood segmentOf(const Rig& truth, double stated) {
    RigLikelihood segment;
    segment.begin_ns = 1'000'000'000LL * static_cast<std::int64_t>(list_.size());
    segment.end_ns = segment.begin_ns + 900'000'000LL;
    segment.rig = truth;
    const double scale = random_.uniform(0.5, 2.0);
    for (Rigid3& pose : segment.rig.rig_from_camera) pose.translation *= scale;
    const RigLayout layout(truth, {});
    Eigen::VectorXd sigmas(layout.size);
    for (int c = 0; c < truth.size(); ++c) {
      if (c > 0) sigmas.segment<3>(layout.pose_at[c]).setConstant(0.05 * kDegree);
      if (c > 0) sigmas.segment<3>(layout.pose_at[c] + 3).setConstant(0.005 * scale);
      sigmas.segment<4>(layout.intrinsics_at[c]).setConstant(1.0);
      sigmas.segment<4>(layout.intrinsics_at[c] + 4).setConstant(0.01);
    }
    const int n = layout.size;
    Eigen::MatrixXd half = Eigen::MatrixXd::Identity(n, n);
    for (int i = 0; i < n * n; ++i) half(i % n, i / n) += 0.2 * random_.normal();
    half = sigmas.asDiagonal() * half;
    if (tied_degrees_) tie(layout, *tied_degrees_ / 0.05, truth.cameras[1].parameters()(0), &half);
    Eigen::VectorXd error(n);
    for (int i = 0; i < n; ++i) error(i) = random_.normal();
    error = half * error;
    segment.information = stated * (half * half.transpose()).inverse();
    segment.gradient = Eigen::VectorXd::Zero(n);
    for (int c = 0; c < truth.size(); ++c) {
      Intrinsics p = segment.rig.cameras[c].parameters();
      p += error.segment<8>(layout.intrinsics_at[c]);
      segment.rig.cameras[c].setParameters(p);
      if (c == 0) continue;
      Rigid3& pose = segment.rig.rig_from_camera[c];
      pose.rotation = expSo3(error.segment<3>(layout.pose_at[c])) * pose.rotation;
      pose.translation += error.segment<3>(layout.pose_at[c] + 3);
    }
    return segment;
  }

  static void tie(const RigLayout& layout, double factor, double focal, Eigen::MatrixXd* half) {
    const int turn = layout.pose_at[1];
    const int centre = layout.intrinsics_at[1] + 2;
    half->middleRows(turn, 3) *= factor;
    half->row(turn) -= half->row(centre + 1) / focal;
    half->row(turn + 1) += half->row(centre) / focal;
  }

  Random random_;
  std::optional<double> tied_degrees_;
  std::vector<RigLikelihood> list_;
};

MountChange turnOf(int camera, const Eigen::Vector3d& degrees) {
  MountChange change;
  change.camera = camera;
  change.rotation = kDegree * degrees;
  return change;
}

TEST(JudgeMounts, NothingChangesByChance) {
  constexpr int kTrials = 400;
  int doubts = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Rig rig = rigOf(2 + trial % 2);
    SegmentsOfVideo segments(static_cast<std::uint64_t>(trial));
    segments.see(rig, 3 + trial % 7);
    const MountVerdict verdict = judgeMounts(segments.list(), rig, 1e-3);
    EXPECT_NE(verdict.kind, MountVerdict::Kind::kChange) << trial;
    doubts += verdict.kind != MountVerdict::Kind::kSame;
  }
  // Each is in doubt with a probability of 1 % at most: 12 has 0.1 %.
  EXPECT_LT(doubts, 12);
}

// Sigmas that are stated too small by three: what segments scatter anyway is no change.
TEST(JudgeMounts, ScatterIsNoChange) {
  int alarms = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SegmentsOfVideo segments(seed);
    segments.see(rigOf(2), 8, 9.0);
    alarms += judgeMounts(segments.list(), rigOf(2), 1e-4).kind == MountVerdict::Kind::kChange;
  }
  EXPECT_EQ(alarms, 0);
}

void expectTurn(const MountChange& change, int camera, const Eigen::Vector3d& degrees) {
  EXPECT_EQ(change.camera, camera);
  const Eigen::Vector3d error = change.rotation - kDegree * degrees;
  EXPECT_LT(error.dot(change.rotation_covariance.inverse() * error), 16.3);  // one in 1000
  EXPECT_NEAR(change.angle(), kDegree * degrees.norm(), 5.0 * change.angleSigma());
  EXPECT_LT(change.angleSigma(), 0.2 * kDegree);
  EXPECT_LT(change.rotationPValue(), 1e-3);
}

TEST(JudgeMounts, OfThreeTheCameraThatMovedIsNamed) {
  const Eigen::Vector3d degrees(0.3, -0.2, 0.4);
  for (int camera = 0; camera < 3; ++camera) {
    const Rig rig = rigOf(3);
    SegmentsOfVideo segments(7);
    segments.see(rig, 4);
    segments.see(moved(rig, turnOf(camera, degrees)), 4);
    const MountVerdict verdict = judgeMounts(segments.list(), rig, kLevel);
    ASSERT_EQ(verdict.kind, MountVerdict::Kind::kChange) << camera;
    EXPECT_EQ(verdict.index, 4u);
    EXPECT_EQ(verdict.begin_ns, 4'000'000'000LL);
    expectTurn(verdict.change, camera, degrees);
    EXPECT_LT(verdict.change.p_value, kLevel);
  }
}

TEST(JudgeMounts, OfTwoTheSecondIsNamed) {
  const Rig rig = rigOf(2);
  SegmentsOfVideo segments(7);
  segments.see(rig, 2);
  segments.see(moved(rig, turnOf(1, {0.0, 0.5, 0.0})), 3);
  const MountVerdict verdict = judgeMounts(segments.list(), rig, kLevel);
  ASSERT_EQ(verdict.kind, MountVerdict::Kind::kChange);
  expectTurn(verdict.change, 1, {0.0, 0.5, 0.0});
}

TEST(JudgeMounts, AShiftAcrossTheBaselineIsTold) {
  const Rig rig = rigOf(2);
  MountChange shift;
  shift.shift = {0.0, 0.03, 0.0};
  SegmentsOfVideo segments(3);
  segments.see(rig, 5);
  segments.see(moved(rig, shift), 5);
  const MountVerdict verdict = judgeMounts(segments.list(), rig, kLevel);
  ASSERT_EQ(verdict.kind, MountVerdict::Kind::kChange);
  EXPECT_TRUE(verdict.change.shift_known);
  EXPECT_NEAR((verdict.change.shift - shift.shift).norm(), 0.0, 0.01);
  EXPECT_LT(verdict.change.shiftPValue(), 1e-4);
  EXPECT_GT(verdict.change.rotationPValue(), 1e-3);
}

TEST(JudgeMounts, OneSegmentThatIsWrongIsNoChange) {
  const Rig rig = rigOf(2);
  SegmentsOfVideo segments(5);
  segments.see(rig, 4);
  segments.see(moved(rig, turnOf(1, {0.0, 0.5, 0.0})), 1);
  // It may be the first after a change.
  EXPECT_EQ(judgeMounts(segments.list(), rig, kLevel).kind, MountVerdict::Kind::kDoubt);
  segments.see(rig, 3);
  const MountVerdict verdict = judgeMounts(segments.list(), rig, kLevel);
  EXPECT_EQ(verdict.kind, MountVerdict::Kind::kOutlier);
  EXPECT_EQ(verdict.index, 4u);
}

TEST(JudgeMounts, ALensThatChangedIsNoMount) {
  Rig rig = rigOf(2);
  Rig zoomed = rig;
  zoomed.cameras[1] = lens(414.1);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SegmentsOfVideo segments(seed);
    segments.see(rig, 4);
    segments.see(zoomed, 4);
    EXPECT_NE(judgeMounts(segments.list(), rig, kLevel).kind, MountVerdict::Kind::kChange);
  }
}

// A centre that moved explains all but one part in a thousand of it; the turn explains the rest,
// too.
TEST(JudgeMounts, ATurnThatALensNearlyExplainsIsToldIfItLeavesNothing) {
  const Rig rig = rigOf(2);
  const Rig turned = moved(rig, turnOf(1, {0.0, 1.0, 0.0}));
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SegmentsOfVideo segments(seed);
    segments.tieTurnsToCentre(0.005);
    segments.see(rig, 4);
    segments.see(turned, 4);
    const MountVerdict verdict = judgeMounts(segments.list(), rig, kLevel);
    ASSERT_EQ(verdict.kind, MountVerdict::Kind::kChange) << seed;
    EXPECT_EQ(verdict.lens, std::nullopt);
    EXPECT_NEAR(verdict.change.angle(), 1.0 * kDegree, 5.0 * verdict.change.angleSigma());
  }
}

// The segment within which it happened says something of its own.
TEST(JudgeMounts, WhatItHappenedWithinIsNotAskedOfTheTurn) {
  const Rig rig = rigOf(2);
  SegmentsOfVideo segments(7);
  segments.tieTurnsToCentre(0.005);
  segments.see(rig, 4);
  segments.see(moved(rig, turnOf(1, {0.08, 0.0, 0.0})), 1);
  const Rig turned = moved(rig, turnOf(1, {0.0, 1.0, 0.0}));
  segments.see(turned, 1);
  // Some turn explains any one segment.
  EXPECT_EQ(judgeMounts(segments.list(), rig, kLevel).kind, MountVerdict::Kind::kDoubt);
  segments.see(turned, 3);
  const MountVerdict verdict = judgeMounts(segments.list(), rig, kLevel);
  ASSERT_EQ(verdict.kind, MountVerdict::Kind::kChange);
  EXPECT_EQ(verdict.index, 5u);
}

// The same where segments scatter by three times their sigmas: who knows what the rest is.
TEST(JudgeMounts, ATurnThatALensNearlyExplainsIsInDoubtIfItLeavesMore) {
  const Rig rig = rigOf(2);
  SegmentsOfVideo segments(7);
  segments.tieTurnsToCentre(0.005);
  segments.see(rig, 4, 9.0);
  segments.see(moved(rig, turnOf(1, {0.0, 1.0, 0.0})), 4, 9.0);
  const MountVerdict verdict = judgeMounts(segments.list(), rig, kLevel);
  EXPECT_EQ(verdict.kind, MountVerdict::Kind::kDoubt);
  EXPECT_EQ(verdict.lens, 1);
}

TEST(JudgeMounts, TwoSegmentsTellNothing) {
  const Rig rig = rigOf(2);
  SegmentsOfVideo segments(1);
  segments.see(rig, 1);
  segments.see(moved(rig, turnOf(1, {0.0, 5.0, 0.0})), 1);
  EXPECT_EQ(judgeMounts(segments.list(), rig, kLevel).kind, MountVerdict::Kind::kSame);
}

// As many parameters that mean something else.
TEST(MountWatch, SegmentsUnderDifferentLensModelsAreNotCompared) {
  const Rig rig = rigOf(2);
  Rig other = moved(rig, turnOf(1, {0.0, 0.5, 0.0}));
  other.cameras[1] = Camera(CameraModel::kRadtan, 640, 480, other.cameras[1].parameters());
  ASSERT_EQ(other.cameras[1].estimatedCount(), rig.cameras[1].estimatedCount());
  SegmentsOfVideo segments(7);
  segments.see(rig, 3);
  segments.see(other, 2);
  const std::vector<RigLikelihood>& list = segments.list();
  MountWatch watch{RigOptions()};
  for (std::size_t i = 0; i < 3; ++i) watch.learn(list[i]);
  EXPECT_EQ(watch.judge(list[3], other).kind, MountVerdict::Kind::kSame);
  watch.learn(list[3]);
  watch.learn(list[4]);
  EXPECT_EQ(watch.judge(std::nullopt, other).kind, MountVerdict::Kind::kSame);
}

TEST(MountWatch, WhatIsSeenAgainWaitsOnce) {
  MountWatch watch{RigOptions()};
  RigFrame frame;
  frame.views.resize(2);
  frame.views.front().world_from_camera = Rigid3();
  for (int i = 0; i < 60; ++i) {
    frame.stamp_ns = 100'000'000LL * (i % 30);  // the same bag twice
    watch.add(frame);
  }
  EXPECT_EQ(watch.takeWaiting().size(), 3u);
}

}  // namespace
}  // namespace camera_self_calibration
