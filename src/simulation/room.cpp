#include "camera_self_calibration/simulation/room.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

using Eigen::Vector3d;

constexpr double kWallMargin = 1.1;      // [m] from a wall to the free space: furniture stands here
constexpr double kFreeBottom = 1.1;      // [m] everything in the middle is lower
constexpr double kFreeTop = 0.5;         // [m] below the ceiling: lamps
constexpr double kPosterOffset = 0.005;  // [m] in front of the wall

TextureRecipe recipe(TextureKind kind, double gray, double density, Random* random) {
  TextureRecipe texture;
  texture.kind = kind;
  texture.seed = static_cast<std::uint64_t>(random->uniform() * 1e15);
  texture.gray = gray + random->uniform(-6.0, 6.0);
  texture.texels_per_metre = density;
  return texture;
}

// One wall as seen from inside: its centre, the inward normal and its length.
struct Wall {
  Vector3d centre;
  Vector3d normal;
  double length;
};

std::vector<Wall> wallsOf(const Vector3d& size) {
  const double z = 0.5 * size.z();
  return {{{0.5 * size.x(), 0.0, z}, -Vector3d::UnitX(), size.y()},
          {{-0.5 * size.x(), 0.0, z}, Vector3d::UnitX(), size.y()},
          {{0.0, 0.5 * size.y(), z}, -Vector3d::UnitY(), size.x()},
          {{0.0, -0.5 * size.y(), z}, Vector3d::UnitY(), size.x()}};
}

void addShell(const Vector3d& size, Random* random, World* world) {
  const Vector3d up = Vector3d::UnitZ();
  const TextureKind kinds[] = {TextureKind::kBricks, TextureKind::kPlaster, TextureKind::kPanels,
                               TextureKind::kPlaster};
  const double grays[] = {120.0, 185.0, 150.0, 95.0};
  const std::vector<Wall> walls = wallsOf(size);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    world->surfaces.push_back(Surface::facing(walls[i].centre, walls[i].normal, up, walls[i].length,
                                              size.z(), recipe(kinds[i], grays[i], 256.0, random)));
  }
  world->surfaces.push_back(Surface::facing(Vector3d::Zero(), up, Vector3d::UnitY(), size.x(),
                                            size.y(),
                                            recipe(TextureKind::kPlanks, 110.0, 256.0, random)));
  world->surfaces.push_back(Surface::facing({0.0, 0.0, size.z()}, -up, Vector3d::UnitY(), size.x(),
                                            size.y(),
                                            recipe(TextureKind::kTiles, 205.0, 200.0, random)));
}

// Posters in slots along each wall, a door in one of them.
void addPosters(const Vector3d& size, Random* random, World* world) {
  const Vector3d up = Vector3d::UnitZ();
  for (const Wall& wall : wallsOf(size)) {
    const int slots = std::max(2, static_cast<int>(wall.length / 1.4));
    const double slot = wall.length / slots;
    const Vector3d right = up.cross(wall.normal);
    const int door = random->integer(0, 2 * slots);
    for (int i = 0; i < slots; ++i) {
      const bool is_door = i == door;
      const double width = is_door ? 0.9 : slot * random->uniform(0.35, 0.75);
      const double height = is_door ? 2.0 : std::min(random->uniform(0.5, 1.3), size.z() - 1.5);
      const double middle =
          is_door ? 1.0 : random->uniform(1.1 + 0.5 * height, size.z() - 0.2 - 0.5 * height);
      const double shift =
          (i + 0.5) * slot - 0.5 * wall.length + 0.4 * (slot - width) * random->uniform(-1.0, 1.0);
      Vector3d centre = wall.centre + shift * right + kPosterOffset * wall.normal;
      centre.z() = middle;
      const TextureKind kind = is_door ? TextureKind::kPanels : TextureKind::kPoster;
      world->surfaces.push_back(
          Surface::facing(centre, wall.normal, up, width, height,
                          recipe(kind, random->uniform(60.0, 220.0), 450.0, random)));
    }
  }
  const Vector3d carpet_centre(random->uniform(-0.3, 0.3), random->uniform(-0.3, 0.3), 0.004);
  world->surfaces.push_back(Surface::facing(carpet_centre, up, Vector3d::UnitY(), 0.45 * size.x(),
                                            0.4 * size.y(),
                                            recipe(TextureKind::kCarpet, 140.0, 300.0, random)));
}

void addTable(const Vector3d& centre, double yaw, Random* random, World* world) {
  const double length = random->uniform(1.1, 1.5);
  const double depth = random->uniform(0.6, 0.8);
  const TextureRecipe wood =
      recipe(TextureKind::kPlanks, random->uniform(80.0, 190.0), 400.0, random);
  addBox(centre + Vector3d(0.0, 0.0, 0.72), {length, depth, 0.05}, yaw, wood, wood, world);
  const Eigen::AngleAxisd turn(yaw, Vector3d::UnitZ());
  for (int leg = 0; leg < 4; ++leg) {
    const Vector3d foot((leg & 1 ? 0.5 : -0.5) * (length - 0.12),
                        (leg & 2 ? 0.5 : -0.5) * (depth - 0.12), 0.35);
    addBox(centre + turn * foot, {0.06, 0.06, 0.695}, yaw, wood, wood, world);
  }
  for (int i = 0; i < 2; ++i) {  // what lies on the table
    const double height = random->uniform(0.08, 0.28);
    const Vector3d place(random->uniform(-0.3, 0.3) + 0.35 * (2 * i - 1),
                         random->uniform(-0.1, 0.1), 0.745 + 0.5 * height);
    const TextureRecipe box =
        recipe(i == 0 ? TextureKind::kPoster : TextureKind::kBooks, 150.0, 600.0, random);
    addBox(centre + turn * place, {random->uniform(0.15, 0.35), 0.2, height},
           yaw + random->uniform(-0.6, 0.6), box, box, world);
  }
}

