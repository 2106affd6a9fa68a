#include "benchmark/rough_sequence.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <opencv2/imgcodecs.hpp>

#include "benchmark/random_sequence.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr double kGainChange = 0.5;  // of the logarithm
constexpr int kLongestRun = 10;

// Pixel centres lie at integer coordinates.
Camera scaled(const Camera& camera, double scale) {
  Intrinsics parameters = camera.parameters();
  parameters.head<2>() *= scale;
  parameters.segment<2>(2) =
      (scale * (parameters.segment<2>(2).array() + 0.5) - 0.5).matrix().eval();
  return Camera(camera.model(), static_cast<int>(std::lround(scale * camera.width())),
                static_cast<int>(std::lround(scale * camera.height())), parameters);
}

SequenceOptions sequenceOf(const RoughVideo& video, const Roughness& roughness) {
  SequenceOptions options = randomSequence(video.model, video.duration_s, video.seed, "").options;
  options.rate_hz = video.rate_hz;
  options.lens.camera = scaled(options.lens.camera, video.scale);
  options.motion.speed *= roughness.motion_speed;
  RendererOptions& renderer = options.renderer;
  renderer.line_delay_s = roughness.readout_s / (options.lens.camera.height() - 1);
  renderer.exposure_s = roughness.exposure_s;
  renderer.sensor.noise_sigma = roughness.noise_sigma;
  renderer.sensor.vignetting = roughness.vignetting;
  options.objects.share = std::max(roughness.moving_share, roughness.carried_share);
  options.objects.carried = roughness.carried_share > 0.0;
  options.objects.seed = video.seed;
  options.text_overlay = roughness.text_overlay;
  options.auto_exposure = roughness.auto_exposure;
  return options;
}

/// What happens to the images one after the other, by chance.
class Chance {
 public:
  Chance(const RoughVideo& video, const Roughness& roughness)
      : roughness_(roughness), rate_hz_(video.rate_hz), random_(mixSeed(video.seed, 91)) {}

  bool drops() {
    const double mean_run = 0.5 * (1 + 0.5 * (1 + kLongestRun));  // half of them are single
    if (to_drop_ == 0 && random_.chance(roughness_.dropped_share / mean_run)) {
      to_drop_ = random_.chance(0.5) ? 1 : random_.integer(1, kLongestRun);
    }
    if (to_drop_ == 0) return false;
    --to_drop_;
    return true;
  }

  double gain() {
    if (roughness_.exposure_jumps_s > 0.0 &&
        random_.chance(1.0 / (rate_hz_ * roughness_.exposure_jumps_s))) {
      gain_ = std::exp(random_.uniform(-kGainChange, kGainChange));
    }
    return gain_;
  }

 private:
  Roughness roughness_;
  double rate_hz_;
  Random random_;
  int to_drop_ = 0;
  double gain_ = 1.0;
};

}  // namespace

std::vector<Roughness> roughnessKinds() {
  std::deque<Roughness> kinds;  // whose references stay valid
  const auto add = [&kinds](const char* name) -> Roughness& {
    kinds.emplace_back();
    kinds.back().name = name;
    return kinds.back();
  };
  add("none");
  add("rolling 10 ms").readout_s = 0.010;
  add("rolling 15 ms").readout_s = 0.015;
  add("rolling 30 ms").readout_s = 0.030;
  add("exposure jumps").exposure_jumps_s = 0.7;
  add("blur 20 ms").exposure_s = 0.020;
  add("noise 10").noise_sigma = 10.0;
  add("vignetting 70 %").vignetting = 0.7;
  add("JPEG quality 20").jpeg_quality = 20;
  add("25 % dropped").dropped_share = 0.25;
  add("fast").motion_speed = 2.5;
  Roughness& fast_and_blurred = add("fast and blurred");
  fast_and_blurred.motion_speed = 2.0;
  fast_and_blurred.exposure_s = 0.020;
  add("moving 5 %").moving_share = 0.05;
  add("moving 15 %").moving_share = 0.15;
  add("moving 30 %").moving_share = 0.30;
  add("carried 5 %").carried_share = 0.05;
  add("carried 15 %").carried_share = 0.15;
  add("carried 30 %").carried_share = 0.30;
  add("text overlay").text_overlay = true;
  add("automatic exposure").auto_exposure = true;
  Roughness& all = add("all of it");
  all.readout_s = 0.015;
  all.exposure_s = 0.010;
  all.noise_sigma = 5.0;
  all.vignetting = 0.5;
  all.exposure_jumps_s = 1.0;
  all.jpeg_quality = 40;
  all.dropped_share = 0.1;
  return {kinds.begin(), kinds.end()};
}

Camera renderRough(const RoughVideo& video, const Roughness& roughness,
                   const std::function<void(const ImageView&)>& take) {
  const SimulatedSequence sequence(sequenceOf(video, roughness));
  Chance chance(video, roughness);
  for (int i = 0; i < sequence.size(); ++i) {
    const double gain = chance.gain();
    if (chance.drops()) continue;
    SimulatedFrame frame = sequence.frame(i);
    if (gain != 1.0) frame.image.convertTo(frame.image, -1, gain);
    if (roughness.jpeg_quality > 0) {
      std::vector<unsigned char> bytes;
      cv::imencode(".jpg", frame.image, bytes, {cv::IMWRITE_JPEG_QUALITY, roughness.jpeg_quality});
      frame.image = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
    }
    take(frame.view());
  }
  return sequence.camera(0);
}

}  // namespace camera_self_calibration
