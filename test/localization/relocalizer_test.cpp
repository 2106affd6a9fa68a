#include "camera_self_calibration/localization/relocalizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

const Camera kCamera = camera640(CameraModel::kFov, {320, 322, 316, 243, 0.95});
constexpr std::size_t kCapacity = 12;

// A map of random points, made by a camera that passes them. All that the camera sees is exact but
// for the noise of pixels and descriptors. Points of equal ids and scenes look the same.
struct Pass {
  Similarity3 map_from_scene;
  std::uint64_t scene = 1;
  std::int64_t first_track = 0;
  std::int64_t first_keyframe = 0;
  double noise_px = 0.5;
  double wrong_share = 0.0;  // of the points that look like others
  bool mirrored = false;
  int first_point = 0;
  int points = 100;
  bool shows_all = false;  // describes what it does not follow, too
  int keyframes = 8;
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();  // in the scene
};

class PassedMap {
 public:
  explicit PassedMap(const Pass& pass) : pass_(pass), map_(50), random_(pass.first_track + 7) {}

  // Shows the keyframes one by one; the last answer that was not empty.
  std::optional<Relocation> show(std::uint64_t map_id, Relocalizer* relocalizer) {
    std::optional<Relocation> result;
    for (int k = 0; k < pass_.keyframes; ++k) {
      const std::vector<Track> tracks = addKeyframe(k);
      const auto relocation = relocalizer->atKeyframe(
          map_id, map_, kCamera, tracks, true, [&](const std::vector<Track>& list, int corners) {
            return appearances(list, pass_.shows_all && corners > 0 ? k : -1);
          });
      if (relocation) {
        result = relocation;
        map_id = relocation->map_id;
        map_.move(relocation->old_from_new);
        moved_ = relocation->old_from_new;
      }
    }
    return result;
  }

  Rigid3 sceneFromCamera(int k) const {
    return {expSo3({0.02 * k, -0.03 * k, 0.01 * k}),
            pass_.begin + Eigen::Vector3d(0.08 * k, 0.03 * k, -0.02 * k)};
  }

 private:
  Eigen::Vector3d pointAt(int i) const {
    Random random(mixSeed(pass_.scene, static_cast<std::uint64_t>(i)));
    return {random.uniform(-2.5, 2.5), random.uniform(-2.0, 2.0), random.uniform(2.0, 6.0)};
  }

  std::optional<Eigen::Vector2d> pixelOf(int i, int k) const {
    Eigen::Vector2d pixel;
    if (!kCamera.project(sceneFromCamera(k).inverse() * pointAt(i), &pixel)) return std::nullopt;
    if (pass_.mirrored) pixel.x() = kCamera.width() - 1 - pixel.x();
    if (!kCamera.inImage(pixel)) return std::nullopt;
    return pixel;
  }

  std::vector<Track> addKeyframe(int k) {
    Keyframe keyframe;
    keyframe.id = pass_.first_keyframe + k;
    keyframe.world_from_camera = moved_ * (pass_.map_from_scene * sceneFromCamera(k));
    std::vector<Track> tracks;
    for (int i = pass_.first_point; i < pass_.first_point + pass_.points; ++i) {
      const auto pixel = pixelOf(i, k);
      if (!pixel) continue;
      const auto first = references_.try_emplace(i, *pixel).first->second;
      tracks.push_back({pass_.first_track + i, *pixel, first, 0.2});
    }
    map_.addKeyframe(keyframe, tracks, 1.0, kCamera);
    // The depths as a solution would have them.
    Segment segment = map_.lastKeyframes(50, kCamera);
    for (Landmark& landmark : segment.landmarks) {
      const int i = static_cast<int>(landmark.track_id - pass_.first_track);
      const Rigid3& reference = segment.keyframes[landmark.reference].world_from_camera;
      const Eigen::Vector3d point = moved_ * (pass_.map_from_scene * pointAt(i));
      landmark.inverse_depth = 1.0 / (point - reference.translation).norm();
    }
    map_.update(segment);
    return tracks;
  }

