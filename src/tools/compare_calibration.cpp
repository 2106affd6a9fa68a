// How far two calibrations of a camera are apart in pixels: the program compare_calibration.

#include <boost/program_options.hpp>
#include <cmath>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <stdexcept>

#include "camera_self_calibration/plotting/difference_chart.h"
#include "camera_self_calibration/tools/calibration_file.h"
#include "camera_self_calibration/tools/calibration_text.h"
#include "command_line.h"

namespace camera_self_calibration {
namespace {

namespace po = boost::program_options;

constexpr const char* kUsage =
    "Prints the distance of two calibrations of one camera, in pixels over the image, whatever\n"
    "their models and formats. What a rotation of the camera explains does not count.\n"
    "\n"
    "  compare_calibration A B [--out PICTURE.png] [options]\n"
    "\n"
    "Exit code: 0 compared, 2 further apart than --limit, 1 error.\n";

struct Arguments {
  std::string a;
  std::string b;
  std::string out;
  std::string camera_a;
  std::string camera_b;
  std::optional<double> limit_px;
  double radius_px = 1e9;
};

po::options_description description(Arguments* arguments) {
  po::options_description all("Options", 100);
  // clang-format off
  all.add_options()
    ("help,h", "this text")
    ("a", po::value(&arguments->a), "a calibration in any format that convert_calibration reads")
    ("b", po::value(&arguments->b), "another one, for the same image size")
    ("out", po::value(&arguments->out), "picture of the differences (PNG)")
    ("camera-a", po::value(&arguments->camera_a), "which camera of A, if there are several")
    ("camera-b", po::value(&arguments->camera_b), "which camera of B, if there are several")
    ("radius", po::value(&arguments->radius_px),
     "only within this distance of A's principal point [px]")
    ("limit", po::value<double>()->notifier([=](double px) { arguments->limit_px = px; }),
     "exit code 2 beyond this distance [px rms]");
  // clang-format on
  return all;
}

void checkSizes(const Camera& a, const Camera& b) {
  if (a.width() == b.width() && a.height() == b.height()) return;
  const auto size = [](const Camera& camera) {
    return std::to_string(camera.width()) + " x " + std::to_string(camera.height());
  };
  throw std::runtime_error("A is for images of " + size(a) + ", B for " + size(b) +
                           ": pixels of different sizes cannot be compared");
}

void checkPositive(const char* option, double pixels) {
  if (pixels > 0.0 && std::isfinite(pixels)) return;
  throw std::runtime_error(std::string(option) + " must be a positive number of pixels");
}

int run(const Arguments& arguments) {
  if (arguments.a.empty() || arguments.b.empty()) {
    throw std::runtime_error("two calibrations are needed; see --help");
  }
  checkPositive("--radius", arguments.radius_px);
  if (arguments.limit_px) checkPositive("--limit", *arguments.limit_px);
  const auto file_a = readCalibration(arguments.a, std::nullopt, arguments.camera_a);
  const auto file_b = readCalibration(arguments.b, std::nullopt, arguments.camera_b);
  std::cout << "A: " << describe(arguments.a, file_a) << "B: " << describe(arguments.b, file_b)
            << "\n";
  const Camera& a = file_a.stored.camera;
  const Camera& b = file_b.stored.camera;
  checkSizes(a, b);
  const PixelDifference difference = pixelDifference(a, b, arguments.radius_px);
  if (!std::isfinite(difference.error.rms)) {
    throw std::runtime_error("no pixel of A can be seen by B");
  }
  std::cout << comparisonText(a, b, difference);
  if (!arguments.out.empty() &&
      !cv::imwrite(arguments.out, drawDifference(a, difference).fineImage())) {
    throw std::runtime_error("the picture cannot be written to " + arguments.out);
  }
  return arguments.limit_px && difference.error.rms > *arguments.limit_px ? 2 : 0;
}

std::optional<Arguments> parse(int argc, const char* const* argv) {
  Arguments arguments;
  if (readCommandLine(argc, argv, description(&arguments), {"a", "b"}, kUsage)) {
    return arguments;
  }
  return std::nullopt;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  return runProgram(
      "compare_calibration", [&] { return parse(argc, argv); }, run);
}
