#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "camera_self_calibration/rig_node/rig_calibration_node.h"

namespace camera_self_calibration {

/// RigCalibrationNode in a nodelet manager, where images come without a copy.
class RigCalibrationNodelet : public nodelet::Nodelet {
 private:
  void onInit() override {
    node_ =
        std::make_unique<RigCalibrationNode>(getNodeHandle(), getPrivateNodeHandle(), getName());
  }

  std::unique_ptr<RigCalibrationNode> node_;
};

}  // namespace camera_self_calibration

PLUGINLIB_EXPORT_CLASS(camera_self_calibration::RigCalibrationNodelet, nodelet::Nodelet)
