#include "camera_self_calibration/simulation/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/mount.h"
#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"
#include "camera_self_calibration/simulation/tum_file.h"

namespace camera_self_calibration {
namespace {

using Eigen::Vector3d;

const MotionKind kAllKinds[] = {MotionKind::kHandheld,    MotionKind::kPlanar,
                                MotionKind::kYawDriving,  MotionKind::kRotationOnly,
                                MotionKind::kForwardOnly, MotionKind::kSidewaysOnly,
                                MotionKind::kStill};

Trajectory motion(MotionKind kind, std::uint64_t seed = 1) {
  SyntheticMotionOptions options;
  options.kind = kind;
  options.seed = seed;
  return syntheticMotion(options);
}

double angleBetween(const Rigid3& a, const Rigid3& b) {
  return logSo3(a.rotation.conjugate() * b.rotation).norm();
}

// Largest jump of the velocity over one millisecond [m/s and rad/s].
double largestVelocityJump(const Trajectory& trajectory, double step = 1e-3) {
  const auto rate = [&](double t) {
    return Vector6d(
        logSe3(trajectory.worldFromCamera(t).inverse() * trajectory.worldFromCamera(t + step)) /
        step);
  };
  double largest = 0.0;
  for (double t = step; t < trajectory.duration() - 3 * step; t += step) {
    largest = std::max(largest, (rate(t + step) - rate(t)).norm());
  }
  return largest;
}

std::string writeFile(const std::string& name, const std::string& text) {
  const std::string path = testing::TempDir() + name;
  std::ofstream(path) << text;
  return path;
}

std::string messageOf(const std::string& path) {
  try {
    readTum(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(SyntheticMotion, StaysInItsBoxAndIsSmooth) {
  for (const MotionKind kind : kAllKinds) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Trajectory trajectory = motion(kind, seed);
      const Eigen::AlignedBox3d box = SyntheticMotionOptions().box;
      for (double t = 0.0; t <= trajectory.duration(); t += 0.05) {
        EXPECT_LT(box.exteriorDistance(trajectory.worldFromCamera(t).translation), 1e-9);
      }
      EXPECT_LT(largestVelocityJump(trajectory, 5e-3), 0.05) << toString(kind);
    }
  }
}

TEST(SyntheticMotion, HandheldTurnsAboutAllAxesAndMovesAlongAll) {
  const Trajectory trajectory = motion(MotionKind::kHandheld);
  Vector6d sum = Vector6d::Zero();
  int count = 0;
  for (double t = 0.0; t < trajectory.duration(); t += 0.1, ++count) {
    sum += trajectory.velocity(t).cwiseAbs2();
  }
  const Vector6d rms = (sum / count).cwiseSqrt();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(rms[axis], 0.1) << "translation, axis " << axis;
    EXPECT_GT(rms[3 + axis], 0.2) << "rotation, axis " << axis;
    EXPECT_LT(rms[3 + axis], 1.5) << "rotation, axis " << axis;
  }
}

TEST(SyntheticMotion, SpecialMotionsAreWhatTheirNamesSay) {
  for (double t = 1.0; t < 59.0; t += 2.3) {
    const Vector6d forward = motion(MotionKind::kForwardOnly).velocity(t);
    EXPECT_LT(forward.tail<3>().norm() + forward.head<2>().norm(), 1e-9);
    const Vector6d sideways = motion(MotionKind::kSidewaysOnly).velocity(t);
    EXPECT_LT(sideways.tail<5>().norm(), 1e-9);
    EXPECT_LT(motion(MotionKind::kRotationOnly).velocity(t).head<3>().norm(), 1e-9);
    EXPECT_LT(motion(MotionKind::kStill).velocity(t).norm(), 1e-9);
    // The camera's y axis points down: neither planar motion moves along it, or turns about
    // another.
    for (const MotionKind kind : {MotionKind::kPlanar, MotionKind::kYawDriving}) {
      const Vector6d planar = motion(kind).velocity(t);
      EXPECT_LT(std::abs(planar[1]) + std::abs(planar[3]) + std::abs(planar[5]), 1e-9);
    }
    const Vector6d driving = motion(MotionKind::kYawDriving).velocity(t);
    EXPECT_GT(driving[2], 0.1);
    EXPECT_LT(std::abs(driving[0]), 1e-4 * driving[2]);
  }
  EXPECT_GT(motion(MotionKind::kForwardOnly).velocity(4.0).norm(), 0.1);
  EXPECT_GT(motion(MotionKind::kSidewaysOnly).velocity(4.0).norm(), 0.1);
}

TEST(SyntheticMotion, FollowsItsSeed) {
  const Rigid3 a = motion(MotionKind::kHandheld, 5).worldFromCamera(12.3);
  const Rigid3 b = motion(MotionKind::kHandheld, 5).worldFromCamera(12.3);
  const Rigid3 c = motion(MotionKind::kHandheld, 6).worldFromCamera(12.3);
  EXPECT_EQ(a.translation, b.translation);
  EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
  EXPECT_GT((a.translation - c.translation).norm(), 1e-3);
}

TEST(SyntheticMotion, NamesAreReadBack) {
  for (const MotionKind kind : kAllKinds) EXPECT_EQ(motionKindFromString(toString(kind)), kind);
  EXPECT_FALSE(motionKindFromString("circle"));
}

TEST(SyntheticMotion, RefusesImpossibleOptions) {
  SyntheticMotionOptions options;
  options.duration_s = 0.0;
  EXPECT_THROW(syntheticMotion(options), std::invalid_argument);
}

TEST(Interpolation, PassesThroughItsPosesAndFollowsTheMotionBetween) {
  const Trajectory truth = motion(MotionKind::kHandheld);
  Random random(3);
  std::vector<StampedPose> poses;
  for (double t = 0.0; t < 20.0; t += random.uniform(0.03, 0.07)) {
    poses.push_back({t, truth.worldFromCamera(t)});
  }
  const Trajectory trajectory = interpolate(poses);
  for (const StampedPose& pose : poses) {
    const Rigid3 at = trajectory.worldFromCamera(pose.time_s);
    EXPECT_LT((at.translation - pose.world_from_body.translation).norm(), 1e-9);
    EXPECT_LT(angleBetween(at, pose.world_from_body), 1e-7);
  }
  for (double t = 0.1; t < 19.8; t += 0.0137) {
    const Rigid3 at = trajectory.worldFromCamera(t);
    EXPECT_LT((at.translation - truth.worldFromCamera(t).translation).norm(), 2e-4);
    EXPECT_LT(angleBetween(at, truth.worldFromCamera(t)), 5e-4);
  }
}

// Sharp turns between coarse poses: a piecewise linear path would jump by more than 1 rad/s.
TEST(Interpolation, VelocityIsContinuous) {
  Random random(4);
  std::vector<StampedPose> poses;
  for (int i = 0; i < 60; ++i) {
    const Rigid3 pose(expSo3(0.3 * random.normal3()), 0.1 * random.normal3());
    poses.push_back({0.2 * i, pose});
  }
  EXPECT_LT(largestVelocityJump(interpolate(poses), 1e-4), 0.08);
}

TEST(Interpolation, RefusesDisorder) {
  EXPECT_THROW(interpolate({{0.0, Rigid3()}}), std::invalid_argument);
  EXPECT_THROW(interpolate({{0.0, Rigid3()}, {1.0, Rigid3()}, {1.0, Rigid3()}}),
               std::invalid_argument);
}

TEST(Trajectory, StandsStillBeyondItsEnds) {
  const Trajectory trajectory = motion(MotionKind::kHandheld);
  EXPECT_EQ(trajectory.worldFromCamera(-1.0).translation,
            trajectory.worldFromCamera(0.0).translation);
  EXPECT_EQ(trajectory.worldFromCamera(1e6).translation,
            trajectory.worldFromCamera(trajectory.duration()).translation);
}

TEST(TumFile, IsReadBack) {
  const Trajectory truth = motion(MotionKind::kHandheld);
  std::vector<StampedPose> poses;
  for (int i = 0; i < 10; ++i) poses.push_back({1.7e9 + 0.05 * i, truth.worldFromCamera(0.05 * i)});
  const std::string path = testing::TempDir() + "written.tum";
  writeTum(path, poses);
  const std::vector<StampedPose> read = readTum(path);
  ASSERT_EQ(read.size(), poses.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(read[i].time_s, poses[i].time_s, 1e-6);
    EXPECT_LT(angleBetween(read[i].world_from_body, poses[i].world_from_body), 1e-8);
    EXPECT_TRUE(
        read[i].world_from_body.translation.isApprox(poses[i].world_from_body.translation, 1e-8));
  }
  EXPECT_THROW(writeTum("/nonexistent/folder/x.tum", poses), std::runtime_error);
}

TEST(TumFile, FaultsNameFileAndLine) {
  const std::string good = "# comment\n\n0 1 2 3 0 0 0 1\n";
  EXPECT_EQ(readTum(writeFile("good.tum", good + "1 1 2 3 0 0 0 1\n")).size(), 2u);
  const auto fault = [&](const std::string& last_line) {
    return messageOf(writeFile("bad.tum", good + last_line));
  };
  for (const char* line : {"1 1 2 3 0 0 0", "1 1 2 x 0 0 0 1", "1 1 2 3 0 0 0 1 9",
                           "1 1 2 3 0 0 0 2", "0 1 2 3 0 0 0 1"}) {
    EXPECT_NE(fault(line).find("bad.tum, line 4: "), std::string::npos) << line << fault(line);
  }
  EXPECT_NE(fault("").find("less than two poses"), std::string::npos);
  EXPECT_NE(messageOf("/nonexistent.tum").find("No such file"), std::string::npos);
  EXPECT_NE(messageOf(testing::TempDir()).find("Is a directory"), std::string::npos);
}

TEST(RealMotion, FitsIntoTheRoomAndTurnsTheCamera) {
  std::vector<StampedPose> recorded;
  for (int i = 0; i <= 100; ++i) {
    recorded.push_back({100.0 + 0.1 * i, Rigid3(expSo3(Vector3d(0.0, 0.0, 0.01 * i)),
                                                Vector3d(0.2 * i, std::sin(0.1 * i), 5.0))});
  }
  RealMotionOptions options;
  options.body_from_camera = expSo3(Vector3d(0.0, 1.2, 0.0));
  options.start_s = 2.0;
  options.duration_s = 5.0;
  options.fit_into = Eigen::AlignedBox3d(Vector3d(-1.0, -1.0, 1.0), Vector3d(1.0, 1.0, 2.0));
  const Trajectory trajectory = realMotion(recorded, options);
  EXPECT_NEAR(trajectory.duration(), 5.0, 1e-9);
  const Rigid3 expected(recorded[20].world_from_body.rotation * options.body_from_camera,
                        Vector3d::Zero());
  EXPECT_LT(angleBetween(trajectory.worldFromCamera(0.0), expected), 1e-7);
  for (double t = 0.0; t <= 5.0; t += 0.1) {
    EXPECT_LT(options.fit_into->exteriorDistance(trajectory.worldFromCamera(t).translation), 1e-9);
  }
  // The recording is 10 m long and the room 2 m: all axes shrink alike.
  EXPECT_NEAR(
      (trajectory.worldFromCamera(3.0).translation - trajectory.worldFromCamera(1.0).translation)
          .x(),
      0.2 * 4.0, 1e-9);
  options.start_s = 20.0;
  EXPECT_THROW(realMotion(recorded, options), std::invalid_argument);
}

TEST(RealMotion, RecordedTrajectoriesAreUsable) {
  const char* folder = std::getenv("SELFCAL_TRAJECTORIES");
  if (folder == nullptr) GTEST_SKIP() << "set SELFCAL_TRAJECTORIES to a folder with TUM files";
  for (const char* name :
       {"euroc_V1_01", "euroc_MH_01", "tumvi_room4", "uzhfpv_indoor_45_2", "table_01"}) {
    RealMotionOptions options;
    options.fit_into = SyntheticMotionOptions().box;
    const Trajectory trajectory =
        realMotion(readTum(std::string(folder) + "/" + name + ".tum"), options);
    EXPECT_GT(trajectory.duration(), 20.0) << name;
    for (double t = 0.0; t < trajectory.duration(); t += 0.01) {
      ASSERT_LT(trajectory.velocity(t).norm(), 20.0) << name << " at " << t << " s";
    }
  }
}

TEST(Mount, TheCameraMovesWithTheBodyUntilItIsBumped) {
  const Trajectory body = syntheticMotion(SyntheticMotionOptions());
  Mount mount;
  mount.body_from_camera = Rigid3(expSo3({0.1, 0.5, -0.2}), {0.2, -0.1, 0.05});
  mount.bump_at_s = 3.0;
  mount.bump = Rigid3(expSo3({0.0, 0.0, 0.01}), {0.003, 0.0, 0.0});
  const Trajectory camera = mounted(body, mount);
  EXPECT_EQ(camera.duration(), body.duration());
  const auto onBody = [&](double time_s) {
    return body.worldFromCamera(time_s).inverse() * camera.worldFromCamera(time_s);
  };
  for (const double time_s : {0.0, 1.3, 2.99}) {
    EXPECT_TRUE(onBody(time_s).translation.isApprox(mount.body_from_camera.translation, 1e-9));
  }
  const Rigid3 moved = mount.body_from_camera.inverse() * onBody(3.01);
  EXPECT_TRUE(moved.translation.isApprox(mount.bump.translation, 1e-9));
  EXPECT_NEAR(logSo3(moved.rotation).z(), 0.01, 1e-9);
}

TEST(Mount, ALateCameraIsWhereTheBodyWillBe) {
  const Trajectory body = syntheticMotion(SyntheticMotionOptions());
  Mount mount;
  mount.late_s = 0.007;
  EXPECT_TRUE(mounted(body, mount)
                  .worldFromCamera(2.0)
                  .translation.isApprox(body.worldFromCamera(2.007).translation, 1e-12));
}

}  // namespace
}  // namespace camera_self_calibration
