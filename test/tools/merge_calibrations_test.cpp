// The merge of states, from files to files, and the program merge_calibrations.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/fleet/state_collection.h"
#include "camera_self_calibration/fleet/state_solution.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/state_file.h"
#include "camera_self_calibration/tools/bag_state.h"
#include "camera_self_calibration/tools/calibration_file.h"
#include "camera_self_calibration/tools/fleet_report.h"
#include "camera_self_calibration/tools/fleet_results.h"
#include "queue/sample_queues.h"
#include "tools/temporary_folder.h"

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kDay = 86400LL * 1000000000LL;

Camera lensOf(double zoom) {
  return camera640(CameraModel::kPinhole, {zoom * 420, zoom * 418, 322, 238});
}

// What a bag of that day told.
LearntState stateOn(int day, double zoom) {
  std::vector<Segment> segments =
      separateSegments(lensOf(zoom), 3, static_cast<std::uint64_t>(50 + day));
  for (Segment& segment : segments) {
    for (Keyframe& keyframe : segment.keyframes) keyframe.stamp_ns += day * kDay;
  }
  LearntState state;
  const SegmentQueue queue = solvedQueue(segments, lensOf(zoom));
  state.camera = queue.solution().camera;
  state.state = CalibrationState::kConverged;
  state.segments = queue.candidates();
  state.bags = {recordOf(state).value()};
  state.bags[0].bag = "day" + std::to_string(day) + ".bag";
  state.bags[0].camera = "robot/front";
  return state;
}

// States of six days, on disk; the lens is refocused after the third.
struct Fleet {
  TemporaryFolder folder;
  std::vector<std::string> files;

  Fleet() {
    for (int day = 0; day < 6; ++day) {
      files.push_back(folder / ("day" + std::to_string(day) + ".state"));
      writeState(files.back(), stateOn(day, day < 3 ? 1.0 : 1.03));
    }
  }
};

const Fleet& fleet() {
  static const Fleet made;
  return made;
}

CameraResult mergeInto(const std::string& folder, const std::vector<std::string>& files) {
  fs::create_directories(folder);
  StateCollection read = readStates(files);
  EXPECT_TRUE(read.problems.empty());
  const auto histories = historiesOf(std::move(read.records), read.store, 0.01);
  EXPECT_EQ(histories.size(), 1u);
  MergeOptions options;
  options.queue_segments = 5;
  return writeCamera(histories.at(0), read.store, options, folder);
}

std::vector<std::string> statesIn(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".state") files.push_back(entry.path().string());
  }
  return files;
}

std::set<std::pair<std::int64_t, std::int64_t>> momentsOf(const EpochResult& epoch) {
  std::set<std::pair<std::int64_t, std::int64_t>> moments;
  for (const WantedSegment& segment : epoch.solution.segments) {
    moments.insert({segment.mark.begin_ns, segment.mark.end_ns});
  }
  return moments;
}

void expectSame(const CameraResult& a, const CameraResult& b) {
  ASSERT_EQ(a.epochs.size(), b.epochs.size());
  for (std::size_t e = 0; e < a.epochs.size(); ++e) {
    EXPECT_EQ(momentsOf(a.epochs[e]), momentsOf(b.epochs[e]));
    const Intrinsics off = a.epochs[e].lens.parameters() - b.epochs[e].lens.parameters();
    for (Eigen::Index i = 0; i < off.size(); ++i) {
      const double sigma = std::sqrt(a.epochs[e].solution.covariance(i, i));
      EXPECT_LT(std::abs(off(i)), 0.1 * sigma) << "parameter " << i << " of epoch " << e;
      EXPECT_NEAR(std::sqrt(b.epochs[e].solution.covariance(i, i)), sigma, 0.1 * sigma);
    }
  }
}

const CameraResult& atOnce() {
  static const CameraResult result = mergeInto(fleet().folder / "at_once", fleet().files);
  return result;
}

