// Waits until simulated_camera has finished and tells whether the live calibration is right: the
// program check_against_truth. Exit code 0: converged, within three sigma; 2: not; 1: no result.

#include <camera_self_calibration/Calibration.h>
#include <ros/ros.h>
#include <std_msgs/Header.h>

#include <iomanip>
#include <iostream>
#include <optional>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/ros/usage.h"
#include "camera_self_calibration/tools/report_text.h"
#include "camera_self_calibration/tools/truth_table.h"

namespace camera_self_calibration {
namespace {

constexpr const char* kUsage =
    "Waits until simulated_camera has finished and tells whether the live calibration is right.\n"
    "Needs a ROS master.\n"
    "\n"
    "  check_against_truth truth:=TOPIC calibration:=TOPIC finished:=TOPIC [_limit:=SECONDS]\n"
    "\n"
    "Topics: truth and calibration (Calibration), finished (Header). _limit: how long to wait for\n"
    "the end at most [s].\n"
    "Exit code: 0 converged, within three sigma; 2 not; 1 no result.\n";

/// What has been heard so far.
struct Heard {
  Calibration::ConstPtr truth;
  Calibration::ConstPtr estimate;
  std::optional<ros::Time> end;
};

void showProgress(const Heard& heard) {
  if (!heard.truth || !heard.estimate || heard.estimate->calibration_sentence.empty()) return;
  const Calibration& estimate = *heard.estimate;
  std::cout << std::fixed << std::setprecision(1)
            << (estimate.header.stamp - heard.truth->header.stamp).toSec()
            << " s: " << estimate.calibration_state << ": "
            << clauses(estimate.calibration_sentence).front() << std::endl;
}

/// Until the camera has finished and the last keyframes are worked in, or the time is over.
void listen(double limit_s, Heard* heard) {
  const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(limit_s);
  ros::WallTime next_progress = ros::WallTime::now();
  std::optional<ros::WallTime> settled;
  while (ros::ok() && ros::WallTime::now() < limit &&
         (!settled || ros::WallTime::now() < *settled)) {
    ros::spinOnce();
    const ros::WallTime now = ros::WallTime::now();
    if (heard->end && !settled) settled = now + ros::WallDuration(2.0);
    if (now >= next_progress) {
      showProgress(*heard);
      next_progress = now + ros::WallDuration(3.0);
    }
    ros::WallDuration(0.02).sleep();
  }
}

int conclude(const Heard& heard) {
  if (!heard.truth || !heard.estimate) {
    std::cout << "no " << (heard.truth ? "calibration" : "truth") << " has come in time\n";
    return 1;
  }
  const TruthComparison comparison = compareWithTruth(*heard.truth, *heard.estimate);
  std::cout << '\n'
            << comparison.table << '\n'
            << heard.estimate->calibration_state << ": "
            << asSentence(heard.estimate->calibration_sentence) << '\n'
            << (comparison.passed()    ? "All parameters are within 3 sigma of the truth."
                : comparison.converged ? "Not all parameters are within 3 sigma of the truth."
                                       : "The calibration has not converged.")
            << std::endl;
  return comparison.passed() ? 0 : 2;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  if (printsUsage(argc, argv, kUsage)) return 0;
  ros::init(argc, argv, "check_against_truth");
  ros::NodeHandle node;
  Heard heard;
  const ros::Subscriber truth = node.subscribe<Calibration>(
      "truth", 10, [&](const Calibration::ConstPtr& message) { heard.truth = message; });
  const ros::Subscriber estimate = node.subscribe<Calibration>(
      "calibration", 10, [&](const Calibration::ConstPtr& message) { heard.estimate = message; });
  const ros::Subscriber finished = node.subscribe<std_msgs::Header>(
      "finished", 1, [&](const std_msgs::Header::ConstPtr& header) { heard.end = header->stamp; });
  listen(ros::param::param("~limit", 80.0), &heard);
  return conclude(heard);
}
