// Calibrates from images that show nothing: the library is found, and says that it is waiting.
#include <camera_self_calibration/pipeline/self_calibrator.h>
#include <camera_self_calibration/pipeline/state_file.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

namespace csc = camera_self_calibration;

int main() {
  csc::Options options;
  options.model = csc::CameraModel::kRadtan;
  csc::SelfCalibrator calibrator(options, csc::SelfCalibrator::Mode::kInline, {});
  const auto pixels = std::make_shared<const std::vector<std::uint8_t>>(320 * 240, 128);
  for (int i = 0; i < 5; ++i) {
    csc::ImageView image;
    image.stamp_ns = i * 50'000'000LL;
    image.width = image.stride = 320;
    image.height = 240;
    image.data = pixels->data();
    image.owner = pixels;
    calibrator.process(image);
  }
  const csc::CalibrationReport report = calibrator.calibration();
  std::printf("%s: %s\n", csc::toString(report.state).c_str(), report.sentence.c_str());
  const csc::DecodedState saved = csc::decodeState("what another program wrote");
  std::printf("a saved state: %s\n", saved.error.c_str());
  if (calibrator.state() || saved.state) return 1;
  return report.state == csc::CalibrationState::kWaitingForMotion ? 0 : 1;
}
