#include "camera_self_calibration/localization/place_recognition.h"

#include <gtest/gtest.h>

#include <set>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

const Camera kCamera = camera640(CameraModel::kFov, {320, 322, 316, 243, 0.95});
constexpr std::uint64_t kMap = 3;

Descriptor looksOf(std::uint64_t number) {
  Random random(mixSeed(number, 17));
  Descriptor descriptor;
  for (std::uint8_t& byte : descriptor) byte = static_cast<std::uint8_t>(random.integer(0, 255));
  return descriptor;
}

Eigen::Vector3d pointAt(int i) {
  Random random(static_cast<std::uint64_t>(i) + 1);
  return {random.uniform(-2.0, 2.0), random.uniform(-1.5, 1.5), random.uniform(2.0, 6.0)};
}

// Points from `first` on, as they are remembered.
Place placeOf(int first, int count) {
  Place place;
  place.map_id = kMap;
  for (int i = first; i < first + count; ++i) {
    PlacePoint point;
    point.track_id = i;
    point.known = true;
    point.direction = pointAt(i).normalized();
    point.inverse_depth = 1.0 / pointAt(i).norm();
    place.points.push_back(point);
    place.descriptors.push_back(looksOf(static_cast<std::uint64_t>(i)));
  }
  return place;
}

const std::vector<Place> kPlaces = {placeOf(0, 30), placeOf(20, 30)};

Rigid3 truePose() { return {expSo3({0.05, -0.1, 0.2}), {0.2, -0.1, 0.3}}; }

// Of points 0 .. 49; those from `alike` on look like nothing that was seen before.
std::vector<Appearance> present(int alike, bool mirrored = false) {
  Random random(9);
  std::vector<Appearance> result;
  for (int i = 0; i < 50; ++i) {
    Eigen::Vector2d pixel;
    if (!kCamera.project(truePose().inverse() * pointAt(i), &pixel)) continue;
    if (mirrored) pixel.x() = kCamera.width() - 1 - pixel.x();
    const std::uint64_t looks = i < alike ? static_cast<std::uint64_t>(i) : 1000 + i;
    result.push_back({100 + i, pixel + 0.5 * random.normal2(), looksOf(looks)});
  }
  return result;
}

// About four pixels beside the truth.
Rigid3 guess() {
  return {truePose().rotation * expSo3({0.008, -0.006, 0.004}),
          truePose().translation + Eigen::Vector3d(0.02, 0.01, -0.02)};
}

TEST(PlaceRecognition, PointsOfAllPlacesAreFoundWhereTheyHaveToBe) {
  const auto matches = matchNear(kPlaces, kMap, guess(), present(50), kCamera);
  EXPECT_GT(matches.size(), 35u);
  std::set<std::int64_t> points;
  for (const SeenAgain& seen : matches) {
    EXPECT_EQ(seen.track_id, 100 + seen.point.track_id);
    EXPECT_TRUE(points.insert(seen.point.track_id).second) << "each once";
  }
  EXPECT_TRUE(matchNear(kPlaces, kMap + 1, guess(), present(50), kCamera).empty());
}

TEST(PlaceRecognition, AGuessIsMadeExact) {
  const auto place = confirmPose(kPlaces, kMap, guess(), present(25), kCamera);
  ASSERT_TRUE(place);
  EXPECT_GE(place->seen.size(), 18u);
  EXPECT_LT((place->old_from_camera.translation - truePose().translation).norm(), 0.02);
  EXPECT_LT(place->old_from_camera.rotation.angularDistance(truePose().rotation), 0.004);
}

// As after a rotation on the spot, which puts points without parallax beyond infinity. How far away
// they are is the unit in which the position has to be known.
TEST(PlaceRecognition, PointsBeyondInfinityTellAPose) {
  Place place = placeOf(0, 30);
  for (PlacePoint& point : place.points) point.inverse_depth = -1e-4;
  std::vector<Appearance> seen;
  for (int i = 0; i < 30; ++i) {
    Eigen::Vector2d pixel;
    const Eigen::Vector3d ray = truePose().rotation.conjugate() * place.points[i].direction;
    if (kCamera.project(ray, &pixel)) seen.push_back({100 + i, pixel, place.descriptors[i]});
  }
  const auto recognized = confirmPose({place}, kMap, guess(), seen, kCamera);
  ASSERT_TRUE(recognized);
  EXPECT_LT(recognized->old_from_camera.rotation.angularDistance(truePose().rotation), 0.004);
}

TEST(PlaceRecognition, AGuessThatLittleSpeaksForIsRefused) {
  EXPECT_FALSE(confirmPose(kPlaces, kMap, guess(), present(10), kCamera)) << "few look alike";
  EXPECT_FALSE(confirmPose(kPlaces, kMap, guess(), present(50, true), kCamera)) << "mirrored";
  Rigid3 elsewhere = guess();
  elsewhere.translation.x() += 1.0;
  EXPECT_FALSE(confirmPose(kPlaces, kMap, elsewhere, present(50), kCamera)) << "elsewhere";
}

// A picture that is repeated elsewhere, with other things around it there.
TEST(PlaceRecognition, MostOfAPlaceMustNotBeMissing) {
  EXPECT_TRUE(confirmPose({placeOf(0, 120)}, kMap, guess(), present(50), kCamera));
  EXPECT_TRUE(confirmPose({placeOf(0, 30)}, kMap, guess(), present(25), kCamera));
  EXPECT_FALSE(confirmPose({placeOf(0, 120)}, kMap, guess(), present(22), kCamera));
}

TEST(PlaceRecognition, LooksAloneGiveTheFirstGuess) {
  const auto matches = matchPlace(kPlaces[0], present(14));
  ASSERT_GE(matches.size(), 12u);
  ASSERT_LT(matches.size(), 15u);
  const auto pose = poseAtPlace(kPlaces[0], matches, kCamera);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->translation - truePose().translation).norm(), 0.1);
  EXPECT_TRUE(poseAtPlace(kPlaces[0], matchPlace(kPlaces[0], present(9)), kCamera));
  EXPECT_FALSE(poseAtPlace(kPlaces[0], matchPlace(kPlaces[0], present(7)), kCamera)) << "too few";
}

// Things that look like those of the place, but stand elsewhere.
TEST(PlaceRecognition, MatchesThatDoNotBelongTogetherGiveNoGuess) {
  auto matches = matchPlace(kPlaces[0], present(30));
  ASSERT_GE(matches.size(), 20u);
  const Eigen::Vector2d first = matches.front().pixel;
  for (std::size_t i = 0; i + 1 < matches.size(); ++i) matches[i].pixel = matches[i + 1].pixel;
  matches.back().pixel = first;
  EXPECT_FALSE(poseAtPlace(kPlaces[0], matches, kCamera));
}

// A third of the matches is right; the others are anywhere.
TEST(PlaceRecognition, FewRightOnesAmongManyGiveTheFirstGuess) {
  auto matches = matchPlace(kPlaces[0], present(30));
  for (std::size_t i = 0; 3 * i + 5 < matches.size(); ++i) {
    std::swap(matches[3 * i].pixel, matches[3 * i + 4].pixel);
  }
  const auto pose = poseAtPlace(kPlaces[0], matches, kCamera);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->translation - truePose().translation).norm(), 0.1);
}

}  // namespace
}  // namespace camera_self_calibration
