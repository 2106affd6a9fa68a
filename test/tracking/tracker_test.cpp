#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/geometry/so3.h"
#include "tracking/track_errors.h"

namespace camera_self_calibration {
namespace {

Camera smallCamera() {
  Intrinsics parameters(4);
  parameters << 200.0, 200.0, 159.5, 119.5;
  return Camera(CameraModel::kPinhole, 320, 240, parameters);
}

const BoxRenderer& renderer() {
  static const BoxRenderer box_renderer(TexturedBox(3), smallCamera(), 4);
  return box_renderer;
}

TestImage still(std::uint64_t noise_seed) {
  std::mt19937_64 random(noise_seed);
  return renderer().render(Rigid3(), {}, &random);
}

// Detected in the first image only.
BoxSequence once(int images) {
  BoxSequence options;
  options.images = images;
  options.detect_every = images;
  return options;
}

std::vector<double> errorsInImage(const std::vector<TrackSample>& samples, int image) {
  std::vector<double> errors;
  for (const TrackSample& sample : samples) {
    if (sample.image == image && !sample.hidden) errors.push_back(sample.error.norm());
  }
  return errors;
}

TEST(Tracker, FollowsThroughChangesOfBrightness) {
  BoxSequence options = once(12);
  options.world_from_camera = [](int i) {
    return Rigid3(expSo3({0.002 * i, 0.003 * i, 0.0}), {0.005 * i, 0.0, 0.0});
  };
  options.photometry = [](int i) {
    BoxRenderer::Photometry photometry;
    photometry.gain = 1.0 - 0.04 * i;
    photometry.offset = 2.0 * i;
    return photometry;
  };
  const auto samples = trackSequence(renderer(), options);
  const auto first = errorsInImage(samples, 1), last = errorsInImage(samples, 11);
  EXPECT_GT(last.size(), first.size() * 7 / 10);
  EXPECT_LT(medianOf(last), 0.05);
}

TEST(Tracker, FollowsThroughATurnOfTheCamera) {
  BoxSequence options = once(31);
  options.world_from_camera = [](int i) {
    return Rigid3(expSo3({0.0, 0.0, i * 3.0 * kDegree}), Eigen::Vector3d::Zero());
  };
  const auto errors = errorsInImage(trackSequence(renderer(), options), 30);
  EXPECT_GT(errors.size(), 20u);
  EXPECT_LT(medianOf(errors), 0.05);
}

TEST(Tracker, FollowsThroughChangesOfScale) {
  for (const double speed : {0.045, -0.05}) {  // [m per image] towards and away from the wall.
    BoxSequence options = once(21);
    options.world_from_camera = [speed](int i) {
      return Rigid3(Eigen::Quaterniond::Identity(), {0.0, 0.0, speed * i});
    };
    const auto errors = errorsInImage(trackSequence(renderer(), options), 20);
    std::printf("scale %.2f: %zu tracks, median error %.3f px\n", 2.0 / (2.0 - 20 * speed),
                errors.size(), medianOf(errors));
    EXPECT_GT(errors.size(), 20u) << speed;
    EXPECT_LT(medianOf(errors), 0.06) << speed;
  }
}

TEST(Tracker, EndsTracksThatAreCovered) {
  TexturedBox box(3);
  const BoxRenderer uncovered(box, smallCamera(), 3);
  box.setCard({0.0, 0.0, 1.2}, 0.3);
  const BoxRenderer covered(box, smallCamera(), 3);
  std::mt19937_64 random(1);
  Tracker tracker{TrackerOptions()};
  tracker.track(uncovered.render(Rigid3(), {}, &random).view());
  ASSERT_GT(tracker.detect().size(), 80u);
  std::size_t before = 0, after = 0, inside = 0;
  for (const Track& track : tracker.track(uncovered.render(Rigid3(), {}, &random).view()).tracks) {
    ++before;
    inside += (track.pixel - Eigen::Vector2d(159.5, 119.5)).lpNorm<Eigen::Infinity>() < 50.0;
  }
  ASSERT_GT(inside, 8u);
  for (const Track& track : tracker.track(covered.render(Rigid3(), {}, &random).view()).tracks) {
    ++after;
    EXPECT_GT((track.pixel - Eigen::Vector2d(159.5, 119.5)).lpNorm<Eigen::Infinity>(), 45.0);
  }
  EXPECT_GT(after, (before - inside) * 8 / 10);
}

// Something passes in front of a part of the image for some images.
TEST(Tracker, FindsCoveredTracksAgain) {
  const auto covered = [](int image) { return image >= 4 && image < 7; };
  Tracker tracker{TrackerOptions()};
  std::set<std::int64_t> before, after;
  for (int i = 0; i < 9; ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 1);
    const Rigid3 pose(expSo3({0.0, 0.004 * i, 0.0}), {0.004 * i, 0.0, 0.0});
    TestImage image = renderer().render(pose, {}, &random);
    for (int y = 0; covered(i) && y < image.height; ++y) {
      std::fill_n(image.pixels.begin() + y * image.width + 60, 120, std::uint8_t{128});
    }
    for (const Track& track : tracker.track(image.view(i)).tracks) {
      const bool behind = track.pixel.x() > 72.0 && track.pixel.x() < 168.0;
      EXPECT_FALSE(behind && covered(i)) << i;
      if (behind && i == 3) before.insert(track.id);
      if (i == 8 && before.count(track.id) > 0) after.insert(track.id);
    }
    if (i == 0) {
      ASSERT_GT(tracker.detect().size(), 60u);
    }
  }
  ASSERT_GT(before.size(), 10u);
  EXPECT_GT(after.size(), before.size() * 7 / 10);
}

// A camera that turns slowly, and elsewhere in some images; detected in the first one only.
struct Interrupted {
  Tracker tracker{TrackerOptions()};
  std::mt19937_64 random{1};
  std::size_t detected = 0;
  std::int64_t next = 0;

