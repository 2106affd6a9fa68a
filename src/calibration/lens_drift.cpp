#include "camera_self_calibration/calibration/lens_drift.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "camera_self_calibration/estimation/pseudo_inverse.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kMinStretches = 4;
// Standard deviations of the relative change over one minute: more is no drift.
constexpr double kRates[] = {0.0, 3e-4, 6e-4, 1.2e-3, 2.5e-3, 5e-3, 1e-2, 2e-2};
// Twice the logarithm of the likelihood ratio: by chance in one of fifty queues.
constexpr double kSignificant = 4.0;

double minutesAgo(const Evidence& stretch, std::int64_t now_ns) {
  const double middle = 0.5 * (static_cast<double>(stretch.begin_ns - now_ns) +
                               static_cast<double>(stretch.end_ns - now_ns));
  return std::max(0.0, -middle / 60e9);
}

// What the stretches say, newest first, and the walk that leads back to each of them.
struct Course {
  std::vector<Evidence> stretches;
  std::vector<double> minutes;  // ago
  Intrinsics point;
  Intrinsics direction;  // of the intrinsics per relative change of the focal length
  double square = 0.0;   // sum of d^T I d, d the stretch's own estimate from `point`

  int count() const { return static_cast<int>(point.size()); }
  int size() const { return static_cast<int>(stretches.size()); }
  int freedom() const { return (size() - 1) * count(); }
};

Course courseOf(std::vector<Evidence> stretches, const Camera& camera, std::int64_t now_ns) {
  Course course;
  course.point = camera.parameters().head(camera.estimatedCount());
  course.direction = Intrinsics::Zero(course.count());
  course.direction.head<2>() = course.point.head<2>();
  std::sort(stretches.begin(), stretches.end(), [&](const Evidence& a, const Evidence& b) {
    return minutesAgo(a, now_ns) < minutesAgo(b, now_ns);
  });
  for (Evidence& stretch : stretches) {
    if (stretch.point.size() != course.count()) continue;
    const Eigen::VectorXd gradient = stretch.gradientAt(course.point);
    const Eigen::MatrixXd information = stretch.information;
    course.square += gradient.dot(information.completeOrthogonalDecomposition().solve(gradient));
    course.minutes.push_back(minutesAgo(stretch, now_ns));
    course.stretches.push_back(std::move(stretch));
  }
  return course;
}

struct Fit {
  double misfit = std::numeric_limits<double>::infinity();  // -2 log likelihood
  Eigen::VectorXd now;                                      // from the point
  Eigen::MatrixXd covariance;
};

// Unknowns: the intrinsics now, then the walk's independent steps back to each stretch, each of
// variance 1.
Fit fitWalk(const Course& course, double rate) {
  const int c = course.count();
  const int n = course.size();
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(c + n, c + n);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(c + n);
  hessian.diagonal().tail(n).setOnes();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(c, c + n);
  jacobian.leftCols(c).setIdentity();
  for (int i = 0; i < n; ++i) {
    const double step = course.minutes[i] - (i > 0 ? course.minutes[i - 1] : 0.0);
    jacobian.col(c + i) = rate * std::sqrt(step) * course.direction;
    const Evidence& stretch = course.stretches[i];
    hessian += jacobian.transpose() * stretch.information * jacobian;
    gradient += jacobian.transpose() * stretch.gradientAt(course.point);
  }
  const Eigen::VectorXd scale = hessian.diagonal().unaryExpr(&inverseRoot);
  const Eigen::LLT<Eigen::MatrixXd> factor(scale.asDiagonal() * hessian * scale.asDiagonal());
  Fit fit;
  if (factor.info() != Eigen::Success) return fit;
  const Eigen::MatrixXd lower = factor.matrixL();
  const double log_determinant =
      2.0 * (lower.diagonal().array().log().sum() - scale.array().log().sum());
  const Eigen::MatrixXd inverse =
      scale.asDiagonal() * factor.solve(Eigen::MatrixXd(scale.asDiagonal()));
  const Eigen::VectorXd best = inverse * gradient;
  const double square = std::max(0.0, course.square - gradient.dot(best));
  // The factor of all variances that is likeliest, as stretches may disagree in everything.
  const double variance = std::max(1.0, square / course.freedom());
  fit.misfit = course.freedom() * std::log(variance) + log_determinant + square / variance;
  fit.now = best.head(c);
  fit.covariance = variance * inverse.topLeftCorner(c, c);
  return fit;
}

}  // namespace

LensDrift estimateDrift(const std::vector<Evidence>& queue, const std::vector<Evidence>& others,
                        const Camera& camera, std::int64_t now_ns) {
  LensDrift drift;
  if (queue.size() + others.size() < kMinStretches || queue.size() < 2) return drift;
  std::vector<Evidence> all = queue;
  all.insert(all.end(), others.begin(), others.end());
  const Course course = courseOf(std::move(all), camera, now_ns);
  if (course.freedom() <= 0) return drift;
  const Fit still = fitWalk(course, 0.0);
  Fit best = still;
  for (const double rate : kRates) {
    const Fit fit = fitWalk(course, rate);
    if (!(fit.misfit < best.misfit)) continue;
    best = fit;
    drift.rate = rate;
  }
  if (!(still.misfit - best.misfit > kSignificant)) return LensDrift();
  const Fit joint = fitWalk(courseOf(queue, camera, now_ns), 0.0);
  if (joint.now.size() != best.now.size()) return LensDrift();
  drift.offset = best.now - joint.now;
  drift.covariance = best.covariance;
  Intrinsics parameters = camera.parameters();
  parameters.head(drift.offset.size()) += drift.offset;
  Camera now = camera;
  now.setParameters(parameters);
  drift.significant = now.valid();
  return drift;
}

}  // namespace camera_self_calibration
