#include "camera_self_calibration/simulation/simulated_sequence.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/text_overlay.h"

namespace camera_self_calibration {
namespace {

SequenceOptions checked(const SequenceOptions& options) {
  std::string message;
  for (const std::string& problem : options.problems()) message += problem + "; ";
  if (!message.empty()) throw std::invalid_argument("simulated sequence: " + message);
  return options;
}

Trajectory trajectoryOf(const SequenceOptions& options) {
  if (options.trajectory) return mounted(*options.trajectory, options.mount);
  SyntheticMotionOptions motion = options.motion;
  motion.box = makeRoom(options.room).free_space;
  motion.duration_s = options.duration_s;
  return mounted(syntheticMotion(motion), options.mount);
}

}  // namespace

std::vector<std::string> SequenceOptions::problems() const {
  std::vector<std::string> found = room.problems();
  for (const std::string& problem : objects.problems()) found.push_back(problem);
  for (const std::string& problem : renderer.problems()) found.push_back(problem);
  if (!(rate_hz > 0.0 && rate_hz <= 1000.0)) found.push_back("rate_hz must be in (0, 1000]");
  if (!(duration_s > 0.0 && duration_s <= 1e5)) found.push_back("duration_s must be in (0, 1e5]");
  if (!(lens.zoom > 0.1 && lens.zoom < 10.0)) found.push_back("the zoom must be in (0.1, 10)");
  if (!lens.camera.valid() || lens.camera.width() < 1 || lens.camera.height() < 1) {
    found.push_back("the simulated camera needs a size and valid parameters");
  }
  return found;
}

ImageView SimulatedFrame::view() const {
  ImageView view;
  view.owner = std::make_shared<cv::Mat>(image);  // shares the pixels
  view.data = image.data;
  view.width = image.cols;
  view.height = image.rows;
  view.stride = static_cast<int>(image.step);
  view.stamp_ns = stamp_ns;
  return view;
}

SimulatedSequence::SimulatedSequence(const SequenceOptions& options)
    : options_(checked(options)),
      trajectory_(trajectoryOf(options)),
      world_(std::make_shared<PaintedWorld>(
          makeRoom(options.room),
          movingObjects(options.objects, options.lens.camera, trajectory_))),
      size_(1 + static_cast<int>(std::min(options.duration_s, trajectory_.duration()) *
                                 options.rate_hz)),
      renderer_(world_, options.lens.camera, options.renderer) {
  if (options.lens.zoom_at_s) {
    zoomed_.emplace(world_, options.lens.at(*options.lens.zoom_at_s), options.renderer);
  }
}

std::int64_t SimulatedSequence::stampNs(int index) const {
  return options_.start_stamp_ns + std::llround(1e9 * time(index));
}

SimulatedFrame SimulatedSequence::frame(int index) const {
  SimulatedFrame frame;
  frame.stamp_ns = stampNs(index);
  frame.world_from_camera = worldFromCamera(index);
  frame.camera = camera(index);
  if (options_.auto_exposure) {
    while (static_cast<int>(gains_.size()) <= index) {
      meter(exposed(static_cast<int>(gains_.size()) - 1));
    }
  }
  frame.image = exposed(index);
  if (options_.auto_exposure && index + 1 == static_cast<int>(gains_.size())) meter(frame.image);
  if (options_.text_overlay) writeOverlay(time(index), &frame.image);
  return frame;
}

cv::Mat SimulatedSequence::exposed(int index) const {
  const Renderer& renderer = options_.lens.zoomed(time(index)) ? *zoomed_ : renderer_;
  const std::uint64_t seed = mixSeed(options_.noise_seed, static_cast<std::uint64_t>(index));
  const double gain = options_.auto_exposure ? gains_[static_cast<std::size_t>(index)] : 1.0;
  return renderer.render(trajectory_, time(index), seed, gain);
}

void SimulatedSequence::meter(const cv::Mat& image) const {
  exposure_.see(image);
  gains_.push_back(exposure_.gain());
}

}  // namespace camera_self_calibration
