// CameraInfo of the factory, of ~set_camera_info and of files: a plausible start or a reason.

#include <ros/serialization.h>

#include "camera_self_calibration/camera/plausibility.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/ros/model_conversion.h"
#include "fuzz_bytes.h"

namespace camera_self_calibration {
namespace {

sensor_msgs::CameraInfo anyInfo(FuzzedDataProvider* data) {
  sensor_msgs::CameraInfo info;
  info.width = data->ConsumeBool() ? 640 : data->ConsumeIntegral<std::uint32_t>();
  info.height = data->ConsumeBool() ? 480 : data->ConsumeIntegral<std::uint32_t>();
  info.distortion_model =
      data->PickValueInArray({"plumb_bob", "rational_polynomial", "equidistant", "fov", ""});
  info.K[0] = anyNumber(data);
  info.K[4] = data->ConsumeBool() ? info.K[0] : anyNumber(data);
  info.K[2] = anyNumber(data);
  info.K[5] = anyNumber(data);
  info.D.resize(data->ConsumeIntegralInRange<std::size_t>(0, 14));
  for (double& value : info.D) {
    value = data->ConsumeBool() ? data->ConsumeFloatingPointInRange(-1.0, 1.0) : anyNumber(data);
  }
  return info;
}

}  // namespace
}  // namespace camera_self_calibration

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace camera_self_calibration;
  FuzzedDataProvider data(bytes, size);
  const sensor_msgs::CameraInfo info = anyInfo(&data);
  const int kind = data.ConsumeIntegralInRange(0, 4);
  const std::optional<CameraModel> model =
      kind < 4 ? std::optional(static_cast<CameraModel>(kind)) : std::nullopt;
  const std::optional<CameraFit> start = startFrom(info, model);
  countInput(start.has_value());
  if (!start) {
    require(!whyNoStart(info, model).empty(), "a refusal has a reason");
    return 0;
  }
  require(implausibility(start->camera).empty(), "a start is plausible");
  require(!model || start->camera.model() == *model, "a start is of the model asked for");
  const std::optional<CameraInfoConversion> back = toCameraInfo(start->camera);
  if (back) require(back->info.K[0] > 0.0, "what goes out is calibrated");
  return 0;
}
