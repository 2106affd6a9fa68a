#include "camera_self_calibration/simulation/feature_tracks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kFrame = 50000000;  // [ns]

Camera fovCamera() {
  Intrinsics parameters(5);
  parameters << 311.2, 309.8, 327.4, 233.1, 0.93;
  return Camera(CameraModel::kFov, 640, 480, parameters);
}

FeatureTracks makeTracks(const FeatureTracksOptions& options,
                         const Lens& lens = {fovCamera(), {}, 1.0}) {
  return FeatureTracks(makeRoom(RoomOptions()), lens, syntheticMotion(SyntheticMotionOptions()),
                       options);
}

TEST(FeatureTracks, PixelsAreProjectionsOfTheirPoints) {
  FeatureTracksOptions options;
  options.pixel_sigma = 0.0;
  options.start_stamp_ns = 1700000000000000000;
  FeatureTracks tracks = makeTracks(options);
  int checked = 0;
  for (int i = 0; i < 60; ++i) {
    const std::int64_t stamp = options.start_stamp_ns + i * kFrame;
    const TrackedFrame frame = tracks.track(stamp);
    EXPECT_EQ(frame.stamp_ns, stamp);
    EXPECT_EQ(frame.width, 640);
    std::vector<Track> all = frame.tracks;
    for (const Track& track : tracks.detect()) {
      EXPECT_EQ(track.pixel, track.reference_pixel);
      all.push_back(track);
    }
    for (const Track& track : all) {
      Eigen::Vector2d pixel;
      ASSERT_TRUE(tracks.point(track.id));
      ASSERT_TRUE(tracks.cameraAt(stamp).project(
          tracks.worldFromCamera(stamp).inverse() * *tracks.point(track.id), &pixel));
      EXPECT_LT((pixel - track.pixel).norm(), 1e-6);
      ++checked;
    }
  }
  EXPECT_GT(checked, 60 * 100);
}

TEST(FeatureTracks, NoiseHasTheSigmaAskedFor) {
  FeatureTracksOptions options;
  options.pixel_sigma = 0.4;
  FeatureTracks tracks = makeTracks(options);
  double sum = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  int count = 0;
  for (int i = 0; i < 200; ++i) {
    for (const Track& track : tracks.track(i * kFrame).tracks) {
      EXPECT_EQ(track.sigma, 0.4);
      const auto truth = tracks.project(*tracks.point(track.id), 1e-9 * i * kFrame);
      ASSERT_TRUE(truth);
      sum += (track.pixel - *truth).squaredNorm();
      mean += track.pixel - *truth;
      ++count;
    }
    tracks.detect();
  }
  ASSERT_GT(count, 10000);
  EXPECT_NEAR(std::sqrt(sum / (2 * count)), 0.4, 0.01);
  EXPECT_LT((mean / count).norm(), 0.01);
}

TEST(FeatureTracks, FillsUpSpreadsOutAndDrops) {
  FeatureTracksOptions options;
  options.max_features = 60;
  FeatureTracks tracks = makeTracks(options);
  EXPECT_TRUE(tracks.detect().empty()) << "nothing can start before the first frame";
  EXPECT_TRUE(tracks.track(0).tracks.empty());
  const std::vector<Track> started = tracks.detect();
  EXPECT_EQ(started.size(), 60u);
  for (std::size_t i = 0; i < started.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GT((started[i].pixel - started[j].pixel).norm(), 30.0);
    }
  }
  EXPECT_TRUE(tracks.detect().empty());
  tracks.drop({started[3].id, started[5].id, 123456});
  std::set<std::int64_t> live;
  for (const Track& track : tracks.track(kFrame).tracks) live.insert(track.id);
  EXPECT_GT(live.size(), 50u);
  EXPECT_EQ(live.count(started[3].id) + live.count(started[5].id), 0u);
  tracks.reset();
  EXPECT_TRUE(tracks.track(2 * kFrame).tracks.empty());
}

TEST(FeatureTracks, NewIdsAreNeverOldOnes) {
  FeatureTracks tracks = makeTracks(FeatureTracksOptions());
  std::set<std::int64_t> seen;
  for (int i = 0; i < 100; ++i) {
    tracks.track(i * kFrame);
    for (const Track& track : tracks.detect()) EXPECT_TRUE(seen.insert(track.id).second);
  }
  EXPECT_GT(seen.size(), 200u);
}

TEST(FeatureTracks, OutliersAreMarkedAndOfTheShareAskedFor) {
  FeatureTracksOptions options;
  options.outlier_share = 0.05;
  FeatureTracks tracks = makeTracks(options);
  int outliers = 0;
  int all = 0;
  for (int i = 0; i < 200; ++i) {
    for (const Track& track : tracks.track(i * kFrame).tracks) {
      const double error =
          (track.pixel - *tracks.project(*tracks.point(track.id), 1e-9 * i * kFrame)).norm();
      EXPECT_EQ(error > 1.5, tracks.isOutlier(track.id));
      outliers += tracks.isOutlier(track.id) ? 1 : 0;
      ++all;
    }
    tracks.detect();
  }
  EXPECT_NEAR(static_cast<double>(outliers) / all, 0.05, 0.01);
}

