#include "camera_self_calibration/lens_change/setting_archive.h"

#include <utility>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/queue/agreement.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kMaxSettings = 4;  // each keeps a queue: bounded memory
// p-value: what is not recalled is only learnt again, a wrong one would have to be undone.
constexpr double kDifferent = 0.05;

}  // namespace

void SettingArchive::store(Setting setting) {
  if (!setting.queue.solution().usable) return;
  settings_.push_back(std::move(setting));
  if (settings_.size() > kMaxSettings) settings_.pop_front();
}

std::optional<Setting> SettingArchive::recall(const Camera& camera,
                                              const IntrinsicsMatrix& information,
                                              const ImageField& field, double max_distance_px) {
  QuadraticLikelihood likelihood;
  likelihood.point = camera.parameters().head(camera.estimatedCount());
  likelihood.gradient = Intrinsics::Zero(likelihood.point.size());
  likelihood.information = information;
  auto nearest = settings_.end();
  double least = max_distance_px;
  for (auto setting = settings_.begin(); setting != settings_.end(); ++setting) {
    const QueueSolution& solution = setting->queue.solution();
    if (solution.camera.model() != camera.model() ||
        solution.information.rows() != information.rows()) {
      continue;
    }
    const double distance = pixelDistance(solution.camera, camera, field).rms;
    const Reference reference{solution.camera, solution.information, Scatter()};
    if (!(distance < least) || agreement({likelihood}, reference).p_value < kDifferent) continue;
    least = distance;
    nearest = setting;
  }
  if (nearest == settings_.end()) return std::nullopt;
  Setting found = std::move(*nearest);
  settings_.erase(nearest);
  return found;
}

}  // namespace camera_self_calibration