  // Of the tracks and, for a keyframe k, of all points before the first that is followed.
  std::vector<Appearance> appearances(const std::vector<Track>& tracks, int k) {
    std::vector<Appearance> result;
    for (const Track& track : tracks) {
      result.push_back(
          looks(static_cast<int>(track.id - pass_.first_track), track.id, track.pixel));
    }
    for (int i = 0; k >= 0 && i < pass_.first_point; ++i) {
      if (const auto pixel = pixelOf(i, k)) result.push_back(looks(i, kNoTrack, *pixel));
    }
    return result;
  }

  Appearance looks(int point, std::int64_t track_id, const Eigen::Vector2d& pixel) {
    const auto i = static_cast<std::uint64_t>(point);
    Random wrong(mixSeed(static_cast<std::uint64_t>(pass_.first_track) + 99, i));
    const bool other = wrong.chance(pass_.wrong_share);
    Random looks(mixSeed(pass_.scene * 31, other ? wrong.integer(0, pass_.points) : i));
    Appearance appearance{track_id, pixel + pass_.noise_px * random_.normal2(), {}};
    for (std::uint8_t& byte : appearance.descriptor) {
      byte = static_cast<std::uint8_t>(looks.integer(0, 255));
      if (random_.chance(0.3)) byte ^= static_cast<std::uint8_t>(1 << random_.integer(0, 7));
    }
    return appearance;
  }

  Pass pass_;
  Map map_;
  Random random_;
  Similarity3 moved_;
  std::map<int, Eigen::Vector2d> references_;
};

Similarity3 someSimilarity() { return {{expSo3({0.3, -0.5, 1.1}), {2.0, -1.0, 0.5}}, 0.4}; }

Pass laterPass() {
  Pass pass;
  pass.map_from_scene = someSimilarity();
  pass.first_track = 1000;
  pass.first_keyframe = 20;
  pass.begin = {0.2, -0.1, 0.3};
  return pass;
}

class RelocalizerTest : public testing::Test {
 protected:
  RelocalizerTest() : relocalizer_(kCapacity) {
    PassedMap first((Pass()));
    EXPECT_FALSE(first.show(0, &relocalizer_));
    EXPECT_FALSE(relocalizer_.memory().places().empty());
  }
  Relocalizer relocalizer_;
};

TEST_F(RelocalizerTest, FindsPoseAndScaleInTheOldMap) {
  for (const double wrong_share : {0.0, 0.5}) {
    Relocalizer relocalizer = relocalizer_;
    Pass pass = laterPass();
    pass.wrong_share = wrong_share;
    PassedMap later(pass);
    const auto relocation = later.show(1, &relocalizer);
    ASSERT_TRUE(relocation) << wrong_share;
    EXPECT_EQ(relocation->map_id, 0u);
    // The old map is the scene.
    const Similarity3 truth = someSimilarity();
    EXPECT_NEAR(relocation->old_from_new.scale * truth.scale, 1.0, 0.01);
    for (const int k : {0, 7}) {
      const Rigid3 pose = relocation->old_from_new * (truth * later.sceneFromCamera(k));
      EXPECT_LT((pose.translation - later.sceneFromCamera(k).translation).norm(), 0.03);
      EXPECT_LT(pose.rotation.angularDistance(later.sceneFromCamera(k).rotation), 0.005);
    }
    // From then on all places are of one map.
    for (const Place& place : relocalizer.memory().places()) EXPECT_EQ(place.map_id, 0u);
  }
}