void addCrates(const Vector3d& size, Random* random, World* world) {
  const double x = 0.5 * size.x();
  const double y = 0.5 * size.y();
  for (int i = 0; i < 4; ++i) {
    const double edge = random->uniform(0.35, 0.6);
    const Vector3d place((i & 1 ? 1 : -1) * (x - random->uniform(0.9, 1.6)),
                         (i & 2 ? 1 : -1) * (y - random->uniform(0.6, 1.2)), 0.5 * edge);
    const TextureRecipe wood =
        recipe(TextureKind::kCrate, random->uniform(70.0, 200.0), 400.0, random);
    addBox(place, {edge, edge * random->uniform(0.8, 1.2), edge}, random->uniform(-0.7, 0.7), wood,
           wood, world);
  }
}

void addFurniture(const Vector3d& size, Random* random, World* world) {
  const double x = 0.5 * size.x();
  const double y = 0.5 * size.y();
  addTable({random->uniform(-0.4, 0.0) * x, random->uniform(0.1, 0.3) * y, 0.0},
           random->uniform(-0.5, 0.5), random, world);
  addTable({random->uniform(0.1, 0.4) * x, -random->uniform(0.2, 0.45) * y, 0.0},
           random->uniform(1.0, 1.6), random, world);
  addCrates(size, random, world);
  const TextureRecipe books = recipe(TextureKind::kBooks, 130.0, 400.0, random);
  const TextureRecipe shelf_top = recipe(TextureKind::kPlain, 90.0, 200.0, random);
  const double shelf_height = std::min(2.1, size.z() - 0.4);
  addBox({x - 0.2, random->uniform(-0.3, 0.3) * y, 0.5 * shelf_height}, {0.35, 1.3, shelf_height},
         0.0, books, shelf_top, world);
  addBox({random->uniform(-0.3, 0.3) * x, -y + 0.2, 0.45}, {1.5, 0.35, 0.9}, 0.0, books, shelf_top,
         world);
  for (int i = 0; i < 3; ++i) {  // pillars in three of the corners
    const TextureRecipe stone = recipe(i == 1 ? TextureKind::kTiles : TextureKind::kBricks,
                                       random->uniform(90.0, 210.0), 300.0, random);
    const double edge = random->uniform(0.25, 0.4);
    addBox({(i & 1 ? 1 : -1) * (x - 0.65), (i & 2 ? 1 : -1) * (y - 0.65), 0.5 * size.z()},
           {edge, edge, size.z()}, random->uniform(0.0, 0.8), stone, stone, world);
  }
  for (int i = 0; i < 2; ++i) {
    const TextureRecipe lamp = recipe(TextureKind::kPanels, 230.0, 300.0, random);
    addBox({(i - 0.5) * x, random->uniform(-0.2, 0.2) * y, size.z() - 0.15}, {0.9, 0.3, 0.12},
           random->uniform(0.0, 1.5), lamp, lamp, world);
  }
}

}  // namespace

std::vector<std::string> RoomOptions::problems() const {
  std::vector<std::string> found;
  if (!(size.x() >= 4.0 && size.y() >= 4.0 && size.x() <= 50.0 && size.y() <= 50.0)) {
    found.push_back("a room must be 4 to 50 m long and wide");
  }
  if (!(size.z() >= 2.4 && size.z() <= 20.0)) found.push_back("a room must be 2.4 to 20 m high");
  if (!(texture_detail >= 0.05 && texture_detail <= 4.0)) {
    found.push_back("texture_detail must be in [0.05, 4]");
  }
  return found;
}

World makeRoom(const RoomOptions& options) {
  const std::vector<std::string> problems = options.problems();
  if (!problems.empty()) {
    std::string message = "invalid room:";
    for (const std::string& problem : problems) message += " " + problem + ";";
    throw std::invalid_argument(message);
  }
  Random random(options.seed);
  World world;
  addShell(options.size, &random, &world);
  addPosters(options.size, &random, &world);
  if (options.furnished) addFurniture(options.size, &random, &world);
  for (Surface& surface : world.surfaces) {
    surface.texture.texels_per_metre *= options.texture_detail;
  }
  const Vector3d half = 0.5 * options.size;
  world.free_space = Eigen::AlignedBox3d(
      Vector3d(kWallMargin - half.x(), kWallMargin - half.y(), kFreeBottom),
      Vector3d(half.x() - kWallMargin, half.y() - kWallMargin, options.size.z() - kFreeTop));
  return world;
}

}  // namespace camera_self_calibration
