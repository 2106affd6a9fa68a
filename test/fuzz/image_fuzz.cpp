// Images as they come from the graph, raw and compressed: a view within its own pixels, or a
// reason.

#include <boost/make_shared.hpp>

#include "camera_self_calibration/ros/gray_image.h"
#include "fuzz_bytes.h"

namespace camera_self_calibration {
namespace {

void check(const GrayImage& image) {
  require(image.view || !image.error.empty(), "a refusal has a reason");
  countInput(image.view.has_value());
  if (!image.view) return;
  const ImageView& view = *image.view;
  require(view.width > 0 && view.height > 0 && view.stride >= view.width, "the view is one");
  unsigned sum = 0;  // AddressSanitizer sees what lies outside
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      sum += view.data[static_cast<std::ptrdiff_t>(y) * view.stride + x];
    }
  }
  require(sum <= 255u * static_cast<unsigned>(view.width) * static_cast<unsigned>(view.height),
          "pixels are bytes");
}

sensor_msgs::ImagePtr anyImage(FuzzedDataProvider* data) {
  const auto image = boost::make_shared<sensor_msgs::Image>();
  image->encoding = data->PickValueInArray(
      {"mono8", "mono16", "bgr8", "rgba8", "rgb16", "bayer_rggb8", "bayer_gbrg16", "8UC1", "16UC1",
       "8UC3", "16UC3", "32FC1", "64FC4", "yuv422", "yuv422_yuy2", "8UC", "8UC999999999", "x"});
  if (data->ConsumeBool()) image->encoding = data->ConsumeRandomLengthString(16);
  image->width = data->ConsumeBool() ? 8 : data->ConsumeIntegral<std::uint32_t>();
  image->height = data->ConsumeBool() ? 6 : data->ConsumeIntegral<std::uint32_t>();
  image->step = data->ConsumeBool() ? 64 : data->ConsumeIntegral<std::uint32_t>();
  image->is_bigendian = data->ConsumeBool() ? 1 : 0;
  image->data = data->ConsumeRemainingBytes<std::uint8_t>();
  if (image->width == 8 && image->height == 6 && image->step == 64) image->data.resize(6 * 64);
  return image;
}

}  // namespace
}  // namespace camera_self_calibration

// The first byte: raw or compressed.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace camera_self_calibration;
  if (size == 0) return 0;
  GrayConverter converter;
  if (bytes[0] == 'C') {
    sensor_msgs::CompressedImage message;
    message.data.assign(bytes + 1, bytes + size);
    check(converter.convert(message));
    return 0;
  }
  FuzzedDataProvider data(bytes + 1, size - 1);
  check(converter.convert(sensor_msgs::ImageConstPtr(anyImage(&data))));
  return 0;
}
