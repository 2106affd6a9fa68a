#include "camera_self_calibration/lens_change/lens_step.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/lens_change/lens_drift.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kMinSegments = 4;
// Standard deviations of the focal length's relative change.
constexpr double kSizes[] = {1e-3, 3e-3, 1e-2, 3e-2, 1e-1};
// Twice the logarithm of the likelihood ratio of a step to a drift.
constexpr double kClearly = 4.0;
// p-value of a constant lens that has to be left without any one of the segments.
constexpr double kWithoutAny = 1e-2;

enum class Course { kStep, kRamp };

double middle(const QuadraticLikelihood& segment) {
  return 0.5 * (static_cast<double>(segment.begin_ns) + static_cast<double>(segment.end_ns));
}

// Twice the logarithm of the mean of likelihood ratios, given by their logarithms.
double meanEvidence(const std::vector<double>& log_ratios) {
  const double most = *std::max_element(log_ratios.begin(), log_ratios.end());
  double sum = 0.0;
  for (const double log_ratio : log_ratios) sum += std::exp(log_ratio - most);
  return 2.0 * (most + std::log(sum / static_cast<double>(log_ratios.size())));
}

// Restricted likelihoods of courses of the focal length with one unknown, its size, against that of
// a constant lens; in the order of time.
class Courses {
 public:
  Courses(const std::vector<QuadraticLikelihood>& segments, const Camera& camera,
          std::int64_t now_ns);

  // Over all beginnings and sizes; not above 0 where all segments together tell no lens.
  double evidenceOf(Course course) const;
  // Number of segments before the likeliest step.
  std::size_t likeliestStep() const;

 private:
  std::vector<double> logRatios(Course course, std::size_t before) const;
  double misfit(double left) const {  // -2 log likelihood, as in estimateDrift
    const double variance = std::max(1.0, left / freedom_);
    return freedom_ * std::log(variance) + left / variance;
  }

  Intrinsics direction_;  // of the intrinsics, per relative change of the focal length
  std::vector<double> ages_;
  std::vector<Intrinsics> gradients_;
  std::vector<Intrinsics> along_;  // information times direction
  Intrinsics gradient_;
  std::optional<IntrinsicsMatrix> covariance_;
  double left_ = 0.0;  // of chi-square, for a constant lens
  double freedom_ = 1.0;
};

Courses::Courses(const std::vector<QuadraticLikelihood>& segments, const Camera& camera,
                 std::int64_t now_ns) {
  const Intrinsics point = camera.parameters().head(camera.estimatedCount());
  direction_ = alongFocalLength(point);
  gradient_ = Intrinsics::Zero(point.size());
  IntrinsicsMatrix information = IntrinsicsMatrix::Zero(point.size(), point.size());
  for (const QuadraticLikelihood& segment : segments) {
    ages_.push_back(std::max(0.0, static_cast<double>(now_ns) - middle(segment)));
    gradients_.push_back(segment.gradientAt(point));
    along_.emplace_back(segment.information * direction_);
    information += segment.information;
    gradient_ += gradients_.back();
    left_ += squaredDistance(gradients_.back(), segment.information);
  }
  freedom_ = static_cast<double>((static_cast<std::ptrdiff_t>(segments.size()) - 1) * point.size());
  covariance_ = covarianceFromInformation(information);
  if (covariance_) left_ = std::max(0.0, left_ - gradient_.dot(*covariance_ * gradient_));
}

// One for each size, of a change that begins after so many segments.
std::vector<double> Courses::logRatios(Course course, std::size_t before) const {
  Intrinsics along = Intrinsics::Zero(direction_.size());
  double square = 0.0, slope = 0.0;
  for (std::size_t i = 0; i < ages_.size(); ++i) {
    const double ramp = course == Course::kRamp ? ages_[i] / ages_[before - 1] : 0.0;
    const double weight = i < before ? 1.0 : ramp;
    along += weight * along_[i];
    square += weight * weight * direction_.dot(along_[i]);
    slope += weight * direction_.dot(gradients_[i]);
  }
  square -= along.dot(*covariance_ * along);
  slope -= along.dot(*covariance_ * gradient_);
  std::vector<double> ratios;
  for (const double size : kSizes) {
    const double widening = 1.0 + size * size * std::max(0.0, square);
    const double explained = size * size * slope * slope / widening;
    ratios.push_back(
        0.5 * (misfit(left_) - misfit(std::max(0.0, left_ - explained)) - std::log(widening)));
  }
  return ratios;
}

