// Calibration files of all formats: a valid camera or an exception; what is written reads back.

#include <cmath>

#include "camera_self_calibration/base/text.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/tools/calibration_format.h"
#include "fuzz_bytes.h"

namespace camera_self_calibration {
namespace {

void checkReadsBack(const Camera& camera, CalibrationFormat format) {
  const CameraFit fit = storable(camera, format);
  const Camera read = parseCalibration(calibrationText(fit.camera, format), format).camera;
  require(read.width() == camera.width() && read.height() == camera.height(),
          "the size reads back");
  const double blind = pixelDistance(fit.camera, fit.camera).max;  // not 0 where it sees no pixel
  require(blind != 0.0 || pixelDistance(fit.camera, read).max < 1e-6, "the lens reads back");
}

std::optional<CalibrationFormat> detected(const std::string& text) {
  try {
    return detectCalibrationFormat(text);
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

void read(const std::string& text, CalibrationFormat format, const std::string& wanted) {
  Camera camera;
  try {
    camera = parseCalibration(text, format, wanted).camera;
  } catch (const std::runtime_error&) {
    countInput(false);
    return;
  }
  countInput(true);
  require(camera.valid() && camera.width() > 0 && camera.height() > 0, "what is read is valid");
  try {
    checkReadsBack(camera, format);
  } catch (const std::runtime_error&) {
    // A lens that the format cannot hold.
  }
}

void readRig(const std::string& text) {
  try {
    const Rig rig = parseRigCalibration(text);
    require(rig.size() >= 2, "a rig has two cameras");
    for (const Camera& camera : rig.cameras) require(camera.valid(), "its cameras are valid");
    for (const Rigid3& pose : rig.rig_from_camera) {
      require(pose.translation.allFinite() && std::abs(pose.rotation.norm() - 1.0) < 1e-9,
              "and where they sit");
    }
  } catch (const std::runtime_error&) {
    // Not a camchain.
  }
}

}  // namespace
}  // namespace camera_self_calibration

// The first byte: a format, or the one that the text looks like.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace camera_self_calibration;
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(bytes) + 1, size - 1);
  if (!isText(text)) return 0;
  constexpr int kFormats = static_cast<int>(CalibrationFormat::kVins) + 1;
  const int given = bytes[0] % (kFormats + 1);
  const std::optional<CalibrationFormat> format =
      given < kFormats ? std::optional(static_cast<CalibrationFormat>(given)) : detected(text);
  if (format) read(text, *format, bytes[0] < 128 ? "" : "cam1");
  readRig(text);
  return 0;
}
