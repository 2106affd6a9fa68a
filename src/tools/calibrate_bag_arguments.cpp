#include "camera_self_calibration/tools/calibrate_bag_arguments.h"

#include <algorithm>
#include <boost/program_options.hpp>
#include <cmath>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <system_error>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/queue/score_kind.h"
#include "camera_self_calibration/ros/mask_file.h"
#include "camera_self_calibration/tools/calibration_file.h"
#include "camera_self_calibration/tools/results_folder.h"
#include "camera_self_calibration/tools/trajectory_results.h"
#include "command_line.h"

namespace camera_self_calibration {
namespace {

namespace po = boost::program_options;

// Of folders and videos: from a picture each quarter of an hour to the fastest cameras there are.
constexpr double kLowestRateHz = 1e-3;
constexpr double kHighestRateHz = 1e5;
constexpr double kLongestSeconds = 1e9;  // thirty years; ROS counts seconds in 32 bits
// Of one camera's fits. A rig's sums would depend on them in the last digits.
constexpr int kThreads = 2;

constexpr const char* kUsage =
    "Calibrates a camera from a bag, a folder of images or a video, without a ROS master.\n"
    "\n"
    "  calibrate_bag BAG|FOLDER|VIDEO [--model fov] [--out DIR] [options]\n"
    "  calibrate_bag BAG --topics A B [...] [--baseline METERS] [--out DIR]: cameras of a rig\n"
    "\n"
    "Exit code: 0 converged, 2 ran but did not converge, 1 error, 3 no images,\n"
    "4 interrupted (Ctrl-C, SIGTERM): what is known so far is written and marked as partial.\n"
    "With --audit: 0 GOOD, 5 WRONG, 6 CANNOT_TELL.\n";

// clang-format off
void addImagesAndResults(CalibrateBagArguments* arguments, po::options_description* all) {
  SourceOptions& source = arguments->source;
  all->add_options()
    ("help,h", "this text")
    ("input", po::value(&source.path), "bag, folder of images or video file")
    ("topic", po::value(&source.topic), "image topic of the bag; needed if it has several")
    ("topics", po::value(&arguments->topics)->multitoken(),
     "image topics of the cameras of a rig, two to six: calibrates all, and where they sit")
    ("baseline", po::value<double>(),
     "distance between the first two cameras of a rig [m]: makes all lengths metric")
    ("model", po::value<std::string>(),
     "pinhole | fov | radtan (plumb_bob) | equidistant | auto (the simplest that describes the lens, "
     "starting with that of --initial or pinhole); default: auto")
    ("out", po::value(&arguments->out),
     "folder for the results; made if it is missing. Without it only a table is printed")
    ("state-out", po::value(&arguments->state_out),
     "file for the learnt state: for merge_calibrations, or as ~state_file. If it holds "
     "the result of this bag for this camera already, nothing is done")
    ("camera", po::value(&arguments->camera),
     "name of the camera in the file of --state-out; default: the topic")
    ("overwrite", po::bool_switch(&arguments->overwrite), "run again, and replace the file of --state-out")
    ("initial", po::value<std::string>(),
     "start values: a calibration file (any format that convert_calibration reads)")
    ("mask", po::value<std::string>(),
     "image that is black where features are not allowed, such as parts of the robot that move or "
     "cover half of the image")
    ("rate", po::value(&source.rate), "images per second of a folder (default 30) or video (default: its own times) [Hz]")
    ("start", po::value(&source.start_seconds), "skip this much of the beginning [s]")
    ("duration", po::value(&source.duration_seconds), "stop after this much [s]");
}

void addComparisons(CalibrateBagArguments* arguments, po::options_description* all) {
  all->add_options()
    ("report", po::bool_switch(&arguments->report),
     "write report.html, one page with everything, into the folder of --out")
    ("batch", po::bool_switch(&arguments->extras.batch),
     "solve the whole trajectory too, at intervals, and queues of 5, 10, 15 and 20 segments; "
     "figures into the folder of --out")
    ("reference-calibration", po::value<std::string>(),
     "a known calibration (file as --initial): run a second time with it held and compare")
    ("audit", po::value<std::string>(),
     "a calibration (any format that convert_calibration reads; of a rig Kalibr's camchain): is it still "
     "right? GOOD, WRONG with the likely cause, or CANNOT_TELL")
    ("audit-camera", po::value<std::string>(), "which camera of the --audit file, if there are several")
    ("audit-tolerance", po::value(&arguments->extras.audit.tolerance_px)->default_value(
         arguments->extras.audit.tolerance_px),
     "tolerated error of the --audit calibration where features are [px rms]")
    ("ground-truth", po::value<std::string>(),
     "poses of the camera (TUM format: t tx ty tz qx qy qz qw): report ATE and RPE");
}

void addEstimation(Options* options, po::options_description* all) {
  all->add_options()
    ("max-features", po::value(&options->tracker.max_features)->default_value(
         options->tracker.max_features), "good features tracked")
    ("sliding-window-keyframes", po::value(&options->sliding_window_keyframes)->default_value(
         options->sliding_window_keyframes), "keyframes of the sliding window")
    ("segment-keyframes", po::value(&options->segment_keyframes)->default_value(
         options->segment_keyframes), "keyframes of a segment")
    ("queue-segments", po::value(&options->queue_segments)->default_value(options->queue_segments),
     "segments of the queue")
    ("exact-references", po::bool_switch(&options->exact_references),
     "take the pixel in which a feature was detected as exact, not as a measurement")
    ("handover-entropy", po::value(&options->handover_entropy),
     "startup also ends below this normalised entropy [nats]; default: only by pixel uncertainty")
    ("alpha", po::value(&options->alpha)->default_value(options->alpha, "0.95"),
     "update rule of the queue, in (0, 1)")
    ("score", po::value<std::string>(),
     "what makes a segment better: entropy | pixel (expected error over the image); default "
     "entropy")
    ("rolling-shutter", po::value<std::string>(),
     "auto (estimated, default) | off (global shutter) | readout time of the whole image [s]")
    ("converged-pixel-rms", po::value(&options->converged_pixel_rms),
     "CONVERGED below this pixel uncertainty [px]; default: 1 px per 640 px of the longer side")
    ("relocalization-keyframes", po::value(&options->relocalization_keyframes)->default_value(
         options->relocalization_keyframes),
     "keyframes remembered to recognise a map that was lost; 0: it is never sought")
    ("solver-threads", po::value<int>(),
     "threads that share the fits; the result is the same, but for the last digits of a rig's. "
     "Default: 2, of a rig 1");
}
// clang-format on

po::options_description description(CalibrateBagArguments* arguments) {
  po::options_description all("Options", 100);
  addImagesAndResults(arguments, &all);
  addComparisons(arguments, &all);
  addEstimation(&arguments->options, &all);
  return all;
}

/// Without those that only say where results go.
std::string givenOptions(const po::parsed_options& parsed) {
  const std::set<std::string> others = {"input",     "out",    "state-out",      "camera",
                                        "overwrite", "report", "solver-threads", "help"};
  std::string text;
  for (const po::option& option : parsed.options) {
    if (others.count(option.string_key) > 0) continue;
    text += (text.empty() ? "--" : " --") + option.string_key;
    for (const std::string& value : option.value) text += " " + value;
  }
  return text;
}

CameraModel modelFromName(const std::string& name) {
  const std::optional<CameraModel> model = cameraModelFromString(name);
  if (model) return *model;
  throw std::runtime_error("--model " + name +
                           " is not one of pinhole, fov, radtan (or plumb_bob), equidistant, auto");
}

ScoreKind scoreFromName(const std::string& name) {
  const std::optional<ScoreKind> score = scoreKindFromString(name);
  if (score) return *score;
  throw std::runtime_error("--score " + name + " is not one of entropy, pixel");
}

void shutterFromText(const std::string& text, Options* options) {
  if (setRollingShutter(text, options)) return;
  throw std::runtime_error("--rolling-shutter " + text +
                           " is not auto, off or a readout time in seconds");
}

/// The start values, converted if another model was asked for.
void setInitial(const std::string& file, Options* options) {
  Camera camera = readCalibrationFile(file);
  if (options->model && camera.model() != *options->model) {
    const std::optional<CameraFit> fit = fitCamera(camera, *options->model);
    if (!fit || !std::isfinite(fit->error.max)) {
      throw std::runtime_error("the start values of " + file + " cannot be converted to " +
                               toString(*options->model) + " over the whole image. Leave out " +
                               "--initial, or calibrate with --model " + toString(camera.model()));
    }
    camera = fit->camera;
  }
  options->initial_camera = camera;
}

void setMask(const std::string& file, TrackerOptions* options) {
  if (file.empty()) throw std::runtime_error("--mask names no file");
  const MaskReading reading = readMask(file);
  if (!reading.mask) throw std::runtime_error("--mask: " + reading.error);
  options->mask = reading.mask;
}

void checkSource(const SourceOptions& source) {
  if (source.path.empty()) {
    throw std::runtime_error("no bag, folder or video is given; see calibrate_bag --help");
  }
  const auto within = [](const char* option, double value, double low, double high) {
    if (value == 0.0 || (value >= low && value <= high)) return;
    throw std::runtime_error(
        formatted("--%s is %g; it must be 0 or lie between %g and %g", option, value, low, high));
  };
  within("rate", source.rate, kLowestRateHz, kHighestRateHz);
  within("start", source.start_seconds, 0.0, kLongestSeconds);
  within("duration", source.duration_seconds, 0.0, kLongestSeconds);
}

/// The name of the parameter that begins the sentence, as an option of the command line.
std::string asOption(std::string problem) {
  std::replace(problem.begin(), std::find(problem.begin(), problem.end(), ' '), '_', '-');
  return problem;
}

void checkOptions(const Options& options) {
  const std::vector<std::string> problems = options.problems();
  if (problems.empty()) return;
  std::string text = "the options cannot be used:";
  for (const std::string& problem : problems) text += "\n  - " + withFullStop(asOption(problem));
  throw std::runtime_error(text);
}

/// A run removes the results of an earlier one; what it is to start from or to judge stays.
void refuseResultsAsInput(const po::variables_map& given, const std::string& out) {
  for (const char* option : {"initial", "mask", "audit", "reference-calibration", "ground-truth"}) {
    if (given.count(option) == 0 || !liesIn(given[option].as<std::string>(), out)) continue;
    throw std::runtime_error(std::string("--") + option +
                             " names a file in the folder of --out, whose files a run replaces. "
                             "Give another folder to --out");
  }
  // The pictures of --batch would be among the images of the next run.
  std::error_code none;
  const std::string input = given["input"].as<std::string>();
  if (std::filesystem::is_directory(input, none) && std::filesystem::equivalent(input, out, none)) {
    throw std::runtime_error("the images are in the folder of --out. Give another folder to --out");
  }
}

void readAudited(const po::variables_map& given, CalibrateExtras* extras) {
  if (!(extras->audit.tolerance_px > 0.0 && std::isfinite(extras->audit.tolerance_px))) {
    throw std::runtime_error("--audit-tolerance must be a positive number of pixels");
  }
  const bool named = given.count("audit-camera") > 0;
  if (given.count("audit") > 0 && given.count("topics") == 0) {
    extras->audited =
        readCalibration(given["audit"].as<std::string>(), std::nullopt,
                        named ? given["audit-camera"].as<std::string>() : std::string())
            .stored.camera;
  } else if (named && given.count("audit") == 0) {
    throw std::runtime_error("--audit-camera needs a file: give --audit CALIBRATION");
  }
}

/// What a rig has no answer to is refused rather than ignored.
void readRig(const po::variables_map& given, CalibrateBagArguments* arguments) {
  RigExtras& rig = arguments->rig;
  if (given.count("baseline") > 0) rig.baseline_m = given["baseline"].as<double>();
  const std::size_t cameras = arguments->topics.size();
  if (cameras == 0) {
    if (!rig.baseline_m) return;
    throw std::runtime_error("--baseline is the distance between two cameras: give --topics A B");
  }
  if (cameras < 2 || cameras > 6) {
    throw std::runtime_error("--topics needs the image topics of two to six cameras");
  }
  if (rig.baseline_m && !isBaseline(*rig.baseline_m)) {
    throw std::runtime_error(formatted("--baseline is %g; it must lie between %g and %g m",
                                       *rig.baseline_m, kShortestBaseline, kLongestBaseline));
  }
  for (const char* option : {"topic", "state-out", "camera", "initial", "mask",
                             "reference-calibration", "audit-camera"}) {
    if (given.count(option) == 0) continue;
    throw std::runtime_error(std::string("--") + option + " is for one camera; leave it out, or " +
                             "leave out --topics");
  }
  if (arguments->extras.batch) {
    throw std::runtime_error("--batch is for one camera; leave out --topics");
  }
  rig.example = arguments->report;
  rig.audit = arguments->extras.audit;
  if (given.count("audit") == 0) return;
  rig.audited = readRigCalibration(given["audit"].as<std::string>());
  if (rig.audited->cameras.size() == cameras) return;
  throw std::runtime_error(
      formatted("the camchain of --audit holds %d cameras, and --topics names %zu",
                rig.audited->size(), cameras));
}

void checkStateOut(const CalibrateBagArguments& arguments) {
  if (!arguments.state_out.empty()) return;
  if (arguments.overwrite || !arguments.camera.empty()) {
    throw std::runtime_error(std::string(arguments.overwrite ? "--overwrite" : "--camera") +
                             " is about the file of --state-out, which is not given");
  }
}

void readComparisons(const po::variables_map& given, CalibrateBagArguments* arguments) {
  if (given.count("reference-calibration") > 0) {
    arguments->extras.reference =
        readCalibrationFile(given["reference-calibration"].as<std::string>());
  }
  readAudited(given, &arguments->extras);
  if (given.count("ground-truth") > 0) {
    arguments->ground_truth = readGroundTruth(given["ground-truth"].as<std::string>());
  }
  if (arguments->report && arguments->out.empty()) {
    throw std::runtime_error("--report needs a folder to write to: give --out DIR");
  }
}

}  // namespace

std::optional<CalibrateBagArguments> parseCalibrateBagArguments(int argc, const char* const* argv) {
  CalibrateBagArguments arguments;
  const auto read = readCommandLine(argc, argv, description(&arguments), {"input"}, kUsage);
  if (!read) return std::nullopt;
  const po::variables_map& given = *read;
  checkSource(arguments.source);
  refuseResultsAsInput(given, arguments.out);
  arguments.given = givenOptions(parseCommandLine(argc, argv, description(&arguments), {"input"}));
  const std::string model = given.count("model") > 0 ? given["model"].as<std::string>() : "auto";
  if (model != "auto") arguments.options.model = modelFromName(model);
  if (given.count("score") > 0) {
    arguments.options.score = scoreFromName(given["score"].as<std::string>());
  }
  if (given.count("rolling-shutter") > 0) {
    shutterFromText(given["rolling-shutter"].as<std::string>(), &arguments.options);
  }
  const int threads = arguments.topics.empty() ? kThreads : 1;
  arguments.options.solver_threads =
      given.count("solver-threads") > 0 ? given["solver-threads"].as<int>() : threads;
  if (given.count("initial") > 0) {
    setInitial(given["initial"].as<std::string>(), &arguments.options);
  }
  readComparisons(given, &arguments);
  arguments.extras.example = arguments.report;
  readRig(given, &arguments);
  if (given.count("mask") > 0) {
    setMask(given["mask"].as<std::string>(), &arguments.options.tracker);
  }
  checkStateOut(arguments);
  checkOptions(arguments.options);
  return arguments;
}

}  // namespace camera_self_calibration