double Courses::evidenceOf(Course course) const {
  if (!covariance_ || ages_.size() < 2) return 0.0;
  std::vector<double> all;
  for (std::size_t before = 1; before < ages_.size(); ++before) {
    const std::vector<double> ratios = logRatios(course, before);
    all.insert(all.end(), ratios.begin(), ratios.end());
  }
  return meanEvidence(all);
}

std::size_t Courses::likeliestStep() const {
  std::vector<double> evidence;
  for (std::size_t before = 1; before < ages_.size(); ++before) {
    evidence.push_back(meanEvidence(logRatios(Course::kStep, before)));
  }
  return 1 + static_cast<std::size_t>(std::max_element(evidence.begin(), evidence.end()) -
                                      evidence.begin());
}

// Those of the camera's model, in the order of time.
std::vector<QuadraticLikelihood> inOrder(std::vector<QuadraticLikelihood> segments,
                                         const Camera& camera) {
  const auto of_other_model = [&](const QuadraticLikelihood& segment) {
    return segment.point.size() != camera.estimatedCount();
  };
  segments.erase(std::remove_if(segments.begin(), segments.end(), of_other_model), segments.end());
  std::sort(segments.begin(), segments.end(),
            [](const QuadraticLikelihood& a, const QuadraticLikelihood& b) {
              return middle(a) < middle(b);
            });
  return segments;
}

// Of a random walk or of a ramp, whichever is the likelier.
double evidenceOfDrift(const Courses& courses, const std::vector<QuadraticLikelihood>& segments,
                       const Camera& camera, std::int64_t now_ns) {
  return std::max(courses.evidenceOf(Course::kRamp), driftEvidence(segments, camera, now_ns));
}

double pValueOf(double evidence) { return std::exp(-0.5 * std::max(0.0, evidence)); }

// No single segment may decide: one that shows something that moves is not the lens's.
bool holdsWithoutAny(const std::vector<QuadraticLikelihood>& segments, const Camera& camera,
                     std::int64_t now_ns) {
  for (std::size_t i = 0; i < segments.size(); ++i) {
    std::vector<QuadraticLikelihood> others = segments;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const double evidence = Courses(others, camera, now_ns).evidenceOf(Course::kStep);
    if (!(pValueOf(evidence) < kWithoutAny)) return false;
  }
  return true;
}

// What was seen since the step, in all intrinsics.
void describeNow(const std::vector<QuadraticLikelihood>& segments, std::size_t before,
                 LensStep* step) {
  const Intrinsics point = step->camera.parameters().head(step->camera.estimatedCount());
  Intrinsics gradient = Intrinsics::Zero(point.size());
  step->information = IntrinsicsMatrix::Zero(point.size(), point.size());
  for (std::size_t i = before; i < segments.size(); ++i) {
    gradient += segments[i].gradientAt(point);
    step->information += segments[i].information;
  }
  Intrinsics parameters = step->camera.parameters();
  parameters.head(point.size()) +=
      step->information.completeOrthogonalDecomposition().solve(gradient);
  step->camera.setParameters(parameters);
}

}  // namespace

std::optional<LensStep> estimateStep(std::vector<QuadraticLikelihood> segments,
                                     const Camera& camera, std::int64_t now_ns, double limit) {
  segments = inOrder(std::move(segments), camera);
  if (segments.size() < kMinSegments) return std::nullopt;
  const Courses courses(segments, camera, now_ns);
  const double evidence = courses.evidenceOf(Course::kStep);
  LensStep step;
  step.p_value = pValueOf(evidence);
  if (!(step.p_value < limit)) return std::nullopt;
  const double drift = evidenceOfDrift(courses, segments, camera, now_ns);
  if (!(evidence - drift > kClearly) || !holdsWithoutAny(segments, camera, now_ns)) {
    return std::nullopt;
  }
  const std::size_t before = courses.likeliestStep();
  step.onset_ns = segments[before].begin_ns;
  step.camera = camera;
  describeNow(segments, before, &step);
  if (!step.camera.valid()) return std::nullopt;
  return step;
}

bool showsDrift(std::vector<QuadraticLikelihood> segments, const Camera& camera,
                std::int64_t now_ns) {
  segments = inOrder(std::move(segments), camera);
  if (segments.size() < kMinSegments) return false;
  const Courses courses(segments, camera, now_ns);
  const double drift = evidenceOfDrift(courses, segments, camera, now_ns);
  return drift > kClearly && !(courses.evidenceOf(Course::kStep) - drift > kClearly);
}

}  // namespace camera_self_calibration