  Interrupted() {
    for (int i = 0; i < 5; ++i) track(false);
  }

  const TrackedFrame& track(bool elsewhere) {
    const Rigid3 pose(expSo3({0.0, elsewhere ? 2.0 : 0.004 * static_cast<double>(next), 0.0}),
                      Eigen::Vector3d::Zero());
    const TrackedFrame& frame = tracker.track(renderer().render(pose, {}, &random).view(next));
    if (next == 0) detected = tracker.detect().size();
    ++next;
    return frame;
  }
};

TEST(Tracker, LeavesOutImagesOfSomethingElse) {
  for (const int blink : {1, 3, 5}) {
    Interrupted run;
    ASSERT_GT(run.detected, 60u);
    for (int i = 0; i < blink; ++i) {
      const TrackedFrame& frame = run.track(true);
      EXPECT_TRUE(frame.unrelated);
      EXPECT_TRUE(frame.tracks.empty());
      EXPECT_EQ(frame.stamp_ns, run.next - 1);
      EXPECT_EQ(frame.width, 320);
      EXPECT_TRUE(run.tracker.detect().empty());
      EXPECT_TRUE(run.tracker.corners(10).empty());
    }
    for (int i = 0; i < 2; ++i) {
      const TrackedFrame& frame = run.track(false);
      EXPECT_FALSE(frame.unrelated);
      EXPECT_GT(frame.tracks.size(), run.detected * 8 / 10) << blink;
    }
  }
}

TEST(Tracker, BeginsAnewAfterACut) {
  Interrupted run;
  for (int i = 0; i < 6; ++i) EXPECT_TRUE(run.track(true).unrelated) << i;
  EXPECT_FALSE(run.track(true).unrelated);
  const std::size_t detected = run.tracker.detect().size();
  EXPECT_GT(detected, 60u);
  EXPECT_GT(run.track(true).tracks.size(), detected * 9 / 10);
}

// A part of the robot covers a corner of the image.
TEST(Tracker, LeavesOutWhatTheCameraCarries) {
  const auto onTheRobot = [](const Eigen::Vector2d& pixel) {
    return pixel.x() < 120.0 && pixel.y() > 120.0;
  };
  const TestImage robot = still(99);
  const auto seen = [&robot](int i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 1);
    const Rigid3 turned(expSo3({0.0, 0.02 * i, 0.0}), Eigen::Vector3d::Zero());
    TestImage image = renderer().render(turned, {}, &random);
    for (int y = 120; y < image.height; ++y) {
      std::copy_n(robot.pixels.begin() + y * image.width, 120,
                  image.pixels.begin() + y * image.width);
    }
    return image;
  };
  Tracker tracker{TrackerOptions()};
  std::size_t at_first = 0, at_last = 0, carried = 0, scene = 0;
  for (int i = 0; i < 30; ++i) {
    const TestImage image = seen(i);
    const TrackedFrame& frame = tracker.track(image.view(i));
    carried += frame.carried.size();
    for (const Track& track : tracker.detect()) {
      if (i == 0) at_first += onTheRobot(track.pixel);
    }
    if (i < 29) continue;
    for (const Track& track : frame.tracks) {
      (onTheRobot(track.pixel) ? at_last : scene) += 1;
    }
  }
  std::printf(
      "on the robot: %zu tracks at first, %zu in the end, %zu found out; of the scene %zu\n",
      at_first, at_last, carried, scene);
  EXPECT_GT(at_first, 10u);
  EXPECT_GT(carried, at_first * 9 / 10);
  EXPECT_LT(at_last, 3u);
  EXPECT_GT(scene, 60u);
  // Tracking that begins again still knows those places.
  tracker.reset();
  Tracker unknowing{TrackerOptions()};
  const auto onTheRobotIn = [&](Tracker* another) {
    another->track(seen(30).view(30));
    const std::vector<Track> tracks = another->detect();
    return std::count_if(tracks.begin(), tracks.end(),
                         [&](const Track& track) { return onTheRobot(track.pixel); });
  };
  const auto again = onTheRobotIn(&tracker);
  EXPECT_LT(2 * again, onTheRobotIn(&unknowing)) << again;
}

