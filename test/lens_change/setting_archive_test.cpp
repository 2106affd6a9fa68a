#include "camera_self_calibration/lens_change/setting_archive.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lens_change/change_samples.h"

namespace camera_self_calibration {
namespace {

// A queue of two segments that were seen through the lens.
SegmentQueue queueOf(const Camera& lens) {
  SegmentQueue queue = roomyQueue();
  EXPECT_EQ(queue.offer({candidateOf(lens, lens, 1), candidateOf(lens, lens, 2)}, {lens}), 2);
  EXPECT_TRUE(queue.solution().usable);
  return queue;
}

const Camera& lens() {
  static const Camera lens = ordinaryCameras()[1];
  return lens;
}

const SegmentQueue& plain() {
  static const SegmentQueue queue = queueOf(lens());
  return queue;
}

// The lens of a queue, with its focal length so many of its sigmas longer.
Camera longer(const QueueSolution& solution, double sigmas) {
  Intrinsics parameters = solution.camera.parameters();
  parameters(0) += sigmas * std::sqrt(1.0 / solution.information(0, 0));
  return withParameters(solution.camera, parameters);
}

TEST(SettingArchive, RecallsTheSettingThatReturned) {
  SettingArchive archive;
  archive.store({3, plain()});
  archive.store({4, queueOf(zoomed(lens(), 1.1))});
  const QueueSolution& solution = plain().solution();
  const Camera near = longer(solution, 1.0);
  const auto found = archive.recall(near, solution.information, {}, 1.0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->epoch, 3u);
  EXPECT_EQ(found->queue.candidates().size(), 2u);
  EXPECT_EQ(found->queue.solution().camera.parameters(), solution.camera.parameters());
  EXPECT_FALSE(archive.recall(near, solution.information, {}, 1.0)) << "taken out";
}

TEST(SettingArchive, NeverTakesAnotherSettingForIt) {
  SettingArchive archive;
  archive.store({3, plain()});
  const QueueSolution& solution = plain().solution();
  // Near over the image, but many sigmas away; and far, but not known to be.
  const Camera near = longer(solution, 10.0);
  ASSERT_LT(pixelDistance(near, solution.camera).rms, 4.0);
  EXPECT_FALSE(archive.recall(near, solution.information, {}, 4.0));
  EXPECT_FALSE(archive.recall(zoomed(lens(), 1.05), 1e-6 * solution.information, {}, 1.0));
}

TEST(SettingArchive, StaysBounded) {
  constexpr int kLenses = 6;
  std::vector<SegmentQueue> queues;
  for (int i = 0; i < kLenses; ++i) queues.push_back(queueOf(zoomed(lens(), 1.0 + 0.05 * i)));
  SettingArchive archive;
  for (std::uint64_t epoch = 0; epoch < 100; ++epoch) {
    archive.store({epoch, queues[epoch % kLenses]});
  }
  int kept = 0;
  for (const SegmentQueue& queue : queues) {
    const QueueSolution& solution = queue.solution();
    kept += archive.recall(solution.camera, solution.information, {}, 0.5).has_value();
  }
  EXPECT_EQ(kept, 4);
}

TEST(SettingArchive, KeepsNoQueueWithoutASolution) {
  SettingArchive archive;
  archive.store({1, roomyQueue()});
  const QueueSolution& solution = plain().solution();
  EXPECT_FALSE(archive.recall(lens(), solution.information, {}, 1e9));
}

}  // namespace
}  // namespace camera_self_calibration
