#include "camera_self_calibration/queue/line_delay.h"

#include <cmath>
#include <limits>

#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/estimation/linear_segments.h"
#include "camera_self_calibration/estimation/pseudo_inverse.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/estimation/transfer.h"
#include "camera_self_calibration/map/rolling_shutter.h"

namespace camera_self_calibration {
namespace {

// In sigmas: beyond, the shutter rolls without a doubt; and so far the value in use may be off.
constexpr double kSignificant = 5.0;
constexpr double kSmallPart = 0.5;
// Readout times of a whole image [s]: between the profile's points, and what no camera exceeds.
constexpr double kStep = 1e-3;
constexpr double kLongest = 0.1;
constexpr double kTypical = 0.02;  // where the shutter rolls, as half of all do

// The quadratic model of the cost, at its least for one line delay.
struct ProfilePoint {
  double cost = 0.0;
  Eigen::VectorXd intrinsics_step;
};

class Profile {
 public:
  Profile(const std::vector<SegmentBlock>& blocks, const Camera& camera,
          const IntrinsicsPrior& prior, int threads)
      : blocks_(blocks),
        camera_(camera),
        prior_(prior),
        threads_(threads),
        linear_(blocks.size()),
        members_(blocks.size()) {
    for (const SegmentBlock& block : blocks) weighted_.push_back(weighted(block));
  }

  // Which features move with the scene is decided at the first point, for all.
  ProfilePoint at(double line_delay_s) {
    const int count = camera_.estimatedCount();
    parallelFor(threads_, static_cast<int>(blocks_.size()), [&](int i) {
      Segment segment = weighted_[i];
      if (members_[i].empty()) {
        members_[i] = setLineDelayOfScene(line_delay_s, camera_, &segment);
      } else {
        setLineDelayOfScene(line_delay_s, camera_, members_[i], &segment);
      }
      SegmentBlock block = blocks_[i];
      block.segment = &segment;
      linear_[i].linearize(block, camera_, count, 0.0);
      linear_[i].eliminate(0.0);
    });
    ProfilePoint point;
    Eigen::MatrixXd information = prior_.information(camera_.parameters(), count);
    Eigen::VectorXd gradient = prior_.gradient(camera_.parameters(), count);
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      point.cost += linear_[i].reducedCost();
      information += linear_[i].reducedHessian();
      gradient += linear_[i].reducedGradient();
    }
    PseudoInverse inverse;
    inverse.compute(information, LinearSegment::kRankTolerance);
    point.intrinsics_step = inverse.solve(gradient);
    point.cost -= 0.5 * gradient.dot(point.intrinsics_step);
    return point;
  }

 private:
  // The robust weights are part of the sigmas, the same at all points.
  Segment weighted(const SegmentBlock& block) const {
    Segment segment = *block.segment;
    Transfers transfers;
    predictObservations(
        *block.segment, camera_, &transfers, [&](std::size_t o, const Eigen::Vector2d* pixel) {
          Observation& observation = segment.observations[o];
          if (pixel == nullptr) {
            observation.sigma = std::numeric_limits<double>::infinity();
            return;
          }
          const double sigma = observation.sigma * block.sigma_scale;
          const Eigen::Vector2d residual = (observation.pixel - *pixel) / sigma;
          observation.sigma /= HuberLoss(residual.squaredNorm(), SolverOptions().huber).root_weight;
        });
    return segment;
  }

  const std::vector<SegmentBlock>& blocks_;
  const Camera& camera_;
  const IntrinsicsPrior& prior_;
  int threads_;
  std::vector<Segment> weighted_;
  LinearSegments linear_;
  std::vector<SceneMembers> members_;
};

}  // namespace

LineDelayEstimate estimateLineDelay(const std::vector<SegmentBlock>& blocks, const Camera& camera,
                                    const IntrinsicsPrior& prior, int threads) {
  LineDelayEstimate estimate;
  if (blocks.empty() || blocks.front().segment->keyframes.empty()) return estimate;
  const double present = blocks.front().segment->keyframes.front().line_delay_s;
  const double step = kStep / rowSteps(camera.height());
  Profile profile(blocks, camera, prior, threads);
  const ProfilePoint here = profile.at(present);
  const ProfilePoint before = profile.at(present - step);
  const ProfilePoint after = profile.at(present + step);
  const double bend = (before.cost - 2.0 * here.cost + after.cost) / (step * step);
  const double slope = (after.cost - before.cost) / (2.0 * step);
  if (!(bend > 0.0) || !std::isfinite(bend) || !std::isfinite(slope)) return estimate;
  estimate.usable = true;
  estimate.line_delay_s = present - slope / bend;
  estimate.sigma_s = 1.0 / std::sqrt(bend);
  estimate.slope = (after.intrinsics_step - before.intrinsics_step) / (2.0 * step);
  return estimate;
}

Candidate withLineDelay(const Candidate& candidate, double line_delay_s, const Camera& start) {
  Segment segment = candidate.observed.keyframes.empty() ? candidate.segment : candidate.observed;
  if (segment.keyframes.empty() || segment.keyframes.front().line_delay_s == line_delay_s) {
    return candidate;
  }
  setLineDelayOfScene(line_delay_s, start, &segment);
  return evaluateCandidate(CandidateOptions(), segment, start);
}

bool LineDelay::take(const LineDelayEstimate& estimate) {
  if (!estimate.usable || !(std::abs(estimate.line_delay_s) < kLongest / row_steps_)) return false;
  estimate_ = estimate;
  const bool rolls = std::abs(estimate.line_delay_s) > kSignificant * estimate.sigma_s;
  const double wanted = rolls ? estimate.line_delay_s : 0.0;
  settled_ = std::abs(wanted - in_use_s_) <= kSmallPart * estimate.sigma_s;
  if (settled_) return false;
  in_use_s_ = wanted;
  return true;
}

double LineDelay::doubt() const {
  if (!estimate_.usable) return 0.0;
  const double variance = estimate_.sigma_s * estimate_.sigma_s;
  if (in_use_s_ != 0.0) return estimate_.sigma_s;
  const double prior = (kTypical / row_steps_) * (kTypical / row_steps_);
  const double square = estimate_.line_delay_s * estimate_.line_delay_s;
  // Likelihood of the estimate where the shutter rolls over that where it does not, and the mean
  // square of the line delay where it does.
  const double ratio = std::sqrt(variance / (variance + prior)) *
                       std::exp(0.5 * square * (1.0 / variance - 1.0 / (variance + prior)));
  const double share = prior / (prior + variance);
  const double mean_square = share * share * square + share * variance;
  return std::sqrt(mean_square * (1.0 - 1.0 / (1.0 + ratio)));
}

}  // namespace camera_self_calibration
