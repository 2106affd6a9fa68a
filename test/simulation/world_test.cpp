#include "camera_self_calibration/simulation/world.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/room.h"

namespace camera_self_calibration {
namespace {

using Eigen::Vector3d;

// A wall at x = 3 and a smaller plate at x = 2, both seen from the origin.
World wallAndPlate() {
  World world;
  world.surfaces.push_back(
      Surface::facing({3.0, 0.0, 0.0}, -Vector3d::UnitX(), Vector3d::UnitZ(), 4.0, 2.0, {}));
  world.surfaces.push_back(
      Surface::facing({2.0, 0.5, 0.0}, -Vector3d::UnitX(), Vector3d::UnitZ(), 0.4, 0.4, {}));
  return world;
}

TEST(Surface, IsUprightForItsViewer) {
  const Surface wall =
      Surface::facing({3.0, 0.0, 0.0}, -Vector3d::UnitX(), Vector3d::UnitZ(), 4.0, 2.0, {});
  // Who looks along x with z up has y on the left.
  EXPECT_TRUE(wall.at(0.0, 0.0).isApprox(Vector3d(3.0, 2.0, 1.0), 1e-12));
  EXPECT_TRUE(wall.at(1.0, 1.0).isApprox(Vector3d(3.0, -2.0, -1.0), 1e-12));
  EXPECT_TRUE(wall.normal().isApprox(-Vector3d::UnitX(), 1e-12));
}

TEST(World, NearestSurfaceWins) {
  const World world = wallAndPlate();
  const auto plate = world.castRay(Vector3d::Zero(), Vector3d(2.0, 0.5, 0.1));
  ASSERT_TRUE(plate);
  EXPECT_EQ(plate->surface, 1);
  EXPECT_NEAR(plate->distance, 1.0, 1e-12);
  EXPECT_NEAR(plate->a, 0.5, 1e-12);
  EXPECT_NEAR(plate->b, 0.25, 1e-12);
  const auto wall = world.castRay(Vector3d::Zero(), Vector3d(1.0, 0.0, 0.0));
  ASSERT_TRUE(wall);
  EXPECT_EQ(wall->surface, 0);
  EXPECT_NEAR(wall->distance, 3.0, 1e-12);
}

TEST(World, RaysMissBesideAndFromBehind) {
  const World world = wallAndPlate();
  EXPECT_FALSE(world.castRay(Vector3d::Zero(), Vector3d(-1.0, 0.0, 0.0)));
  EXPECT_FALSE(world.castRay(Vector3d::Zero(), Vector3d(0.1, 1.0, 0.0)));
  EXPECT_FALSE(world.castRay(Vector3d(5.0, 0.0, 0.0), Vector3d(-1.0, 0.0, 0.0)));
}

TEST(World, OcclusionHidesOnlyWhatIsBehind) {
  const World world = wallAndPlate();
  EXPECT_TRUE(world.visible(Vector3d::Zero(), Vector3d(2.0, 0.45, 0.05)));
  EXPECT_FALSE(world.visible(Vector3d::Zero(), Vector3d(3.0, 0.75, 0.0)));
  EXPECT_TRUE(world.visible(Vector3d::Zero(), Vector3d(3.0, -0.75, 0.0)));
  EXPECT_TRUE(world.visible(Vector3d(2.5, 0.5, 0.0), Vector3d(3.0, 0.75, 0.0)));
}

TEST(World, BoxShowsItsOutside) {
  World world;
  addBox({1.0, 2.0, 0.5}, {0.4, 0.6, 1.0}, 0.3, {}, {}, &world);
  ASSERT_EQ(world.surfaces.size(), 6u);
  for (const Surface& surface : world.surfaces) {
    const Vector3d outwards = surface.at(0.5, 0.5) - Vector3d(1.0, 2.0, 0.5);
    EXPECT_GT(surface.normal().dot(outwards), 0.15);
    EXPECT_NEAR(surface.u.dot(surface.v), 0.0, 1e-12);
  }
  const auto hit = world.castRay({1.0, 2.0, 3.0}, -Vector3d::UnitZ());
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 2.0, 1e-12);
}

TEST(Room, IsClosedAroundItsFreeSpace) {
  RoomOptions options;
  for (options.seed = 1; options.seed <= 5; ++options.seed) {
    const World room = makeRoom(options);
    Random random(options.seed);
    for (int i = 0; i < 500; ++i) {
      Vector3d eye = room.free_space.min();
      for (int axis = 0; axis < 3; ++axis)
        eye[axis] += random.uniform() * room.free_space.sizes()[axis];
      const Vector3d direction = random.normal3().normalized();
      const auto hit = room.castRay(eye, direction);
      ASSERT_TRUE(hit);
      EXPECT_LT(hit->distance, options.size.norm());
      const Vector3d point = eye + hit->distance * direction;
      EXPECT_FALSE(room.free_space.contains(point)) << "furniture stands in the free space";
    }
  }
}

TEST(Room, FollowsItsSeedAndItsSize) {
  RoomOptions options;
  const World a = makeRoom(options);
  const World b = makeRoom(options);
  ASSERT_EQ(a.surfaces.size(), b.surfaces.size());
  for (std::size_t i = 0; i < a.surfaces.size(); ++i) {
    EXPECT_EQ(a.surfaces[i].corner, b.surfaces[i].corner);
    EXPECT_EQ(a.surfaces[i].texture.seed, b.surfaces[i].texture.seed);
  }
  options.seed = 2;
  EXPECT_NE(makeRoom(options).surfaces.back().corner, a.surfaces.back().corner);
  options.size = Vector3d(20.0, 15.0, 6.0);
  EXPECT_GT(makeRoom(options).free_space.volume(), 500.0);
}

TEST(Room, RefusesImpossibleOptions) {
  RoomOptions options;
  options.size.z() = 1.0;
  options.texture_detail = 0.0;
  EXPECT_EQ(options.problems().size(), 2u);
  EXPECT_THROW(makeRoom(options), std::invalid_argument);
}

}  // namespace
}  // namespace camera_self_calibration
