// Converts a calibration from one format to another: the program convert_calibration.

#include <boost/program_options.hpp>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <stdexcept>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/tools/calibration_file.h"
#include "camera_self_calibration/tools/calibration_text.h"
#include "command_line.h"

namespace camera_self_calibration {
namespace {

namespace po = boost::program_options;

constexpr const char* kUsage =
    "Converts a camera calibration.\n"
    "\n"
    "  convert_calibration IN OUT --to FORMAT [options]\n"
    "\n"
    "Formats: ros (camera_info_manager), plain (model, width, height, params), kalibr (camchain),\n"
    "opencv (FileStorage), colmap (cameras.txt), orbslam3, vins. A model that the target does not\n"
    "have is fitted by one that it has; what that costs in pixels is printed.\n"
    "Exit code: 0 written, 1 error.\n";

struct Arguments {
  std::string in;
  std::string out;
  std::string from;
  std::string to;
  std::string camera;
  CalibrationLabels labels;
  po::variables_map given;
};

po::options_description description(Arguments* arguments) {
  CalibrationLabels& labels = arguments->labels;
  po::options_description all("Options", 100);
  // clang-format off
  all.add_options()
    ("help,h", "this text")
    ("in", po::value(&arguments->in), "file to read")
    ("out", po::value(&arguments->out), "file to write; an existing one is replaced")
    ("to", po::value(&arguments->to), "format of OUT")
    ("from", po::value(&arguments->from), "format of IN; default: detected from its contents")
    ("camera", po::value(&arguments->camera),
     "which camera of a file with several: cam0, cam1, ... (kalibr), the id (colmap), 1 or 2 (opencv), "
     "Camera1 or Camera2 (orbslam3)")
    ("name", po::value(&labels.camera_name),
     "camera_name in OUT (ros, vins); default: that of IN (ros, vins), else camera")
    ("topic", po::value(&labels.topic)->default_value(labels.topic), "rostopic in OUT (kalibr)")
    ("rate", po::value(&labels.rate_hz)->default_value(labels.rate_hz),
     "images per second in OUT (orbslam3) [Hz]");
  // clang-format on
  return all;
}

CalibrationFormat formatNamed(const std::string& option, const std::string& name) {
  const auto format = calibrationFormatFromString(name);
  if (format) return *format;
  throw std::runtime_error(option + " '" + name + "' is not one of " + calibrationFormatNames());
}

/// Other formats have names for the cameras of one file, such as cam0.
bool hasCameraName(CalibrationFormat format) {
  return format == CalibrationFormat::kRos || format == CalibrationFormat::kVins;
}

/// What OUT has no place for is refused rather than ignored.
void checkLabels(const po::variables_map& given, CalibrationFormat to) {
  for (const auto& [option, has_place] :
       {std::pair{"name", hasCameraName(to)}, std::pair{"topic", to == CalibrationFormat::kKalibr},
        std::pair{"rate", to == CalibrationFormat::kOrbSlam3}}) {
    if (has_place || given.count(option) == 0 || given[option].defaulted()) continue;
    throw std::runtime_error("--" + std::string(option) + " has no meaning for the format " +
                             toString(to) + ", which does not hold it; leave it out");
  }
}

/// A camera's own name stays what it was, unless another one is asked for.
CalibrationLabels labelsOf(const Arguments& arguments, const CalibrationInFile& read) {
  CalibrationLabels labels = arguments.labels;
  const bool renamed = arguments.given.count("name") > 0;
  const bool named = hasCameraName(read.format) && !read.stored.name.empty();
  if (named && !renamed) labels.camera_name = read.stored.name;
  return labels;
}

/// Says what of IN is not in OUT; true if there is any.
bool reportLosses(const StoredCalibration& stored) {
  if (stored.rectified) {
    std::cout << "The rectification of IN (R and P, of a stereo pair or of a chosen view) is not "
                 "written; OUT has the camera alone.\n";
  }
  if (stored.windowed) {
    std::cout << "The binning and region of interest of IN are not written; OUT is for images of "
                 "the full resolution, "
              << sizeText(stored.camera.width(), stored.camera.height()) << ".\n";
  }
  return stored.rectified || stored.windowed;
}

void check(const Arguments& arguments) {
  if (arguments.in.empty() || arguments.out.empty() || arguments.to.empty()) {
    throw std::runtime_error("IN, OUT and --to FORMAT are needed; see --help");
  }
  std::error_code ignored;
  if (std::filesystem::equivalent(arguments.in, arguments.out, ignored)) {
    throw std::runtime_error("IN and OUT are the same file; a fit would lose the original");
  }
  if (!(arguments.labels.rate_hz >= 1.0 && arguments.labels.rate_hz <= 1e4)) {
    throw std::runtime_error("--rate must lie between 1 and 10000 Hz");
  }
}

int run(const Arguments& arguments) {
  check(arguments);
  const CalibrationFormat to = formatNamed("--to", arguments.to);
  checkLabels(arguments.given, to);
  std::optional<CalibrationFormat> from;
  if (!arguments.from.empty()) from = formatNamed("--from", arguments.from);
  const CalibrationInFile read = readCalibration(arguments.in, from, arguments.camera);
  std::cout << "read  " << describe(arguments.in, read);
  const CameraFit fit =
      writeCalibration(arguments.out, read.stored.camera, to, labelsOf(arguments, read));
  std::cout << "wrote " << describe(arguments.out, {{{}, fit.camera}, to});
  const bool lossy = reportLosses(read.stored);
  if (fit.camera.model() == read.stored.camera.model() && fit.error.max == 0.0) {
    std::cout << (lossy ? "The camera is exact.\n" : "exact\n");
    return 0;
  }
  std::cout << std::setprecision(3) << "fitted, since the format has no "
            << toString(read.stored.camera.model()) << " like this: off by " << fit.error.rms
            << " px rms, " << fit.error.max << " px at most over the image\n";
  return 0;
}

std::optional<Arguments> parse(int argc, const char* const* argv) {
  Arguments arguments;
  const auto given = readCommandLine(argc, argv, description(&arguments), {"in", "out"}, kUsage);
  if (!given) return std::nullopt;
  arguments.given = *given;
  return arguments;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  return runProgram(
      "convert_calibration", [&] { return parse(argc, argv); }, run);
}
