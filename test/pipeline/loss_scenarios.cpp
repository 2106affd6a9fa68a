#include "pipeline/loss_scenarios.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/simulation/texture_paint.h"
#include "pipeline/image_run.h"

namespace camera_self_calibration {
namespace {

constexpr double kRate = 15.0;
constexpr double kLearning = 8.0;
constexpr double kBefore = 3.0;  // [s] Of the poses before the loss that are compared.

Camera lens() {
  return Camera(CameraModel::kFov, 320, 240, intrinsics({160, 160.5, 159, 121, 0.9}));
}

World tiledRoom(std::uint64_t seed) {
  RoomOptions options;
  options.furnished = false;
  World world = makeRoom(options);
  for (Surface& surface : world.surfaces) {
    surface.texture.kind = TextureKind::kTiles;
    surface.texture.seed = seed;
    surface.texture.texels_per_metre = 100.0;
  }
  return world;
}

World room(std::uint64_t seed) {
  RoomOptions options;
  options.seed = seed;
  options.texture_detail = 0.4;
  return makeRoom(options);
}

struct Scene {
  Scene(const World& world, std::uint64_t seed, double exposure_s = 0.0)
      : painted(std::make_shared<PaintedWorld>(world)),
        eye(painted, lens(), rendererOptions(exposure_s)),
        motion(motionIn(world, seed)) {}

  static RendererOptions rendererOptions(double exposure_s) {
    RendererOptions options;
    options.exposure_s = exposure_s;
    return options;
  }
  static Trajectory motionIn(const World& world, std::uint64_t seed) {
    SyntheticMotionOptions options;
    options.speed = 0.6;
    options.seed = seed;
    options.duration_s = 40.0;
    options.box = world.free_space;
    return syntheticMotion(options);
  }

  std::shared_ptr<const PaintedWorld> painted;
  Renderer eye;
  Trajectory motion;
};

// The motion with a whole turn about the camera's vertical axis that begins at a time.
Trajectory withTurn(const Trajectory& motion, double begin_s, double duration_s) {
  return Trajectory(
      [=](double t) {
        const double share = std::min(1.0, std::max(0.0, (t - begin_s) / duration_s));
        const double angle = 2.0 * M_PI * share - std::sin(2.0 * M_PI * share);
        const Eigen::AngleAxisd turn(angle, Eigen::Vector3d::UnitY());
        return motion.worldFromCamera(t) *
               Rigid3(Eigen::Quaterniond(turn), Eigen::Vector3d::Zero());
      },
      motion.duration());
}

// The same way, but beside it and with the camera held askew.
Trajectory anotherWay(const Trajectory& motion) {
  const Eigen::AngleAxisd roll(0.25, Eigen::Vector3d::UnitZ());
  const Rigid3 beside(Eigen::Quaterniond(roll), Eigen::Vector3d(0.25, 0.1, 0.0));
  return Trajectory([=](double t) { return motion.worldFromCamera(t) * beside; },
                    motion.duration());
}

// Textured figures that cross the image at several speeds.
cv::Mat withPeople(const cv::Mat& image, double time_s, int people, const cv::Mat& clothes) {
  cv::Mat result = image.clone();
  for (int i = 0; i < people; ++i) {
    const int width = 30 + 8 * i;
    const int span = image.cols + 2 * width;
    const double speed = (i % 2 == 0 ? 1.0 : -1.0) * (50.0 + 17.0 * i);  // [px/s]
    const double way = std::fmod(speed * time_s + 97.0 * i, span);
    const int x = static_cast<int>(way < 0.0 ? way + span : way) - width;
    const cv::Rect body =
        cv::Rect(x, 40 + 9 * i, width, image.rows) & cv::Rect(0, 0, image.cols, image.rows);
    if (body.empty()) continue;
    clothes(cv::Rect(60 * i + body.x - x, 0, body.width, body.height)).copyTo(result(body));
  }
  return result;
}

bool wasSeen(const Scene& scene, const Eigen::Vector3d& point) {
  constexpr double kBorder = 15.0;  // [px]
  const World& world = scene.painted->world;
  for (double t = 0.0; t < kLearning; t += 0.25) {
    const Rigid3 pose = scene.motion.worldFromCamera(t);
    Eigen::Vector2d pixel;
    if (lens().project(pose.inverse() * point, &pixel) && lens().inImage(pixel, kBorder) &&
        world.visible(pose.translation, point)) {
      return true;
    }
  }
  return false;
}

// Of a view, on a grid of pixels: what was seen during the learning.
double knownShare(const Scene& scene, double time_s) {
  const Rigid3 pose = scene.motion.worldFromCamera(time_s);
  int known = 0, all = 0;
  for (int x = 20; x < lens().width(); x += 20) {
    for (int y = 20; y < lens().height(); y += 20) {
      const auto ray = lens().unproject({x, y});
      if (!ray) continue;
      const Eigen::Vector3d direction = pose.rotation * *ray;
      const auto hit = scene.painted->world.castRay(pose.translation, direction);
      if (!hit) continue;
      ++all;
      known += wasSeen(scene, pose.translation + hit->distance * direction);
    }
  }
  return static_cast<double>(known) / std::max(1, all);
}

cv::Mat clothes(std::uint64_t seed) {
  TextureRecipe recipe;
  recipe.kind = TextureKind::kPoster;
  recipe.seed = seed;
  recipe.texels_per_metre = 200.0;
  cv::Mat cloth;
  cv::resize(paintTexture(recipe, 2.0, 1.2), cloth, cv::Size(400, 240));
  return cloth;
}

class Script {
 public:
  Script(LossKind kind, std::uint64_t seed)
      : seed_(seed),
        home_(kind == LossKind::kRepetitive ? tiledRoom(seed) : room(seed), seed + 3),
        run_(options(), kRate) {
    run_.play(home_.eye, home_.motion, 0.0, kLearning);
    outcome_.before = run_.report();
    usable_s_ = run_.now();
    play(kind);
  }

