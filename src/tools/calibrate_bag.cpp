// Calibrates a camera from stored images: the program calibrate_bag.

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>

#include "camera_self_calibration/tools/bag_state.h"
#include "camera_self_calibration/tools/calibrate.h"
#include "camera_self_calibration/tools/calibrate_bag_arguments.h"
#include "camera_self_calibration/tools/fleet_results.h"
#include "camera_self_calibration/tools/interruption.h"
#include "camera_self_calibration/tools/report_html.h"
#include "camera_self_calibration/tools/report_text.h"
#include "camera_self_calibration/tools/results_folder.h"
#include "camera_self_calibration/tools/rig_report.h"
#include "camera_self_calibration/tools/rig_results.h"
#include "camera_self_calibration/tools/trajectory_results.h"
#include "command_line.h"

namespace camera_self_calibration {
namespace {

// And that of runProgram.
enum ExitCode {
  kConverged = 0,
  kNotConverged = 2,
  kNoImages = 3,
  kInterrupted = 4,
  // In place of the first two where a calibration is audited; GOOD is 0.
  kWrong = 5,
  kCannotTell = 6
};

int exitCode(CalibrationState state) {
  return state == CalibrationState::kConverged ? kConverged : kNotConverged;
}

int exitCode(AuditVerdict verdict) {
  const std::map<AuditVerdict, int> codes = {{AuditVerdict::kGood, kConverged},
                                             {AuditVerdict::kWrong, kWrong},
                                             {AuditVerdict::kCannotTell, kCannotTell}};
  return codes.at(verdict);
}

int exitCode(const Recording& recording) {
  return recording.audit ? exitCode(recording.audit->verdict)
                         : exitCode(recording.final_report.state);
}

std::string nowText() { return timeText(1000000000LL * std::time(nullptr)); }

void writePage(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (!file.flush()) throw std::runtime_error(path.string() + " cannot be written");
}

RunDescription describe(const CalibrateBagArguments& arguments, const std::string& topic,
                        const Recording& recording) {
  return {arguments.source.path, topic, arguments.given,
          arguments.options.convergedRms(recording.final_report.camera), nowText()};
}

void write(const CalibrateBagArguments& arguments, const std::string& name,
           const Recording& recording, const TrajectoryResults& trajectory) {
  const std::vector<std::string> notes =
      writeRecording(arguments.out, name, recording,
                     {{"batch", batchJson(recording.final_report, recording.batch)},
                      {"trajectory", trajectoryJson(trajectory)}});
  for (const std::string& note : notes) std::cout << note << '\n';
  if (arguments.extras.batch) {
    writeBatchFigures(arguments.out, recording.reports, recording.batch, recording.reference);
  }
  if (!arguments.report) return;
  writePage(std::filesystem::path(arguments.out) / "report.html",
            reportHtml(describe(arguments, name, recording), recording, trajectory,
                       arguments.ground_truth));
}

/// A page of the rig, and one of each camera beside its files.
void writeReports(const CalibrateBagArguments& arguments, const RigRecording& recording,
                  const std::optional<TrajectoryDifference>& truth) {
  const std::filesystem::path folder(arguments.out);
  for (std::size_t c = 0; c < recording.cameras.size(); ++c) {
    const Recording& camera = recording.cameras[c];
    writePage(folder / cameraFolder(static_cast<int>(c)) / "report.html",
              reportHtml(describe(arguments, recording.topics[c], camera), camera, {}, {}));
  }
  writePage(folder / "report.html",
            rigReportHtml({arguments.source.path, "", arguments.given, 0.0, nowText()}, recording,
                          truth, arguments.ground_truth));
}

void writeState(const CalibrateBagArguments& arguments, const std::string& camera,
                const Recording& recording) {
  const auto state = stateOfBag(recording, arguments.source.path, camera);
  if (state) return writeState(arguments.state_out, *state);
  std::cerr << "calibrate_bag: " << arguments.state_out << " is not written: "
            << (recording.complete ? "the bag did not determine the lens" : kPartial) << '\n';
}

void sayWhere(const CalibrateBagArguments& arguments) {
  std::cout << "Results are in " << arguments.out
            << (arguments.report ? "; open report.html there" : "") << ".\n";
}

void warnOfTruth(const CalibrateBagArguments& arguments,
                 const std::optional<TrajectoryDifference>& truth) {
  if (arguments.ground_truth.empty() || truth) return;
  std::cerr << "warning: the ground truth has no poses at the times of the images\n";
}

int runRig(const CalibrateBagArguments& arguments) {
  const ResultsFolder folder(arguments.out, static_cast<int>(arguments.topics.size()));
  RigExtras extras = arguments.rig;
  extras.stop = interrupted;
  const RigRecording recording =
      calibrateRig(arguments.source, arguments.topics, arguments.options, extras);
  const auto truth =
      compareTrajectories({recording.poses.begin(), recording.poses.end()}, arguments.ground_truth);
  std::cout << rigText(recording) << rigTrajectoryText(truth, recording.estimate.metric);
  warnOfTruth(arguments, truth);
  if (!arguments.out.empty()) {
    for (const std::string& note : writeRig(arguments.out, recording)) std::cout << note << '\n';
    if (arguments.report) writeReports(arguments, recording, truth);
    sayWhere(arguments);
  }
  if (!recording.complete) return kInterrupted;
  const auto empty = [](const Recording& camera) { return camera.frames == 0; };
  if (std::any_of(recording.cameras.begin(), recording.cameras.end(), empty)) return kNoImages;
  if (recording.audit) return exitCode(recording.audit->verdict());
  return recording.converged() ? kConverged : kNotConverged;
}

int run(const CalibrateBagArguments& arguments) {
  if (!arguments.topics.empty()) return runRig(arguments);
  ImageSource source = openImages(arguments.source);
  const std::string camera = arguments.camera.empty() ? source.name : arguments.camera;
  if (!arguments.state_out.empty() && arguments.overwrite) {
    refuseForeignFile(arguments.state_out);
  } else if (!arguments.state_out.empty()) {
    const auto done = finishedState(arguments.state_out, arguments.source.path, camera);
    // A state has no verdict on a calibration: an audit runs the bag again.
    if (done && !arguments.extras.audited) {
      std::cout << arguments.state_out << " already holds the result of this bag for the camera '"
                << camera << "': " << toString(done->state) << '\n';
      return exitCode(done->state);
    }
  }
  if (!source.description.empty()) std::cout << source.description << std::endl;
  const ResultsFolder folder(arguments.out);
  CalibrateExtras extras = arguments.extras;
  extras.stop = interrupted;
  const Recording recording = calibrate(&source, arguments.options, extras);
  if (recording.frames == 0 && !recording.complete) {
    std::cerr << "calibrate_bag: interrupted before the first image: nothing is known\n";
    return kInterrupted;
  }
  if (recording.frames == 0) {
    std::cerr << "calibrate_bag: no images in " << arguments.source.path
              << (source.name.empty() ? " (it has no image topic)"
                                      : " between --start and --duration")
              << '\n';
    return kNoImages;
  }
  const TrajectoryResults trajectory = compareTrajectories(recording, arguments.ground_truth);
  std::cout << reportText(recording) << batchText(recording.final_report, recording.batch)
            << trajectoryText(trajectory);
  warnOfTruth(arguments, trajectory.truth);
  if (!arguments.out.empty()) {
    write(arguments, source.name, recording, trajectory);
    sayWhere(arguments);
  }
  if (!arguments.state_out.empty()) writeState(arguments, camera, recording);
  if (!recording.complete) {
    std::cerr << "calibrate_bag: interrupted after " << recording.frames << " images"
              << (arguments.out.empty() ? "" : "; the results in " + arguments.out + " are partial")
              << '\n';
    return kInterrupted;
  }
  return exitCode(recording);
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  catchInterruption();
  return runProgram(
      "calibrate_bag", [&] { return parseCalibrateBagArguments(argc, argv); }, run);
}
