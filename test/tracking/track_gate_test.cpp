#include "camera_self_calibration/tracking/track_gate.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

// Of a corner of common contrast that noise displaces by a few hundredths of a pixel.
Registration registration(double residual) {
  Registration result;
  result.status = Registration::Status::kGood;
  result.residual = residual;
  result.contrast = 400.0;
  result.unit_covariance = 4e-4 * Eigen::Matrix2d::Identity();
  return result;
}

TrackGate gateOfNoise(double variance) {
  TrackGate gate;
  for (int image = 0; image < 50; ++image) {
    gate.learn(std::vector<Registration>(20, registration(variance)));
  }
  return gate;
}

TEST(TrackGate, WhatTheReferenceDoesNotShowCountsByItsShare) {
  const TrackGate gate = gateOfNoise(1.0);
  const double noise = gate.sigma(registration(1.0));
  EXPECT_LT(noise, 0.1);
  EXPECT_EQ(gate.sigma(registration(0.5)), noise);
  double last = noise;
  for (const double residual : {2.0, 4.0, 8.0, 16.0}) {
    const double sigma = gate.sigma(registration(residual));
    EXPECT_GT(sigma, last);
    last = sigma;
  }
  // Far above the noise, twice the share makes twice the sigma.
  EXPECT_NEAR(gate.sigma(registration(16.0)) / gate.sigma(registration(8.0)), 2.0, 0.3);
}

TEST(TrackGate, APoorMeasurementIsKeptUntilItSaysNothing) {
  const TrackGate gate = gateOfNoise(1.0);
  EXPECT_TRUE(gate.looksTheSame(registration(1.0)));
  EXPECT_FALSE(gate.looksTheSame(registration(8.0)));
  EXPECT_TRUE(gate.accepts(registration(8.0)));
  EXPECT_FALSE(gate.accepts(registration(80.0)));
}

TEST(TrackGate, NoiseAloneIsNoPatch) {
  const TrackGate gate = gateOfNoise(1.0);
  Registration result = registration(1.0);
  result.contrast = 1.5;
  EXPECT_FALSE(gate.accepts(result));
  result.contrast = 15.0;
  EXPECT_TRUE(gate.accepts(result));
}

TEST(TrackGate, RefusesWhatWasNotFoundAndWhatTurnedDark) {
  const TrackGate gate = gateOfNoise(1.0);
  Registration result = registration(1.0);
  EXPECT_TRUE(gate.accepts(result));
  result.gain = 0.1;
  EXPECT_FALSE(gate.accepts(result));
  result = registration(1.0);
  result.status = Registration::Status::kNotConverged;
  EXPECT_FALSE(gate.accepts(result));
}

}  // namespace
}  // namespace camera_self_calibration