  LossOutcome outcome() {
    outcome_.lost = run_.record.count(EventType::kLost);
    outcome_.relocalized = run_.record.count(EventType::kRelocalized);
    outcome_.changes = run_.record.count(EventType::kCalibrationChange);
    outcome_.blind_s = run_.blindAfter(usable_s_);
    outcome_.relocalized_s = run_.lastEvent(EventType::kRelocalized) - usable_s_;
    outcome_.map_id = run_.last().map_id;
    const auto difference = run_.difference(kLearning - kBefore, 0);
    outcome_.position_error = difference ? difference->rms : NAN;
    outcome_.travelled = difference ? difference->travelled : NAN;
    outcome_.after = run_.report();
    outcome_.calibration_error_px = pixelDistance(lens(), outcome_.after.camera).rms;
    return outcome_;
  }

 private:
  static Options options() {
    Options options = optionsFor(CameraModel::kFov);
    options.initial_camera =
        Camera(CameraModel::kFov, 320, 240, intrinsics({150, 150, 160, 120, 1}));
    return options;
  }

  void dark(double seconds) {
    run_.dark(seconds, lens().width(), lens().height());
    usable_s_ = run_.now();
  }
  void goOn(double from_s, double to_s, const ImageRun::Edit& edit = nullptr) {
    run_.play(home_.eye, home_.motion, from_s, to_s, edit);
  }

  void play(LossKind kind) {
    switch (kind) {
      case LossKind::kBlackout:
        dark(3.0);
        return goOn(kLearning, kLearning + 5.0);
      case LossKind::kOtherWay:
        dark(3.0);
        return run_.play(home_.eye, anotherWay(home_.motion), kLearning + 3.0, kLearning - 4.0);
      case LossKind::kTeleport:
        return teleport();
      case LossKind::kMirror:
        dark(1.0);
        return goOn(kLearning, kLearning + 5.0, [](const cv::Mat& image, double) {
          cv::Mat mirrored;
          cv::flip(image, mirrored, 1);
          return mirrored;
        });
      case LossKind::kRepetitive:
        return goOn(kLearning + 6.0, kLearning + 12.0);
      case LossKind::kWhipPan:
        return whipPan();
      case LossKind::kCrowd:
        return crowd(3);
      case LossKind::kDenseCrowd:
        return crowd(5);
      case LossKind::kFlicker:
        for (int i = 0; i < 10; ++i) {
          dark(1.0);
          goOn(kLearning + 2.0 * i, kLearning + 2.0 * (i + 1));
        }
    }
  }

  void teleport() {
    const Scene other(room(seed_ + 1000), seed_ + 5);
    run_.play(other.eye, other.motion, 0.0, 5.0, nullptr, 1);
    outcome_.relocalized_elsewhere = run_.record.count(EventType::kRelocalized);
    outcome_.blind_elsewhere_s = run_.blindAfter(usable_s_);
    usable_s_ = run_.now();
    goOn(kLearning, kLearning + 5.0);
  }

  void whipPan() {
    constexpr double kTurn = 0.6;
    const Scene blurred(home_.painted->world, seed_ + 3, 0.02);
    const Trajectory turning = withTurn(home_.motion, kLearning, kTurn);
    run_.play(blurred.eye, turning, kLearning, kLearning + kTurn);
    usable_s_ = run_.now();
    outcome_.known_share = knownShare(home_, kLearning + kTurn);
    goOn(kLearning + kTurn, kLearning + 5.0);
  }

  void crowd(int people) {
    const cv::Mat cloth = clothes(seed_);
    goOn(kLearning, kLearning + 5.0, [&](const cv::Mat& image, double time_s) {
      return withPeople(image, time_s, people, cloth);
    });
    usable_s_ = run_.now();
    goOn(kLearning + 5.0, kLearning + 10.0);
  }

  std::uint64_t seed_;
  Scene home_;
  ImageRun run_;
  double usable_s_ = 0.0;
  LossOutcome outcome_;
};

}  // namespace

const std::vector<LossKind>& lossKinds() {
  static const std::vector<LossKind> kinds = {
      LossKind::kBlackout, LossKind::kOtherWay,   LossKind::kTeleport,
      LossKind::kMirror,   LossKind::kRepetitive, LossKind::kWhipPan,
      LossKind::kCrowd,    LossKind::kDenseCrowd, LossKind::kFlicker};
  return kinds;
}

std::string toString(LossKind kind) {
  switch (kind) {
    case LossKind::kBlackout:
      return "blackout of 3 s";
    case LossKind::kOtherWay:
      return "back by another way";
    case LossKind::kTeleport:
      return "other room and back";
    case LossKind::kMirror:
      return "mirrored images";
    case LossKind::kRepetitive:
      return "equal walls, cut";
    case LossKind::kWhipPan:
      return "whip-pan";
    case LossKind::kCrowd:
      return "crowd for 5 s";
    case LossKind::kDenseCrowd:
      return "dense crowd for 5 s";
    case LossKind::kFlicker:
      return "10 blackouts of 1 s";
  }
  return "";
}

LossOutcome runLoss(LossKind kind, std::uint64_t seed) { return Script(kind, seed).outcome(); }

}  // namespace camera_self_calibration
