#include "camera_self_calibration/simulation/sequence_writer.h"

#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/simulation/tum_file.h"

namespace camera_self_calibration {
namespace {

void writeImage(const std::string& path, const cv::Mat& image) {
  bool written = false;
  try {
    written = cv::imwrite(path, image);
  } catch (const cv::Exception&) {  // an extension that no encoder knows
  }
  if (!written) throw std::runtime_error(path + ": the image cannot be written");
}

}  // namespace

void writeTruth(const std::string& path, const Lens& lens) {
  std::ofstream out(path);
  out.precision(std::numeric_limits<double>::max_digits10);
  out << "model: " << toString(lens.camera.model()) << "\nwidth: " << lens.camera.width()
      << "\nheight: " << lens.camera.height() << "\nparams: [";
  const Intrinsics& parameters = lens.camera.parameters();
  for (int i = 0; i < parameters.size(); ++i) out << (i == 0 ? "" : ", ") << parameters[i];
  out << "]\n";
  if (lens.zoom_at_s) out << "zoom_at: " << *lens.zoom_at_s << "\nzoom: " << lens.zoom << "\n";
  if (!out.flush()) throw std::runtime_error(path + ": cannot be written");
}

void writeSequence(const SimulatedSequence& sequence, const std::string& folder,
                   const std::string& extension, const std::function<void(int)>& progress) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(folder + ": cannot be made (" + error.message() + ")");
  writeTruth(folder + "/truth.yaml", sequence.options().lens);
  std::vector<StampedPose> poses;
  for (int i = 0; i < sequence.size(); ++i) {
    const SimulatedFrame frame = sequence.frame(i);
    writeImage(folder + formatted("/%06d.", i) + extension, frame.image);
    poses.push_back({toSeconds(frame.stamp_ns), frame.world_from_camera});
    if (progress) progress(i);
  }
  writeTum(folder + "/ground_truth.tum", poses);
}

}  // namespace camera_self_calibration
