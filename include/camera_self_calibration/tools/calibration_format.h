#pragma once

#include <optional>
#include <string>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/rig/rig.h"

namespace camera_self_calibration {

/// The files in which people keep calibrations. Pixel centres lie at integer coordinates in all but
/// kColmap, which counts from the corner of the image: its cx, cy are larger by 0.5.
enum class CalibrationFormat {
  kRos,       ///< YAML of camera_info_manager and camera_calibration.
  kPlain,     ///< YAML with model, width, height, params (in the order of CameraModel).
  kKalibr,    ///< Camchain: a YAML with cam0, cam1, ...
  kOpenCv,    ///< cv::FileStorage (YAML or XML) as OpenCV's calibration sample writes it.
  kColmap,    ///< cameras.txt of a text model.
  kOrbSlam3,  ///< Settings with File.version 1.0; older ones are read too.
  kVins       ///< camodocal, as VINS-Mono and VINS-Fusion read it.
};

/// "ros", "plain", "kalibr", "opencv", "colmap", "orbslam3", "vins".
std::string toString(CalibrationFormat format);
std::optional<CalibrationFormat> calibrationFormatFromString(const std::string& name);
/// All names, for messages: "ros, plain, ...".
std::string calibrationFormatNames();

/// The format of a file's text, from what stands in it; nothing if it is none of them. Throws
/// std::runtime_error that says where what looks like YAML is none.
std::optional<CalibrationFormat> detectCalibrationFormat(const std::string& text);

struct StoredCalibration {
  std::string name;  ///< That of the camera in the file; may be empty.
  Camera camera;     ///< Valid, of positive size.
  /// Whether the file says more of rectified images than the camera does (R and P of kRos): what is
  /// written from `camera` has none of that.
  bool rectified = false;
  /// Whether its images are binned or show a part of the sensor (kRos), while the camera is that of
  /// the sensor's full resolution.
  bool windowed = false;
};

/// Reads one camera; `wanted` is its name in the file (kKalibr: cam0, ...; kColmap: the id;
/// kOpenCv: 1 or 2; kOrbSlam3: Camera1 or Camera2), needed only where there are several. The text
/// must be isText(). Throws std::runtime_error that says what is wrong.
StoredCalibration parseCalibration(const std::string& text, CalibrationFormat format,
                                   const std::string& wanted = {});

/// The cameras of a rig and where they sit, from Kalibr's camchain (T_cn_cnm1). Lengths are the
/// file's. Throws as parseCalibration().
Rig parseRigCalibration(const std::string& text);

/// The camera as the format can hold it: itself, with error 0, where the format has the model; else
/// the best fit by a model that it has. Throws std::runtime_error where none fits, or reaches the
/// whole image.
CameraFit storable(const Camera& camera, CalibrationFormat format);

/// For those who read a file that holds a fit of this camera: what was fitted and what that costs,
/// in a line. Empty where the fit is exact.
std::string fitNote(const Camera& camera, const PixelError& error);

/// Below this a fit is as good as exact: no image shows it [px].
constexpr double kNoticeablePx = 1e-3;

/// The same in a sentence for those who asked for a file: what `holder` (a file, or a part of it)
/// has in place of the camera, and why. Empty where nobody would notice (kNoticeablePx).
std::string approximationNote(const std::string& holder, const Camera& camera,
                              CalibrationFormat format, const CameraFit& fit);

/// What a file says beside the intrinsics, where the format has a place for it.
struct CalibrationLabels {
  std::string camera_name = "camera";
  std::string topic = "/camera/image_raw";  ///< kKalibr.
  double rate_hz = 30.0;                    ///< kOrbSlam3.
  std::string comment;                      ///< Of writeCalibration(); one line, or empty.
};

/// The text of a file with this one camera, which must be storable() as it is. Numbers are written
/// with all their digits. Throws std::runtime_error if that fails.
std::string calibrationText(const Camera& camera, CalibrationFormat format,
                            const CalibrationLabels& labels = {});

}  // namespace camera_self_calibration