// What is in one image alone, such as noise, begins no track.
TEST(Tracker, BeginsNoTrackThatTheImageBeforeDoesNotShow) {
  TrackerOptions options;
  options.max_features = 1000;  // More than there are corners.
  Tracker tracker(options);
  tracker.track(still(1).view(0));
  TestImage image = still(2);
  const auto strange = [](const Eigen::Vector2d& pixel) {
    return pixel.x() > 100.0 && pixel.x() < 200.0 && pixel.y() > 70.0 && pixel.y() < 170.0;
  };
  const TestImage other = image;
  for (int y = 60; y < 180; ++y) {
    std::copy_n(other.pixels.begin() + (y + 55) * image.width + 10, 120,
                image.pixels.begin() + y * image.width + 90);
  }
  tracker.track(image.view(1));
  std::size_t inside = 0;
  const std::vector<Track> started = tracker.detect();
  for (const Track& track : started) inside += strange(track.pixel);
  EXPECT_GT(started.size(), 20u);
  EXPECT_EQ(inside, 0u);
  tracker.track(image.view(2));
  inside = 0;
  for (const Track& track : tracker.detect()) inside += strange(track.pixel);
  EXPECT_GT(inside, 5u);
}

TEST(Tracker, GatesSilhouettes) {
  TexturedBox box(11);
  box.setCard({0.0, 0.0, 1.0}, 0.3);
  const BoxRenderer with_card(box, smallCamera(), 4);
  BoxSequence options = once(25);
  options.world_from_camera = [](int i) {
    return Rigid3(Eigen::Quaterniond::Identity(), {0.012 * i, 0.008 * i, 0.0});
  };
  const auto samples = trackSequence(with_card, options);
  const auto errors = errorsInImage(samples, 24);
  const auto wrong =
      std::count_if(errors.begin(), errors.end(), [](double error) { return error > 0.5; });
  std::printf("two depths: %zu tracks at the end, %ld off by more than 0.5 px\n", errors.size(),
              static_cast<long>(wrong));
  ASSERT_GT(errors.size(), 30u);
  EXPECT_LE(wrong, static_cast<long>(errors.size() / 20));
}

TEST(Tracker, SameImagesGiveTheSameTracks) {
  BoxSequence options;
  options.images = 8;
  options.detect_every = 3;
  options.world_from_camera = [](int i) {
    return handHeldPose(i, {0.1, 0.1, 0.1}, {0.1, 0.1, 0.1}, 30.0);
  };
  const auto a = trackSequence(renderer(), options), b = trackSequence(renderer(), options);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].id, b[i].id);
    EXPECT_EQ(a[i].error, b[i].error);
    EXPECT_EQ(a[i].sigma, b[i].sigma);
  }
}

TEST(Tracker, DetectionSpreadsOverTheImage) {
  TrackerOptions options;
  options.max_features = 48;
  Tracker tracker(options);
  const TestImage image = still(1);
  tracker.track(image.view());
  const std::vector<Track> tracks = tracker.detect();
  EXPECT_GT(tracks.size(), 40u);
  EXPECT_LE(tracks.size(), 48u);
  std::set<int> cells;
  for (const Track& track : tracks) {
    EXPECT_EQ(track.pixel, track.reference_pixel);
    EXPECT_GT(track.sigma, 0.0);
    cells.insert(static_cast<int>(track.pixel.y()) / 60 * 4 +
                 static_cast<int>(track.pixel.x()) / 80);
    for (const Track& other : tracks) {
      if (other.id == track.id) continue;
      EXPECT_GT((other.pixel - track.pixel).norm(), 0.4 * std::sqrt(320.0 * 240.0 / 48.0) - 1e-9);
    }
  }
  EXPECT_EQ(cells.size(), 16u);
  // Nothing is near the features that are there already.
  EXPECT_EQ(tracker.track(image.view()).tracks.size(), tracks.size());
  EXPECT_LE(tracker.detect().size(), 48u - tracks.size());
}