TEST(FeatureTracks, HiddenPointsEndTheirTracks) {
  FeatureTracksOptions options;
  options.loss_probability = 0.0;
  FeatureTracks with = makeTracks(options);
  options.occlusion = false;
  FeatureTracks without = makeTracks(options);
  std::size_t hidden = 0;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t stamp = i * kFrame;
    for (FeatureTracks* tracks : {&with, &without}) {
      tracks->track(stamp);
      if (i % 10 == 0) tracks->detect();
    }
    const World room = makeRoom(RoomOptions());
    const Eigen::Vector3d eye = with.worldFromCamera(stamp).translation;
    for (const Track& track : with.track(stamp).tracks) {
      EXPECT_TRUE(room.visible(eye, *with.point(track.id)));
    }
    for (const Track& track : without.track(stamp).tracks) {
      hidden += room.visible(eye, *without.point(track.id)) ? 0 : 1;
    }
  }
  EXPECT_GT(hidden, 20u) << "furniture must hide something, or this test shows nothing";
}

TEST(FeatureTracks, NoisyAnchorsDifferFromTheirPoints) {
  FeatureTracksOptions options;
  options.reference_sigma = 0.5;
  FeatureTracks tracks = makeTracks(options);
  tracks.track(0);
  double sum = 0.0;
  const std::vector<Track> started = tracks.detect();
  for (const Track& track : started) {
    Eigen::Vector2d truth;
    ASSERT_TRUE(
        fovCamera().project(tracks.worldFromCamera(0).inverse() * *tracks.point(track.id), &truth));
    sum += (track.reference_pixel - truth).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(sum / (2.0 * static_cast<double>(started.size()))), 0.5, 0.1);
}

TEST(FeatureTracks, DriftingTracksSlideAway) {
  FeatureTracksOptions options;
  options.drifting_share = 1.0;
  options.loss_probability = 0.0;
  FeatureTracks tracks = makeTracks(options);
  tracks.track(0);
  tracks.detect();
  int checked = 0;
  for (int i = 1; i <= 5; ++i) {
    for (const Track& track : tracks.track(i * kFrame).tracks) {
      const auto truth = tracks.project(*tracks.point(track.id), 1e-9 * i * kFrame);
      EXPECT_TRUE(tracks.isOutlier(track.id));
      EXPECT_GT((track.pixel - *truth).norm(), i - 1.0);
      ++checked;
    }
  }
  EXPECT_GT(checked, 200);
}

TEST(FeatureTracks, ZoomAndRollingShutterMovePixels) {
  FeatureTracksOptions options;
  FeatureTracks plain = makeTracks(options);
  FeatureTracks zoomed = makeTracks(options, {fovCamera(), 2.0, 1.1});
  EXPECT_NEAR(zoomed.cameraAt(1999999999).parameters()[0], 311.2, 1e-9);
  EXPECT_NEAR(zoomed.cameraAt(2000000000).parameters()[0], 342.32, 1e-9);
  options.line_delay_s = 6e-5;
  FeatureTracks rolling = makeTracks(options);
  plain.track(2 * kFrame);
  double moved_by_zoom = 0.0;
  for (const Track& track : plain.detect()) {
    const Eigen::Vector3d point = *plain.point(track.id);
    const auto a = plain.project(point, 2.1);
    const auto b = zoomed.project(point, 2.1);
    if (a && b) moved_by_zoom = std::max(moved_by_zoom, (*b - *a).norm());
    const auto c = rolling.project(point, 2.1);
    if (!c) continue;
    const auto row_late = plain.project(point, 2.1 + c->y() * options.line_delay_s);
    ASSERT_TRUE(row_late);
    EXPECT_LT((*row_late - *c).norm(), 1e-3);
  }
  EXPECT_GT(moved_by_zoom, 10.0);
}

TEST(FeatureTracks, FollowTheirSeed) {
  const auto run = [](std::uint64_t seed) {
    FeatureTracksOptions options;
    options.seed = seed;
    FeatureTracks tracks = makeTracks(options);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int i = 0; i < 20; ++i) {
      for (const Track& track : tracks.track(i * kFrame).tracks) sum += track.pixel;
      tracks.detect();
    }
    return sum;
  };
  EXPECT_EQ(run(7), run(7));
  EXPECT_NE(run(7), run(8));
}

TEST(FeatureTracks, RefusesImpossibleOptions) {
  FeatureTracksOptions options;
  options.max_features = 0;
  options.outlier_share = 2.0;
  options.pixel_sigma = -1.0;
  EXPECT_EQ(options.problems().size(), 3u);
  EXPECT_THROW(makeTracks(options), std::invalid_argument);
  EXPECT_THROW(makeTracks(FeatureTracksOptions(), Lens()), std::invalid_argument);
}

}  // namespace
}  // namespace camera_self_calibration
