#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "camera_self_calibration/ros/self_calibration_node.h"

namespace camera_self_calibration {

/// SelfCalibrationNode in a nodelet manager, where images come without a copy.
class SelfCalibrationNodelet : public nodelet::Nodelet {
 private:
  void onInit() override {
    node_ =
        std::make_unique<SelfCalibrationNode>(getNodeHandle(), getPrivateNodeHandle(), getName());
  }

  std::unique_ptr<SelfCalibrationNode> node_;
};

}  // namespace camera_self_calibration

PLUGINLIB_EXPORT_CLASS(camera_self_calibration::SelfCalibrationNodelet, nodelet::Nodelet)