// A place is known again by what could be followed in it, be it followed or not.
TEST(Tracker, CornersAreWhereTracksWouldStart) {
  const TestImage image = still(4);
  Tracker tracker(TrackerOptions{});
  EXPECT_TRUE(tracker.corners(100).empty()) << "no image yet";
  tracker.track(image.view(0));
  EXPECT_EQ(tracker.corners(30).size(), 30u);
  const std::vector<Eigen::Vector2d> all = tracker.corners(100000);
  const std::vector<Track> started = tracker.detect();
  ASSERT_GT(started.size(), 50u);
  std::vector<double> distances;
  for (const Track& track : started) {
    double nearest = 100.0;
    for (const Eigen::Vector2d& pixel : all) {
      nearest = std::min(nearest, (pixel - track.pixel).norm());
    }
    distances.push_back(nearest);
  }
  EXPECT_LT(medianOf(distances), 1.5) << "a track is at the tip of its corner";
  const std::vector<Eigen::Vector2d> rest = tracker.corners(100000);
  EXPECT_LE(rest.size() + started.size(), all.size() + 5) << "those with a track are left out";
  EXPECT_GT(rest.size(), started.size());
}

TEST(Tracker, FindsNothingWhereNothingIs) {
  Tracker tracker{TrackerOptions()};
  TestImage image{320, 240, std::vector<std::uint8_t>(320 * 240, 90)};
  tracker.track(image.view());
  EXPECT_TRUE(tracker.detect().empty());
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(90.0, 1.0);
  for (std::uint8_t& pixel : image.pixels) {
    pixel = static_cast<std::uint8_t>(std::lround(normal(random)));
  }
  tracker.track(image.view());
  EXPECT_TRUE(tracker.detect().empty());
}

TEST(Tracker, TakesNoFeatureFromTheEdgeOfADarkField) {
  Tracker tracker{TrackerOptions()};
  TestImage image = still(1);
  const double radius = 100.0;
  const auto fromCentre = [](double x, double y) { return std::hypot(x - 160.0, y - 120.0); };
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      if (fromCentre(x, y) > radius) image.pixels[static_cast<std::size_t>(320 * y + x)] = 12;
    }
  }
  tracker.track(image.view());
  const std::vector<Track> tracks = tracker.detect();
  EXPECT_GT(tracks.size(), 20u);
  for (const Track& track : tracks) {
    EXPECT_LT(fromCentre(track.pixel.x(), track.pixel.y()), radius - 7.0);
  }
}

TEST(Tracker, AnotherSizeStartsOver) {
  Tracker tracker{TrackerOptions()};
  const TestImage image = still(1);
  tracker.track(image.view());
  const std::int64_t last_id = tracker.detect().back().id;
  const TestImage other{200, 150, std::vector<std::uint8_t>(200 * 150, 7)};
  EXPECT_TRUE(tracker.track(other.view()).tracks.empty());
  EXPECT_TRUE(tracker.track(image.view()).tracks.empty());
  EXPECT_GT(tracker.detect().front().id, last_id);
}

TEST(Tracker, SurvivesImagesThatAreNone) {
  Tracker tracker{TrackerOptions()};
  EXPECT_TRUE(tracker.detect().empty());
  EXPECT_TRUE(tracker.track(ImageView()).tracks.empty());
  const TestImage image = still(1);
  tracker.track(image.view());
  const std::size_t count = tracker.detect().size();
  ImageView broken = image.view(17);
  broken.stride = 10;
  EXPECT_TRUE(tracker.track(broken).tracks.empty());
  EXPECT_EQ(tracker.track(broken).stamp_ns, 17);
  EXPECT_TRUE(tracker.detect().empty());
  // The tracks wait for the next image.
  EXPECT_EQ(tracker.track(image.view()).tracks.size(), count);
  for (const int side : {1, 2, 15, 31}) {
    const TestImage tiny{side, side, std::vector<std::uint8_t>(2000, 100)};
    EXPECT_TRUE(tracker.track(tiny.view()).tracks.empty());
    EXPECT_TRUE(tracker.detect().empty());
  }
}

TEST(Tracker, DropsAndResets) {
  Tracker tracker{TrackerOptions()};
  const TestImage image = still(1);
  tracker.track(image.view());
  const std::vector<Track> tracks = tracker.detect();
  tracker.drop({tracks[1].id, tracks[4].id, 987654});
  const TrackedFrame& frame = tracker.track(image.view());
  EXPECT_EQ(frame.tracks.size(), tracks.size() - 2);
  for (const Track& track : frame.tracks) {
    EXPECT_NE(track.id, tracks[1].id);
    EXPECT_NE(track.id, tracks[4].id);
  }
  tracker.reset();
  EXPECT_TRUE(tracker.detect().empty());
  EXPECT_TRUE(tracker.track(image.view()).tracks.empty());
}

TEST(Tracker, OptionsNameEveryProblem) {
  EXPECT_TRUE(TrackerOptions().problems().empty());
  TrackerOptions options;
  options.max_features = 0;
  options.min_distance_px = -1.0;
  EXPECT_EQ(options.problems().size(), 2u);
  EXPECT_THROW(Tracker tracker(options), std::invalid_argument);
}

}  // namespace
}  // namespace camera_self_calibration
