// Calibrates a camera from stored images: the program calibrate_bag.

#include <filesystem>
#include <iomanip>
#include <iostream>

#include "camera_self_calibration/tools/calibrate.h"
#include "camera_self_calibration/tools/calibrate_bag_arguments.h"
#include "camera_self_calibration/tools/report_text.h"

namespace camera_self_calibration {
namespace {

enum ExitCode { kConverged = 0, kError = 1, kNotConverged = 2, kNoImages = 3 };

int run(const CalibrateBagArguments& arguments) {
  ImageSource source = openImages(arguments.source);
  // Before the work rather than after it: a folder that cannot be made.
  if (!arguments.out.empty()) std::filesystem::create_directories(arguments.out);
  const Recording recording = calibrate(&source, arguments.options);
  if (recording.frames == 0) {
    std::cerr << "calibrate_bag: no images in " << arguments.source.path
              << (source.name.empty() ? " (it has no image topic)" : "") << '\n';
    return kNoImages;
  }
  std::cout << reportText(recording);
  if (!arguments.out.empty()) writeRecording(arguments.out, source.name, recording);
  return recording.final_report.state == CalibrationState::kConverged ? kConverged : kNotConverged;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  try {
    const auto arguments = parseCalibrateBagArguments(argc, argv);
    return arguments ? run(*arguments) : 0;
  } catch (const std::exception& e) {
    std::cerr << "calibrate_bag: " << e.what() << '\n';
    return kError;
  }
}