TEST(Merge, TheRefocusIsFoundAndBothLensesAreNearTheTruth) {
  const CameraResult& result = atOnce();
  ASSERT_EQ(result.epochs.size(), 2u);
  EXPECT_EQ(result.history.changes[0].first, 3u);
  for (std::size_t e = 0; e < 2; ++e) {
    const EpochResult& epoch = result.epochs[e];
    ASSERT_TRUE(epoch.solved);
    EXPECT_EQ(epoch.solution.segments.size(), 5u);
    const Intrinsics off = epoch.lens.parameters() - lensOf(e == 0 ? 1.0 : 1.03).parameters();
    for (Eigen::Index i = 0; i < off.size(); ++i) {
      EXPECT_LT(std::abs(off(i)), 3.5 * std::sqrt(epoch.solution.covariance(i, i)));
    }
  }
  EXPECT_EQ(verdictOf(result), CameraVerdict::kChanged);
  EXPECT_NE(sentenceOf(result).find("changed between"), std::string::npos);
}

TEST(Merge, IsBetterThanTheBagsByWhatTheInformationPromises) {
  double best = 1e9;
  for (const HistoricBag& bag : atOnce().history.bags) {
    best = std::min(best, bag.record.uncertainty_px);
  }
  EXPECT_LT(atOnce().present().solution.uncertainty_px, best);
}

// The same queues, and the same estimate to a tenth of a sigma, in whatever order.
TEST(Merge, IsAssociative) {
  const std::vector<std::string>& f = fleet().files;
  const auto in = [](const std::string& name) { return fleet().folder / name; };
  // One after the other, a bag a day.
  std::vector<std::string> chain = {f[0]};
  for (std::size_t i = 1; i < f.size(); ++i) {
    chain.push_back(f[i]);
    const std::string folder = in("chain" + std::to_string(i));
    const CameraResult result = mergeInto(folder, chain);
    if (i + 1 == f.size()) expectSame(atOnce(), result);
    chain = statesIn(folder);
  }
  // A tree whose branches mix days before and after the change.
  mergeInto(in("odd"), {f[5], f[1], f[3]});
  mergeInto(in("even"), {f[4], f[0], f[2]});
  std::vector<std::string> branches = statesIn(in("even"));
  for (const std::string& file : statesIn(in("odd"))) branches.push_back(file);
  expectSame(atOnce(), mergeInto(in("tree"), branches));
  // Once more with itself.
  std::vector<std::string> twice = statesIn(in("at_once"));
  twice.insert(twice.end(), f.begin(), f.end());
  expectSame(atOnce(), mergeInto(in("twice"), twice));
}

TEST(Merge, GoesOnWhenTheStatesOfBagsAreGoneAndSaysWhatIsMissing) {
  const TemporaryFolder folder;
  std::vector<std::string> copies;
  for (int i = 0; i < 3; ++i) {
    copies.push_back(folder / ("copy" + std::to_string(i) + ".state"));
    fs::copy_file(fleet().files[static_cast<std::size_t>(i)], copies.back());
  }
  const CameraResult before = mergeInto(folder / "before", copies);
  for (const std::string& copy : copies) fs::remove(copy);
  const CameraResult after = mergeInto(folder / "after", statesIn(folder / "before"));
  expectSame(before, after);
  EXPECT_EQ(after.present().solution.missing, 0) << "the best are in the merged state";
  std::vector<std::string> more = statesIn(folder / "before");
  MergeOptions options;
  options.queue_segments = 8;
  StateCollection read = readStates(more);
  const auto histories = historiesOf(std::move(read.records), read.store, 0.01);
  const EpochSolution wider = solveEpoch(histories.at(0), 0, read.store, options);
  ASSERT_TRUE(wider.learnt);
  EXPECT_EQ(wider.segments.size(), 5u);
  EXPECT_EQ(wider.missing, 4);
}

TEST(Merge, AMergedStateIsOneThatARobotCanStartFrom) {
  const DecodedState decoded = readStateFile(fleet().folder / "at_once/robot/front.state");
  ASSERT_TRUE(atOnce().present().solved);
  ASSERT_TRUE(decoded.state) << decoded.error;
  EXPECT_TRUE(solveState(*decoded.state).queue.solution().usable);
  EXPECT_EQ(decoded.state->bags.size(), 3u);
  const Camera file = readCalibrationFile(fleet().folder / "at_once/robot/front.yaml");
  EXPECT_LT((file.parameters().head(4) - decoded.state->camera.parameters()).norm(), 1e-9);
}

