#include "camera_self_calibration/simulation/tum_file.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "camera_self_calibration/base/formatted.h"

namespace camera_self_calibration {
namespace {

StampedPose parseLine(const std::string& line, const std::string& where) {
  std::istringstream in(line);
  StampedPose pose;
  double v[8];
  for (double& value : v) {
    if (!(in >> value) || !std::isfinite(value)) {
      throw std::runtime_error(where + ": expected eight numbers `t tx ty tz qx qy qz qw`");
    }
  }
  std::string rest;
  if (in >> rest) {
    throw std::runtime_error(where + ": more than the eight numbers `t tx ty tz qx qy qz qw`");
  }
  const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
  if (std::abs(q.norm() - 1.0) > 0.01) {
    throw std::runtime_error(where + ": the quaternion's length is not 1");
  }
  pose.time_s = v[0];
  pose.world_from_body = Rigid3(q.normalized(), Eigen::Vector3d(v[1], v[2], v[3]));
  return pose;
}

// Moves and shrinks the positions into a box.
void fit(const Eigen::AlignedBox3d& room, std::vector<StampedPose>* poses) {
  Eigen::AlignedBox3d extent;
  for (const StampedPose& pose : *poses) extent.extend(pose.world_from_body.translation);
  double scale = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double wide = extent.sizes()[axis];
    if (wide > room.sizes()[axis]) scale = std::min(scale, room.sizes()[axis] / wide);
  }
  for (StampedPose& pose : *poses) {
    Eigen::Vector3d& t = pose.world_from_body.translation;
    t = room.center() + scale * (t - extent.center());
  }
}

}  // namespace

std::vector<StampedPose> readTum(const std::string& path) {
  std::ifstream in(path);
  const auto refuse = [&path] {
    throw std::runtime_error(path + ": cannot be read: " + std::strerror(errno));
  };
  if (!in) refuse();
  std::vector<StampedPose> poses;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#') continue;
    const std::string where = path + ", line " + std::to_string(number);
    poses.push_back(parseLine(line, where));
    if (poses.size() > 1 && !(poses.back().time_s > poses[poses.size() - 2].time_s)) {
      throw std::runtime_error(where + ": the time is not later than that of the line before");
    }
  }
  if (in.bad()) refuse();  // as of a folder
  if (poses.size() < 2) throw std::runtime_error(path + ": holds less than two poses");
  return poses;
}

void writeTum(const std::string& path, const std::vector<StampedPose>& poses) {
  std::ofstream out(path);
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d& t = pose.world_from_body.translation;
    const Eigen::Quaterniond& q = pose.world_from_body.rotation;
    out << formatted("%.9f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", pose.time_s, t.x(), t.y(), t.z(),
                     q.x(), q.y(), q.z(), q.w());
  }
  if (!out.flush()) throw std::runtime_error(path + ": cannot be written");
}

Trajectory realMotion(const std::vector<StampedPose>& recorded, const RealMotionOptions& options) {
  std::vector<StampedPose> poses;
  const double begin = recorded.empty() ? 0.0 : recorded.front().time_s;
  for (const StampedPose& pose : recorded) {
    const double time = pose.time_s - begin - options.start_s;
    if (time < 0.0 || time > options.duration_s) continue;
    poses.push_back(pose);
    Rigid3& camera = poses.back().world_from_body;
    camera.rotation = (camera.rotation * options.body_from_camera).normalized();
  }
  if (poses.size() < 2) {
    const double length = recorded.empty() ? 0.0 : recorded.back().time_s - begin;
    throw std::invalid_argument("the recorded trajectory lasts " + std::to_string(length) +
                                " s and has less than two poses after start_s = " +
                                std::to_string(options.start_s) + " s: choose an earlier start");
  }
  if (options.fit_into) fit(*options.fit_into, &poses);
  return interpolate(poses);
}

}  // namespace camera_self_calibration
