// How the tracker's errors hang together: along a track, by the distance in time, and between the
// tracks of one image; and whether the tracker's sigma knows of them where features move fast and
// are blurred. Rendered rooms of random lens, noise and motion, against exact points.
//
//   track_error_benchmark [SEQUENCES [SECONDS [EXPOSURE_S [SPEED]]]]
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "benchmark/random_sequence.h"
#include "tracking/track_errors.h"

namespace camera_self_calibration {
namespace {

constexpr std::array<int, 7> kLags = {1, 2, 5, 10, 20, 40, 80};  // images
constexpr double kGross = 1.0;  // [px] Outliers are another matter.
constexpr std::array<double, 5> kPaces = {2.0, 5.0, 10.0, 20.0, 1e9};  // [px per image] at most

struct Products {
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;

  void add(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    sum += a.dot(b);
    squares += 0.5 * (a.squaredNorm() + b.squaredNorm());
    count += 1.0;
  }
  double correlation() const { return squares > 0.0 ? sum / squares : NAN; }
};

// Of the features that move at some pace.
struct PaceErrors {
  double count = 0.0;
  double gross = 0.0;
  double square = 0.0;  // of errors, per axis; gross ones left out
  double sigma2 = 0.0;
  double z2 = 0.0;
};

struct Errors {
  std::array<PaceErrors, kPaces.size()> by_pace;
  std::array<Products, kLags.size()> along_track;
  Products between_tracks;
  double z2 = 0.0;
  double count = 0.0;
  double gross = 0.0;
};

ExactScene sceneOf(const SimulatedSequence& sequence) {
  ExactScene scene;
  scene.image = [&sequence](int i) {
    const cv::Mat image = sequence.frame(i).image;
    return TestImage{
        image.cols, image.rows,
        std::vector<std::uint8_t>(image.begin<std::uint8_t>(), image.end<std::uint8_t>())};
  };
  scene.point = [&sequence](int i, const Eigen::Vector2d& pixel) -> std::optional<Eigen::Vector3d> {
    const Rigid3 pose = sequence.worldFromCamera(i);
    const auto ray = sequence.camera(i).unproject(pixel);
    if (!ray) return std::nullopt;
    const Eigen::Vector3d direction = pose.rotation * *ray;
    const auto hit = sequence.world().castRay(pose.translation, direction);
    if (!hit) return std::nullopt;
    return Eigen::Vector3d(pose.translation + hit->distance * direction);
  };
  scene.pixel = [&sequence](int i, const Eigen::Vector3d& point) -> std::optional<Eigen::Vector2d> {
    const Rigid3 pose = sequence.worldFromCamera(i);
    Eigen::Vector2d pixel;
    if (!sequence.world().visible(pose.translation, point)) return std::nullopt;
    if (!sequence.camera(i).project(pose.inverse() * point, &pixel)) return std::nullopt;
    return pixel;
  };
  return scene;
}

using ErrorsOfImages = std::map<int, std::map<std::int64_t, Eigen::Vector2d>>;  // image, track

void addImage(const ErrorsOfImages& images, int image,
              const std::map<std::int64_t, Eigen::Vector2d>& here, Errors* errors) {
  for (std::size_t l = 0; l < kLags.size(); ++l) {
    const auto later = images.find(image + kLags[l]);
    if (later == images.end()) continue;
    for (const auto& [id, error] : here) {
      const auto again = later->second.find(id);
      if (again != later->second.end()) errors->along_track[l].add(error, again->second);
    }
  }
  for (auto a = here.begin(); a != here.end(); ++a) {
    for (auto b = std::next(a); b != here.end(); ++b) {
      errors->between_tracks.add(a->second, b->second);
    }
  }
}

void addPace(const TrackSample& sample, Errors* errors) {
  const double pace = (sample.truth - sample.last_truth).norm();
  if (!std::isfinite(pace) || sample.age == 0) return;
  std::size_t bin = 0;
  while (pace > kPaces[bin]) ++bin;
  PaceErrors& at = errors->by_pace[bin];
  at.count += 1.0;
  if (!(sample.error.norm() < kGross)) {
    at.gross += 1.0;
    return;
  }
  at.square += 0.5 * sample.error.squaredNorm();
  at.sigma2 += sample.sigma * sample.sigma;
  at.z2 += 0.5 * sample.error.squaredNorm() / (sample.sigma * sample.sigma);
}

void addSequence(const SimulatedSequence& sequence, Errors* errors) {
  ErrorsOfImages images;
  for (const TrackSample& sample : trackScene(sceneOf(sequence), sequence.size(), 5)) {
    if (sample.hidden) continue;
    errors->count += 1.0;
    addPace(sample, errors);
    if (!(sample.error.norm() < kGross)) {
      errors->gross += 1.0;
      continue;
    }
    errors->z2 += 0.5 * sample.error.squaredNorm() / (sample.sigma * sample.sigma);
    images[sample.image][sample.id] = sample.error;
  }
  for (const auto& [image, here] : images) addImage(images, image, here, errors);
}

void print(const Errors& errors) {
  std::printf("%.0f measurements, %.2f %% off by more than %.0f px; the others' rms z %.2f\n",
              errors.count, 100.0 * errors.gross / errors.count, kGross,
              std::sqrt(errors.z2 / (errors.count - errors.gross)));
  std::printf("| images between | pairs | correlation |\n|---|---|---|\n");
  for (std::size_t l = 0; l < kLags.size(); ++l) {
    std::printf("| %d | %.0f | %.3f |\n", kLags[l], errors.along_track[l].count,
                errors.along_track[l].correlation());
  }
  std::printf("| same image, other track | %.0f | %.4f |\n", errors.between_tracks.count,
              errors.between_tracks.correlation());
}

void printPaces(const Errors& errors) {
  std::printf(
      "| pace, at most [px per image] | measurements | off by more than a pixel [%%] | rms error "
      "[px] | rms sigma [px] | rms z |\n|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < kPaces.size(); ++i) {
    const PaceErrors& at = errors.by_pace[i];
    const double fair = at.count - at.gross;
    if (!(fair > 0.0)) continue;
    // The last pace has no upper end.
    const std::string pace = kPaces[i] < 1e6 ? std::to_string(std::lround(kPaces[i])) : "more";
    std::printf("| %s | %.0f | %.2f | %.4f | %.4f | %.2f |\n", pace.c_str(), at.count,
                100.0 * at.gross / at.count, std::sqrt(at.square / fair),
                std::sqrt(at.sigma2 / fair), std::sqrt(at.z2 / fair));
  }
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  const int sequences = argc > 1 ? std::atoi(argv[1]) : 8;
  const double seconds = argc > 2 ? std::atof(argv[2]) : 10.0;
  const double exposure_s = argc > 3 ? std::atof(argv[3]) : 0.0;
  const double speed = argc > 4 ? std::atof(argv[4]) : 1.0;
  if (sequences < 1 || !(seconds > 1.0) || !(exposure_s >= 0.0) || !(speed > 0.0)) {
    std::fprintf(stderr, "usage: %s [SEQUENCES [SECONDS [EXPOSURE_S [SPEED]]]]\n", argv[0]);
    return 1;
  }
  Errors errors;
  for (int i = 0; i < sequences; ++i) {
    const auto model = static_cast<CameraModel>(i % 4);
    SequenceOptions options = randomSequence(model, seconds, i, "").options;
    options.renderer.exposure_s = exposure_s;
    options.motion.speed *= speed;
    addSequence(SimulatedSequence(options), &errors);
  }
  print(errors);
  printPaces(errors);
  return 0;
}
