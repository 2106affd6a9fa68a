#include "camera_self_calibration/fleet/siblings.h"

#include <map>
#include <optional>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/holm.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/fleet/spread.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kEnough = 3;

Estimate estimateOf(const Sibling& camera) {
  return {camera.lens.parameters().head(camera.lens.estimatedCount()), camera.covariance, 0};
}

void compareWithin(const std::vector<Sibling>& cameras, const std::vector<std::size_t>& members,
                   std::vector<SiblingVerdict>* verdicts) {
  const Camera& lens = cameras[members.front()].lens;
  const EstimateSum none(lens.parameters().head(lens.estimatedCount()), pixelUnit(lens));
  EstimateSum all = none;
  for (const std::size_t i : members) all.add(estimateOf(cameras[i]));
  for (const std::size_t i : members) {
    EstimateSum own = none, others = all;
    own.add(estimateOf(cameras[i]));
    others -= own;
    const Difference found = difference(own, others);
    Camera mean = lens;
    Intrinsics values = lens.parameters();
    values.head(lens.estimatedCount()) = others.mean();
    mean.setParameters(values);
    SiblingVerdict& verdict = (*verdicts)[i];
    verdict.siblings = static_cast<int>(members.size()) - 1;
    verdict.distance_px = pixelDistance(cameras[i].lens, mean).rms;
    verdict.spread_px = found.tau_px;
    verdict.p_value = found.p_value;
  }
}

}  // namespace

std::string typeOf(const Sibling& camera) {
  const std::size_t slash = camera.name.rfind('/');
  if (slash == std::string::npos) return "";
  return camera.name.substr(slash + 1) + ", " + toString(camera.lens.model()) +
         (camera.lens.estimatedCount() == kMaxIntrinsics ? " with k3, " : ", ") +
         sizeText(camera.lens.width(), camera.lens.height());
}

std::vector<SiblingVerdict> compareSiblings(const std::vector<Sibling>& cameras, double level) {
  std::vector<SiblingVerdict> verdicts(cameras.size());
  std::map<std::string, std::vector<std::size_t>> types;
  for (std::size_t i = 0; i < cameras.size(); ++i) types[typeOf(cameras[i])].push_back(i);
  std::vector<std::size_t> tested;
  for (const auto& [type, members] : types) {
    if (type.empty() || members.size() < kEnough) continue;
    compareWithin(cameras, members, &verdicts);
    tested.insert(tested.end(), members.begin(), members.end());
  }
  std::vector<double> p_values;
  p_values.reserve(tested.size());
  for (const std::size_t i : tested) p_values.push_back(verdicts[i].p_value);
  const std::vector<bool> rejected = rejectedByHolm(p_values, level);
  for (std::size_t i = 0; i < tested.size(); ++i) verdicts[tested[i]].outlier = rejected[i];
  return verdicts;
}

}  // namespace camera_self_calibration
