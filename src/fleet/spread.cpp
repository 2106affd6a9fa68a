#include "camera_self_calibration/fleet/spread.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/queue/scatter.h"

namespace camera_self_calibration {
EstimateSum::EstimateSum(const Intrinsics& origin, const IntrinsicsMatrix& unit)
    : origin_(origin),
      unit_(unit),
      information_(IntrinsicsMatrix::Zero(origin.size(), origin.size())),
      information_unit_information_(information_),
      weighted_(Intrinsics::Zero(origin.size())) {}

bool EstimateSum::change(const Estimate& estimate, int sign) {
  if (estimate.value.size() != origin_.size()) return false;
  const auto information = covarianceFromInformation(estimate.covariance);
  if (!information) return false;
  EstimateSum one(origin_, unit_);
  const Intrinsics off = estimate.value - origin_;
  one.count_ = 1;
  one.freedom_ = estimate.freedom;
  one.addInformation(*information);
  one.weighted_ = *information * off;
  one.square_ = off.dot(one.weighted_);
  one.unit_trace_ = (*information * unit_).trace();
  accumulate(one, sign);
  return true;
}

void EstimateSum::addInformation(const IntrinsicsMatrix& information) {
  information_ += information;
  information_unit_information_ += information * unit_ * information;
}

void EstimateSum::accumulate(const EstimateSum& other, int sign) {
  count_ += sign * other.count_;
  freedom_ += sign * other.freedom_;
  information_ += sign * other.information_;
  information_unit_information_ += sign * other.information_unit_information_;
  weighted_ += sign * other.weighted_;
  square_ += sign * other.square_;
  unit_trace_ += sign * other.unit_trace_;
}

EstimateSum& EstimateSum::operator+=(const EstimateSum& other) {
  accumulate(other, 1);
  return *this;
}

EstimateSum& EstimateSum::operator-=(const EstimateSum& other) {
  accumulate(other, -1);
  return *this;
}

Intrinsics EstimateSum::mean() const { return origin_ + covariance() * weighted_; }

IntrinsicsMatrix EstimateSum::ownCovariance() const {
  return covarianceFromInformation(information_)
      .value_or(IntrinsicsMatrix::Zero(origin_.size(), origin_.size()));
}

IntrinsicsMatrix EstimateSum::scatterCovariance(double tau_squared) const {
  const IntrinsicsMatrix own = ownCovariance();
  return tau_squared * (own * information_unit_information_ * own);
}

IntrinsicsMatrix EstimateSum::covariance(double tau_squared) const {
  return ownCovariance() + scatterCovariance(tau_squared);
}

double EstimateSum::chiSquare() const {
  return count_ > 1 ? std::max(0.0, square_ - weighted_.dot(covariance() * weighted_)) : 0.0;
}

int EstimateSum::scatterFreedom() const {
  return std::max(0, count_ - 1) * static_cast<int>(origin_.size());
}

double EstimateSum::scatterSlope() const {
  return count_ > 1 ? unit_trace_ - (covariance() * information_unit_information_).trace() : 0.0;
}

IntrinsicsMatrix pixelUnit(const Camera& camera) {
  const IntrinsicsMatrix metric = pixelMetric(camera);
  const auto inverse = covarianceFromInformation(metric);
  if (!inverse) return IntrinsicsMatrix::Zero(metric.rows(), metric.cols());
  return *inverse / static_cast<double>(metric.rows());
}

double scatterBeyond(const EstimateSum& a, const EstimateSum& b) {
  const double slope = a.scatterSlope() + b.scatterSlope();
  const double excess = a.chiSquare() + b.chiSquare() - (a.scatterFreedom() + b.scatterFreedom());
  return slope > 0.0 ? std::max(0.0, excess / slope) : 0.0;
}

Difference difference(const EstimateSum& a, const EstimateSum& b, double most_tau_squared) {
  Difference result;
  const double tau_squared = std::min(most_tau_squared, scatterBeyond(a, b));
  result.tau_px = std::sqrt(tau_squared);
  const Intrinsics off = a.mean() - b.mean();
  const auto information =
      covarianceFromInformation(a.covariance(tau_squared) + b.covariance(tau_squared));
  if (a.count() == 0 || b.count() == 0 || !information) return result;
  const auto n = static_cast<double>(off.size());
  result.statistic = off.dot(*information * off) / n;
  int freedom = a.scatterFreedom() + b.scatterFreedom();
  if (tau_squared == 0.0) freedom += Scatter::kPriorFreedom + a.freedom() + b.freedom();
  result.p_value = fExceedance(result.statistic, n, std::max(1, freedom));
  return result;
}

double successiveScatter(const std::vector<Estimate>& estimates, const IntrinsicsMatrix& unit) {
  if (estimates.size() < 2) return 0.0;
  const double usual = chiSquareQuantile(static_cast<double>(unit.rows()), 0.5);
  const auto excess = [&](double tau_squared) {
    std::vector<double> squares;
    for (std::size_t i = 1; i < estimates.size(); ++i) {
      const IntrinsicsMatrix covariance =
          estimates[i - 1].covariance + estimates[i].covariance + 2.0 * tau_squared * unit;
      const Intrinsics off = estimates[i].value - estimates[i - 1].value;
      squares.push_back(off.dot(Eigen::MatrixXd(covariance).ldlt().solve(Eigen::VectorXd(off))));
    }
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>((squares.size() - 1) / 2);
    std::nth_element(squares.begin(), middle, squares.end());
    return *middle - usual;
  };
  if (excess(0.0) <= 0.0) return 0.0;
  double low = 0.0, high = 1e-4;
  while (excess(high) > 0.0 && high < 1e8) high *= 4.0;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (low + high);
    (excess(middle) > 0.0 ? low : high) = middle;
  }
  return high;
}

}  // namespace camera_self_calibration
