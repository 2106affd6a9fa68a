#include "camera_self_calibration/tools/rig_state.h"

#include <gtest/gtest.h>

#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/tools/json.h"

namespace camera_self_calibration {
namespace {

Camera camera(CameraModel model, double focal) {
  Camera result = Camera::defaultGuess(model, 640, 480);
  Intrinsics p = result.parameters();
  p(0) = focal / 3.0;
  p(1) = focal / 3.1;
  result.setParameters(p);
  return result;
}

RigState sample() {
  RigState state;
  state.cameras = {"left", "right", "rear"};
  RigEstimate& estimate = state.estimate;
  estimate.usable = estimate.converged = estimate.metric = true;
  estimate.sentence = "Camera 1 sits \"here\".";
  estimate.observations = 12345;
  estimate.poses.push_back({1400000000123456789, 0, Rigid3()});
  estimate.rig.cameras = {camera(CameraModel::kFov, 1000.0), camera(CameraModel::kRadtan, 1100.0),
                          camera(CameraModel::kEquidistant, 1200.0)};
  estimate.rig.cameras[1].setEstimateK3(true);
  estimate.rig.rig_from_camera = {Rigid3(),
                                  Rigid3(expSo3({0.1, -0.2, 0.3}), {0.11, 0.1 / 3.0, 0.0}),
                                  Rigid3(expSo3({0.0, 3.0, 0.0}), {0.0, 0.2, -0.3})};
  for (int c = 0; c < 3; ++c) {
    PlaceInRig place;
    place.position_known = c == 1;
    place.shared_landmarks = 10 * c;
    place.rotation_covariance = 1e-6 / 3.0 * Eigen::Matrix3d::Identity();
    place.difference_covariance.setConstant(1e-7 / 7.0);
    estimate.places.push_back(place);
    const int n = estimate.rig.cameras[c].estimatedCount();
    estimate.intrinsics_covariance.push_back(0.01 * IntrinsicsMatrix::Identity(n, n));
    estimate.uncertainty.push_back({0.1 + c, 0.2 + c});
  }
  estimate.intrinsics_covariance[2] = IntrinsicsMatrix();  // held
  return state;
}

TEST(RigState, ReadsBackToTheLastDigit) {
  const RigState state = sample();
  const DecodedRigState read = decodeRigState(encode(state));
  ASSERT_TRUE(read.state) << read.error;
  EXPECT_EQ(encode(*read.state), encode(state));
  EXPECT_EQ(read.state->cameras, state.cameras);
  const RigEstimate& estimate = read.state->estimate;
  EXPECT_TRUE(estimate.usable && estimate.converged && estimate.metric);
  EXPECT_EQ(estimate.poses.back().stamp_ns, 1400000000123456789);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(estimate.rig.cameras[c].parameters(), state.estimate.rig.cameras[c].parameters());
    EXPECT_EQ(estimate.rig.rig_from_camera[c].translation,
              state.estimate.rig.rig_from_camera[c].translation);
    EXPECT_EQ(estimate.places[c].difference_covariance,
              state.estimate.places[c].difference_covariance);
  }
  EXPECT_EQ(estimate.rig.cameras[1].estimatedCount(), 9);
}

// A file with one value changed.
std::string with(const Json::json_pointer& where, const Json& value) {
  Json json = Json::parse(encode(sample()));
  json.at(where) = value;
  return toText(json);
}

// Else it would be refused at the next start, and then never be written over.
TEST(RigState, ReadsEveryRigThatABaselineCanMake) {
  for (const double baseline : {kShortestBaseline, kLongestBaseline}) {
    const std::string text = with(Json::json_pointer("/cameras/1/position"), {baseline, 0.0, 0.0});
    EXPECT_TRUE(decodeRigState(text).state) << decodeRigState(text).error;
  }
}

// A rotation written with fewer digits is one all the same, and then keeps its own.
TEST(RigState, ARotationOfARoundedLengthReadsTheSameFromThenOn) {
  for (int i = 0; i < 30; ++i) {
    const double w = sample().estimate.rig.rig_from_camera[1].rotation.w() + 3e-9 * (i - 15);
    const DecodedRigState once =
        decodeRigState(with(Json::json_pointer("/cameras/1/rotation_xyzw/3"), w));
    ASSERT_TRUE(once.state) << once.error;
    EXPECT_NEAR(once.state->estimate.rig.rig_from_camera[1].rotation.norm(), 1.0, 1e-15);
    const DecodedRigState again = decodeRigState(encode(*once.state));
    ASSERT_TRUE(again.state) << again.error;
    EXPECT_EQ(encode(*again.state), encode(*once.state));
  }
}

TEST(RigState, WhatNoRigHasIsRefusedWithAReason) {
  using Where = Json::json_pointer;
  const std::string text = encode(sample());
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "damaged"},
      {"[]", "not what this program writes"},
      {"{}", "not what this program writes"},
      {text.substr(0, text.size() / 2), "damaged"},
      {with(Where("/format"), "camera_self_calibration rig 2"), "not what this program writes"},
      {with(Where("/cameras"), Json::array()), "two to six"},
      {with(Where("/metric"), "perhaps"), "damaged"},
      {with(Where("/cameras/0/model"), "fisheye62"), "not known"},
      {with(Where("/cameras/0/model"), "pinhole"), "number of parameters"},
      {with(Where("/cameras/0/size/0"), -640), "image size"},
      {with(Where("/cameras/0/size/0"), 1000000), "image size"},
      {with(Where("/cameras/0/parameters/0"), 1e-9), "cannot be right"},
      {with(Where("/cameras/0/parameters/0"), Json()), "damaged"},
      {with(Where("/cameras/1/rotation_xyzw/3"), 2.0), "rotation"},
      {with(Where("/cameras/0/position/0"), 0.5), "rig's frame"},
      {with(Where("/cameras/1/rotation_covariance/0"), -1.0), "covariance"},
      {with(Where("/cameras/1/rotation_covariance"), {1.0, 2.0}), "wrong length"},
      {with(Where("/cameras/1/uncertainty_px"), {1.0}), "two numbers"},
      {with(Where("/cameras/1/uncertainty_px/0"), -1.0), "two numbers"},
      {with(Where("/cameras/1/position/2"), 1e300), "too far"},
      {with(Where("/cameras/1/position"), {0.0, 0.0, 0.0}), "in one place"},
      {with(Where("/cameras/1/shared_landmarks"), 1e300), "not whole"},
      {with(Where("/observations"), -3), "count"},
      {with(Where("/sentence"), std::string(2 << 20, 'x')), "too long"}};
  for (const auto& [damaged, reason] : cases) {
    const DecodedRigState read = decodeRigState(damaged);
    EXPECT_FALSE(read.state) << reason;
    EXPECT_NE(read.error.find(reason), std::string::npos) << read.error << ", not " << reason;
  }
}

}  // namespace
}  // namespace camera_self_calibration
