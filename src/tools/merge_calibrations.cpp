// Merges what many bags told of many cameras: the program merge_calibrations.

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <thread>

#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/fleet/state_collection.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/tools/fleet_report.h"
#include "camera_self_calibration/tools/fleet_results.h"
#include "command_line.h"

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;
namespace po = boost::program_options;

constexpr const char* kUsage =
    "Merges the states that calibrate_bag --state-out wrote: one calibration for each camera.\n"
    "\n"
    "  merge_calibrations STATE|FOLDER... --out DIR [options]\n"
    "\n"
    "A folder stands for all *.state in it. Merged states may be merged again, in any order.\n"
    "Exit code: 0 merged, 1 error, 3 no state that can be used.\n";

enum ExitCode { kMerged = 0, kNothing = 3 };

struct Arguments {
  std::vector<std::string> inputs;
  std::string list;
  std::string out;
  std::string failures;
  double level = 0.01;
  int threads = 1;
  MergeOptions merge;
};

po::options_description description(Arguments* arguments) {
  po::options_description all("Options", 100);
  // clang-format off
  all.add_options()
    ("help,h", "this text")
    ("states", po::value(&arguments->inputs)->multitoken(), "state files, and folders of them")
    ("list", po::value(&arguments->list), "text file with one state file per line: for very many")
    ("out", po::value(&arguments->out), "folder for the results; made if it is missing")
    ("queue-segments", po::value(&arguments->merge.queue_segments)->default_value(
         arguments->merge.queue_segments), "segments of a merged queue")
    ("false-changes", po::value(&arguments->level)->default_value(arguments->level, "0.01"),
     "probability of reporting any change at all in a fleet without one, and of any outlier")
    ("failures", po::value(&arguments->failures),
     "text file with one line for each bag without a result: for the report")
    ("threads", po::value(&arguments->threads)->default_value(
         static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))),
     "cameras at a time; the result is the same");
  // clang-format on
  return all;
}

void addLines(const std::string& path, std::vector<std::string>* lines) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + " cannot be read: " + std::strerror(errno));
  for (std::string line; std::getline(file, line);) lines->push_back(line);
}

std::optional<Arguments> parse(int argc, const char* const* argv) {
  Arguments arguments;
  if (!readCommandLine(argc, argv, description(&arguments), {"states"}, kUsage)) {
    return std::nullopt;
  }
  if (!arguments.list.empty()) addLines(arguments.list, &arguments.inputs);
  if (arguments.inputs.empty()) throw std::runtime_error("no state is given; see --help");
  if (arguments.out.empty()) throw std::runtime_error("no folder for the results: give --out DIR");
  if (arguments.merge.queue_segments < 2) {
    throw std::runtime_error("--queue-segments must be at least 2");
  }
  if (!(arguments.level > 0.0 && arguments.level < 1.0)) {
    throw std::runtime_error("--false-changes must be between 0 and 1");
  }
  if (arguments.threads < 1) throw std::runtime_error("--threads must be at least 1");
  return arguments;
}

// In an order that does not depend on the file system.
std::vector<std::string> filesOf(const std::vector<std::string>& inputs) {
  std::vector<std::string> files;
  for (const std::string& input : inputs) {
    if (!fs::is_directory(input)) {
      files.push_back(fs::absolute(input).lexically_normal().string());
      continue;
    }
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(input)) {
      if (entry.path().extension() == ".state") {
        files.push_back(fs::absolute(entry.path()).lexically_normal().string());
      }
    }
  }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

void addSiblings(double level, std::vector<CameraResult>* cameras) {
  std::vector<Sibling> siblings;
  std::vector<std::size_t> of;
  for (std::size_t i = 0; i < cameras->size(); ++i) {
    const CameraResult& camera = (*cameras)[i];
    if (!camera.present().solved) continue;
    siblings.push_back(
        {camera.history.name, camera.present().lens, camera.present().solution.covariance});
    of.push_back(i);
  }
  const std::vector<SiblingVerdict> verdicts = compareSiblings(siblings, level);
  for (std::size_t i = 0; i < of.size(); ++i) (*cameras)[of[i]].siblings = verdicts[i];
}

// Two cameras must not share their files.
void checkNames(const std::vector<CameraHistory>& histories) {
  std::map<std::string, std::string> names;
  for (const CameraHistory& history : histories) {
    const auto [found, is_new] = names.emplace(fileStem(history.name), history.name);
    if (is_new) continue;
    throw std::runtime_error("the cameras '" + found->second + "' and '" + history.name +
                             "' would have the same files: rename one of them");
  }
}

std::vector<CameraResult> solveAll(const std::vector<CameraHistory>& histories,
                                   const SegmentStore& store, const Arguments& arguments) {
  std::vector<CameraResult> cameras(histories.size());
  std::vector<std::string> errors(histories.size());
  parallelFor(arguments.threads, static_cast<int>(histories.size()), [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    try {
      cameras[i] = writeCamera(histories[i], store, arguments.merge, arguments.out);
    } catch (const std::exception& e) {
      errors[i] = e.what();
    }
  });
  for (const std::string& error : errors) {
    if (!error.empty()) throw std::runtime_error(error);
  }
  addSiblings(arguments.level, &cameras);
  return cameras;
}

int run(const Arguments& arguments) {
  fs::create_directories(arguments.out);
  StateCollection read = readStates(filesOf(arguments.inputs));
  for (const std::string& problem : read.problems) std::cerr << "warning: " << problem << '\n';
  if (!arguments.failures.empty()) addLines(arguments.failures, &read.problems);
  if (read.records.empty()) {
    std::cerr << "merge_calibrations: none of the files holds a state that can be used\n";
    return kNothing;
  }
  const std::vector<CameraHistory> histories =
      historiesOf(std::move(read.records), read.store, arguments.level);
  checkNames(histories);
  refuseToReplaceOthers(histories, arguments.out);
  const std::vector<CameraResult> cameras = solveAll(histories, read.store, arguments);
  for (const CameraResult& camera : cameras) {
    std::cout << camera.history.name << ": " << toString(verdictOf(camera)) << " ("
              << camera.history.bags.size()
              << (camera.history.bags.size() == 1 ? " bag). " : " bags). ") << sentenceOf(camera)
              << '\n';
  }
  writeFleet(cameras, arguments.out);
  const std::string page = (fs::path(arguments.out) / "fleet.html").string();
  const std::string error = writeFileAtomically(page, fleetHtml(cameras, read.problems));
  if (!error.empty()) throw std::runtime_error(error);
  std::cout << "The page of the fleet: " << page << '\n';
  return kMerged;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  return runProgram(
      "merge_calibrations", [&] { return parse(argc, argv); }, run);
}
