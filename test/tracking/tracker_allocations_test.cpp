// Counts allocations: what an image needs is kept from one to the next.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <iostream>
#include <new>

#include "camera_self_calibration/tracking/harris.h"
#include "camera_self_calibration/tracking/patch_registration.h"
#include "camera_self_calibration/tracking/tracker.h"
#include "tracking/textured_box.h"

namespace {

std::atomic<long> allocations{0};

}  // namespace

// Those of all libraries in this program.
void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace camera_self_calibration {
namespace {

template <typename Work>
long allocationsOf(const Work& work) {
  const long before = allocations;
  work();
  return allocations - before;
}

TestImage someImage(std::uint64_t noise_seed) {
  static const BoxRenderer renderer(TexturedBox(3),
                                    Camera::defaultGuess(CameraModel::kPinhole, 320, 240), 1);
  std::mt19937_64 random(noise_seed);
  return renderer.render(Rigid3(), {}, &random);
}

TEST(Allocations, NoneByCornersAndRegistration) {
  const TestImage image = someImage(1);
  ImagePyramid pyramid;
  pyramid.build(image.view());
  HarrisDetector detector;
  const std::vector<Corner> corners = detector.detect(pyramid, 20, 25);
  ASSERT_GT(corners.size(), 20u);
  EXPECT_EQ(allocationsOf([&] { detector.detect(pyramid, 20, 25); }), 0);

  PatchRegistration registration;
  ReferencePatch patch;
  patch.cut(pyramid.level(0), corners[0].x, corners[0].y);
  ASSERT_TRUE(registration.prepare(&patch));
  Warp start;
  start.pixel = Eigen::Vector2d(corners[0].x + 0.5, corners[0].y - 0.5);
  EXPECT_EQ(allocationsOf([&] {
              EXPECT_EQ(registration.run(&patch, pyramid, start).status,
                        Registration::Status::kGood);
            }),
            0);
}

// What is left is OpenCV's: a few for the pyramid, a few for the threads. One of ours for each
// track would show.
TEST(Allocations, OfAnImageDoNotGrowWithTheTracks) {
  const TestImage first = someImage(1), second = someImage(2);
  for (const int features : {30, 120}) {
    TrackerOptions options;
    options.max_features = features;
    Tracker tracker(options);
    tracker.track(first.view());
    ASSERT_GT(tracker.detect().size(), static_cast<std::size_t>(features) / 2);
    for (int i = 0; i < 4; ++i) tracker.track((i % 2 ? first : second).view());
    for (int i = 0; i < 3; ++i) {
      const TestImage& image = i % 2 ? first : second;
      std::size_t tracks = 0;
      const long count = allocationsOf([&] { tracks = tracker.track(image.view()).tracks.size(); });
      std::cout << tracks << " tracks: " << count << " allocations\n";
      EXPECT_LE(count, 15);
    }
  }
}

}  // namespace
}  // namespace camera_self_calibration