// Few of the old tracks are followed again: the corners that are not followed tell the place, and
// those that are the scale.
TEST_F(RelocalizerTest, FindsItByCornersThatAreNotFollowed) {
  Pass pass = laterPass();
  pass.first_point = 86;
  Relocalizer without = relocalizer_;
  EXPECT_FALSE(PassedMap(pass).show(1, &without));
  pass.shows_all = true;
  PassedMap later(pass);
  const auto relocation = later.show(1, &relocalizer_);
  ASSERT_TRUE(relocation);
  EXPECT_GT(relocation->seen, 30);
  EXPECT_NEAR(relocation->old_from_new.scale * someSimilarity().scale, 1.0, 0.01);
  for (const Place& place : relocalizer_.memory().places()) {
    for (const PlacePoint& point : place.points) EXPECT_NE(point.track_id, kNoTrack);
  }
}

TEST_F(RelocalizerTest, OtherScenesAreNotTakenForIt) {
  Pass pass = laterPass();
  pass.scene = 2;
  EXPECT_FALSE(PassedMap(pass).show(1, &relocalizer_));
}

TEST_F(RelocalizerTest, AMirrorImageIsNotTakenForIt) {
  Pass pass = laterPass();
  pass.mirrored = true;
  EXPECT_FALSE(PassedMap(pass).show(1, &relocalizer_));
}

// Points that look the same but lie elsewhere.
TEST_F(RelocalizerTest, LooksAloneDoNotSuffice) {
  Pass pass = laterPass();
  pass.wrong_share = 1.0;
  EXPECT_FALSE(PassedMap(pass).show(1, &relocalizer_));
}

TEST_F(RelocalizerTest, ItsOwnMapIsNotSought) {
  Pass pass = laterPass();
  EXPECT_FALSE(PassedMap(pass).show(0, &relocalizer_));
}

TEST_F(RelocalizerTest, WhatIsForgottenIsNotFound) {
  relocalizer_.scaleMap(5, 6, 2.0);  // of a map that has no places: all others go
  EXPECT_TRUE(relocalizer_.memory().places().empty());
  EXPECT_FALSE(PassedMap(laterPass()).show(7, &relocalizer_));
}

TEST_F(RelocalizerTest, KnowsTheScaleThatItsMapWasGiven) {
  relocalizer_.scaleMap(0, 1, 3.0);
  const auto relocation = PassedMap(laterPass()).show(2, &relocalizer_);
  ASSERT_TRUE(relocation);
  EXPECT_EQ(relocation->map_id, 1u);
  EXPECT_NEAR(relocation->old_from_new.scale * someSimilarity().scale, 3.0, 0.03);
}

TEST(Relocalizer, NothingIsRememberedWhereItIsOff) {
  Relocalizer relocalizer(0);
  PassedMap((Pass())).show(0, &relocalizer);
  EXPECT_FALSE(PassedMap(laterPass()).show(1, &relocalizer));
  EXPECT_TRUE(relocalizer.memory().places().empty());
}

TEST(Relocalizer, MemoryIsBoundedThroughAThousandLosses) {
  Relocalizer relocalizer(kCapacity);
  for (int loss = 0; loss < 1000; ++loss) {
    Pass pass;
    pass.scene = 10 + static_cast<std::uint64_t>(loss);
    pass.first_track = 1000 * loss;
    pass.first_keyframe = 10 * loss;
    pass.points = 20;
    ASSERT_FALSE(PassedMap(pass).show(static_cast<std::uint64_t>(loss), &relocalizer)) << loss;
    ASSERT_LE(relocalizer.memory().places().size(), kCapacity);
  }
  EXPECT_EQ(relocalizer.memory().places().size(), kCapacity);
}

// A camera that stays keeps the memory of other places.
TEST(PlaceMemory, OneViewTakesOnePlace) {
  PlaceMemory memory(kCapacity);
  Keyframe keyframe;
  for (int k = 0; k < 100; ++k) {
    keyframe.id = k;
    keyframe.world_from_camera.translation.x() = k < 5 ? 10.0 * k : 40.0;
    memory.add(0, keyframe, {});
  }
  EXPECT_EQ(memory.places().size(), 5u);
  EXPECT_EQ(memory.places().back().keyframe_id, 99);
}

}  // namespace
}  // namespace camera_self_calibration