TEST(Merge, FilesOfEarlierRunsGoOnceTheNewOnesAreThere) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "robot");
  const std::vector<std::string> stale = {"front.epoch1.yaml", "front.epoch2.yaml",
                                          "front.epoch7.state"};
  const std::vector<std::string> others = {"front.epochs.yaml", "front2.state", "front.epoch.yaml"};
  for (const auto& names : {stale, others}) {
    for (const std::string& name : names) std::ofstream(folder / ("robot/" + name)) << "earlier";
  }
  mergeInto(folder.string(), {fleet().files[0], fleet().files[1]});
  EXPECT_TRUE(fs::exists(folder / "robot/front.state"));
  for (const std::string& name : stale)
    EXPECT_FALSE(fs::exists(folder / ("robot/" + name))) << name;
  for (const std::string& name : others)
    EXPECT_TRUE(fs::exists(folder / ("robot/" + name))) << name;
}

TEST(Merge, WithoutASolutionTheEarlierStatesStay) {
  const TemporaryFolder folder;
  StateCollection read = readStates({fleet().files[0]});
  // No file has the segments any more.
  read.records[0].state_file = folder / "gone.state";
  const CameraHistory history = historiesOf(read.records, SegmentStore(), 0.01).at(0);
  for (const char* name : {"front.state", "front.epoch1.state"}) {
    fs::create_directories(folder / "robot");
    fs::copy_file(fleet().files[1], folder / ("robot/" + std::string(name)));
  }
  const CameraResult result = writeCamera(history, SegmentStore(), MergeOptions(), folder.string());
  EXPECT_FALSE(result.present().solved);
  writeFleet({result}, folder.string());
  EXPECT_NE(readFile(folder / "fleet.json").bytes.find("\"pixel_uncertainty_rms\": null"),
            std::string::npos);
  for (const char* name : {"front.state", "front.epoch1.state"}) {
    EXPECT_TRUE(readStateFile(folder / ("robot/" + std::string(name))).state) << name;
  }
}

// A k3 that is held is in the lens, but not estimated.
TEST(Merge, TheHistoryNamesAsManyValuesAsItHas) {
  const TemporaryFolder folder;
  BagRecord record = stateOn(0, 1.0).bags[0];
  record.lens = camera640(CameraModel::kRadtan, {420, 418, 322, 238, -0.2, 0.05, 0, 0, 0.01});
  record.covariance = 0.01 * IntrinsicsMatrix::Identity(8, 8);
  ASSERT_EQ(record.lens.estimatedCount(), 8);
  const CameraHistory history = historiesOf({record}, SegmentStore(), 0.01).at(0);
  writeCamera(history, SegmentStore(), MergeOptions(), folder.string());
  std::ifstream file(folder / "robot/front.history.csv");
  std::string header, row;
  ASSERT_TRUE(std::getline(file, header) && std::getline(file, row));
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ','))
      << header << '\n'
      << row;
  EXPECT_EQ(header.find("k3"), std::string::npos);
}

// Two videos, the segments of which cover the same moments.
TEST(Merge, OverlapInTimeIsSaidAndSegmentsOfAnotherVideoAreNotTaken) {
  const TemporaryFolder folder;
  std::vector<std::string> files;
  for (const int video : {0, 1}) {
    LearntState state = stateOn(0, 1.0);
    state.bags[0].bag = "day" + std::to_string(video) + ".bag";
    files.push_back(folder / ("video" + std::to_string(video) + ".state"));
    writeState(files.back(), state);
  }
  const CameraResult both = mergeInto(folder / "both", files);
  EXPECT_EQ(both.history.bags.size(), 2u);
  EXPECT_NE(sentenceOf(both).find("day1.bag with day0.bag"), std::string::npos) << sentenceOf(both);
  EXPECT_EQ(sentenceOf(atOnce()).find("overlap"), std::string::npos);
  const StateCollection read = readStates({files[1], folder / "both/robot/front.state"});
  const CameraHistory history = historiesOf(read.records, read.store, 0.01).at(0);
  ASSERT_EQ(history.bags.size(), 2u);
  const BagRecord& first = history.bags[0].record;
  fs::remove(files[0]);
  std::vector<std::size_t> lost;
  const WantedSegment gone{first.segments[0], 0, first.bag, first.state_file};
  EXPECT_TRUE(read.store.load("robot/front", {gone}, &lost).empty());
  const WantedSegment replaced{first.segments[0], 0, first.bag, files[1]};
  EXPECT_TRUE(read.store.load("robot/front", {replaced}, &lost).empty());
  const BagRecord& second = history.bags[1].record;
  const WantedSegment there{second.segments[0], 1, second.bag, second.state_file};
  EXPECT_EQ(read.store.load("robot/front", {there}, &lost).size(), 1u);
}

TEST(Merge, ACalibrationThatOnlyApproximatesTheLensIsSaid) {
  CameraResult result = atOnce();
  for (const EpochResult& epoch : result.epochs) EXPECT_EQ(epoch.approximation, "") << "a pinhole";
  result.epochs[0].approximation = "front.epoch1.yaml holds an approximation.";
  EXPECT_NE(sentenceOf(result).find(" front.epoch1.yaml holds an approximation."),
            std::string::npos);
}

TEST(Merge, APageTellsAll) {
  const std::string page = fleetHtml({atOnce()}, {"hang.bag (rear): failed: no end after 60 s"});
  for (const char* words : {"robot/front", "CHANGED", "day1.bag", "hang.bag", "<figure><svg"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
}

TEST(Merge, NamesOfCamerasBecomeFilesThatStayInTheFolder) {
  EXPECT_EQ(fileStem("robot7/front"), "robot7/front");
  EXPECT_EQ(fileStem("/camera/image_raw"), "camera/image_raw");
  EXPECT_EQ(fileStem("../../etc/x y"), "_./_./etc/x_y");
  EXPECT_EQ(fileStem("/"), "camera");
}

TEST(Merge, TimesAreReadableOnAnyClock) {
  EXPECT_EQ(timeText(1700000000LL * 1000000000LL), "2023-11-14 22:13 UTC");
  EXPECT_EQ(timeText(12300000000LL), "12.3 s");
}

int exitCode(const std::string& arguments) {
  const std::string command =
      std::string(MERGE_CALIBRATIONS) + " " + arguments + " > /dev/null 2>&1";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(MergeCalibrations, DamagedFilesAreLeftOutAndTheRestIsMerged) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "states");
  fs::copy_file(fleet().files[0], folder / "states/a.state");
  fs::copy_file(fleet().files[1], folder / "states/b.state");
  fs::resize_file(folder / "states/b.state", 1000);
  EXPECT_EQ(exitCode((folder / "states") + " --out " + (folder / "out")), 0);
  EXPECT_TRUE(fs::exists(folder / "out/fleet.html"));
  EXPECT_TRUE(fs::exists(folder / "out/fleet.json"));
  EXPECT_TRUE(fs::exists(folder / "out/robot/front.history.csv"));
  EXPECT_EQ(exitCode((folder / "states/b.state") + " --out " + (folder / "none")), 3);
  EXPECT_EQ(exitCode("--out " + (folder / "none")), 1);
  EXPECT_EQ(exitCode("--threads=%value%"), 1);
}

TEST(MergeCalibrations, RefusesToReplaceTheStateOfABagButReplacesMergedOnes) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "states/robot");
  fs::copy_file(fleet().files[0], folder / "states/robot/front.state");
  fs::copy_file(fleet().files[1], folder / "states/b.state");
  const std::string states = folder / "states";
  const std::string before = readFile(folder / "states/robot/front.state").bytes;
  EXPECT_EQ(exitCode(states + " --out " + states), 1);
  EXPECT_EQ(readFile(folder / "states/robot/front.state").bytes, before);
  const std::string out = folder / "out";
  EXPECT_EQ(exitCode(states + " --out " + out), 0);
  EXPECT_EQ(exitCode(out + " " + states + " --out " + out), 0);
}

TEST(MergeCalibrations, FilesOfOthersStay) {
  const TemporaryFolder folder;
  const std::string states = fleet().files[0];
  for (const char* name : {"robot/front.yaml", "robot/front.state"}) {
    const std::string file = folder / ("out/" + std::string(name));
    fs::create_directories(fs::path(file).parent_path());
    std::ofstream(file) << "somebody's";
    EXPECT_EQ(exitCode(states + " --out " + (folder / "out")), 1) << name;
    EXPECT_EQ(readFile(file).bytes, "somebody's");
    fs::remove(file);
  }
  EXPECT_EQ(exitCode(states + " --out " + (folder / "out")), 0);
}

}  // namespace
}  // namespace camera_self_calibration
