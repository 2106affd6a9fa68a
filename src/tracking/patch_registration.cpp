#include "camera_self_calibration/tracking/patch_registration.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "camera_self_calibration/tracking/secant_steps.h"

namespace camera_self_calibration {
namespace {

constexpr int kMaxIterations = 15;
// The last step, of the anchor: this share of the sigma that noise gives it, but no less than [px]
// what interpolation is good for.
constexpr double kConvergedShare = 0.1;
constexpr double kConvergedShift = 0.004;
// What the patch does not determine of the linear part may creep on: the rim's step against the
// anchor's.
constexpr double kRimOverAnchor = 25.0;
constexpr double kMaxShift = 4.0;  // [px] From the start: further away is another corner.
constexpr float kSlack = 2.0f;     // [px] By which the patch may move without a new window.

constexpr double kMinScale = 0.5;
constexpr double kMaxScale = 3.0;
constexpr double kMaxStretch = 3.0;  // Ratio of the singular values of the warp.

// Variance of a camera pixel's own blur, area and optics, assumed [px^2].
constexpr double kPixelBlur = 0.2;
// Above this scale the next level of the pyramid has still at least the resolution needed.
constexpr double kMaxScaleOfLevel = 1.6;

// Blur of the reference, and the scale above which the image is sharp enough to be compared at it.
struct BlurStep {
  double blur;
  double min_scale;
};
constexpr std::array<BlurStep, 3> kBlurSteps = {{{0.3, 0.8}, {0.9, 0.61}, {1.8, 0.0}}};
constexpr double kBlurHysteresis = 1.1;

// Blurs more as soon as the scale asks for it, less only when it has grown well above.
double referenceBlur(double scale, double current) {
  for (const BlurStep& step : kBlurSteps) {
    const double margin = step.blur < current ? kBlurHysteresis : 1.0;
    if (scale >= step.min_scale * margin) return step.blur;
  }
  return kBlurSteps.back().blur;
}

bool deformed(const Eigen::Matrix2d& linear) {
  const double determinant = linear.determinant();
  if (!(determinant > kMinScale * kMinScale) || determinant > kMaxScale * kMaxScale) return true;
  // s1^2 + s2^2 = |A|^2 and s1 s2 = det A, hence s1/s2 + s2/s1:
  return linear.squaredNorm() / determinant > kMaxStretch + 1.0 / kMaxStretch;
}

// Half width and height of the patch in the image.
Eigen::Vector2f extent(const Eigen::Matrix2d& linear) {
  return (PatchPoints::kDiscRadius * linear.rowwise().norm()).cast<float>();
}

bool inside(const Warp& warp, const cv::Mat& image) {
  const Eigen::Vector2f centre = warp.pixel.cast<float>();
  const Eigen::Vector2f half = extent(warp.linear);
  return ((centre - half).array() >= 0.0f).all() &&
         centre.x() + half.x() <= static_cast<float>(image.cols - 1) &&
         centre.y() + half.y() <= static_cast<float>(image.rows - 1);
}

Warp scaled(const Warp& warp, double factor) { return {factor * warp.pixel, factor * warp.linear}; }

// The warp after the reference was found to be displaced by `step`: W o step^-1.
Warp compose(const Warp& warp, const WarpStep& step) {
  Eigen::Matrix2d linear;
  linear << 1.0 + step(2), step(4), step(3), 1.0 + step(5);
  Warp next;
  next.linear = warp.linear * linear.inverse();
  next.pixel = warp.pixel - next.linear * step.head<2>();
  return next;
}

// What the prior adds to the right-hand side: it holds the linear part to that of the start.
ReferencePatch::Vector priorPull(const ReferencePatch& reference, const Warp& start,
                                 const Warp& warp, double gain) {
  const Eigen::Matrix2d deviation =
      Eigen::Matrix2d::Identity() - warp.linear.inverse() * start.linear;
  ReferencePatch::Vector pull = ReferencePatch::Vector::Zero();
  pull.segment<4>(2) = gain * reference.prior().segment<4>(2).cwiseProduct(
                                  Eigen::Map<const Eigen::Vector4d>(deviation.data()));
  return pull;
}

bool converged(const Warp& from, const Warp& to, const Eigen::Vector2d& anchor, double tolerance) {
  const double shift = (to.pixel - from.pixel + (to.linear - from.linear) * anchor).norm();
  const double rim = PatchPoints::kDiscRadius * M_SQRT1_2 * (to.linear - from.linear).norm();
  return shift < tolerance && rim < kRimOverAnchor * tolerance;
}

}  // namespace

bool PatchRegistration::prepare(ReferencePatch* reference) const {
  return reference->prepare(referenceBlur(1.0, reference->blur()), noiseOf(*reference));
}

Registration PatchRegistration::run(ReferencePatch* reference, const ImagePyramid& image,
                                    const Warp& start) {
  Registration result;
  result.warp = start;
  if (!start.pixel.allFinite() || deformed(std::ldexp(1.0, -reference->level()) * start.linear)) {
    result.status = Registration::Status::kDeformed;
    return result;
  }
  double scale = std::sqrt(start.linear.determinant());
  const double blur = referenceBlur(scale, reference->blur());
  if (blur != reference->blur() && !reference->prepare(blur, noiseOf(*reference))) return result;

  int level = 0;
  for (; scale > kMaxScaleOfLevel && level + 1 < image.levels(); ++level) scale *= 0.5;
  result.warp = scaled(start, std::ldexp(1.0, -level));
  result.status = iterate(*reference, image.level(level), &result);
  result.warp = scaled(result.warp, std::ldexp(1.0, level));
  result.pixel *= std::ldexp(1.0, level);
  const Eigen::Matrix2d& linear = result.warp.linear;
  result.unit_covariance =
      linear * reference->anchorCovariance() * linear.transpose() / (result.gain * result.gain);
  return result;
}

bool PatchRegistration::extractWindow(const ReferencePatch& reference, const cv::Mat& level,
                                      const Warp& warp) {
  // Two more pixels for the spline.
  const Eigen::Vector2f half = extent(warp.linear) + Eigen::Vector2f::Constant(kSlack + 2.0f);
  const Eigen::Vector2i low = (warp.pixel.cast<float>() - half).array().floor().cast<int>();
  const Eigen::Vector2i high = (warp.pixel.cast<float>() + half).array().ceil().cast<int>();
  const cv::Rect rectangle(low.x(), low.y(), high.x() - low.x() + 1, high.y() - low.y() + 1);
  // The reference's blur (pixel, spline, own) seen through the warp, less what the image has.
  const double total = kPixelBlur + SmoothWindow::kSplineBlur + reference.blur();
  const Eigen::Vector2d blur = total * warp.linear.rowwise().squaredNorm().array() -
                               (kPixelBlur + SmoothWindow::kSplineBlur);
  return window_.extract(level, rectangle, blur.x(), blur.y());
}

bool PatchRegistration::sampleAt(const Warp& warp) {
  const Eigen::Vector2f half = extent(warp.linear);
  const Eigen::Vector2f centre = warp.pixel.cast<float>();
  if (!window_.covers(centre - half, centre + half)) return false;
  const PatchPoints& points = PatchPoints::get();
  const Eigen::Matrix2f linear = warp.linear.cast<float>();
  for (std::size_t i = 0; i < PatchPoints::kCount; ++i) {
    x_[i] = centre.x() + linear(0, 0) * points.u[i] + linear(0, 1) * points.v[i];
    y_[i] = centre.y() + linear(1, 0) * points.u[i] + linear(1, 1) * points.v[i];
  }
  window_.sample(x_.data(), y_.data(), PatchPoints::kCount, values_.data());
  return true;
}

Registration::Status PatchRegistration::iterate(const ReferencePatch& reference,
                                                const cv::Mat& level, Registration* result) {
  const Warp start = result->warp;
  Warp& warp = result->warp;
  SecantSteps steps;
  const double sigma = std::sqrt(0.5 * noiseOf(reference) * reference.anchorCovariance().trace());
  const double tolerance = std::max(kConvergedShift, kConvergedShare * sigma);
  if (!inside(warp, level)) return Registration::Status::kOutside;
  if (!extractWindow(reference, level, warp)) return Registration::Status::kDeformed;
  for (result->iterations = 1; result->iterations <= kMaxIterations; ++result->iterations) {
    if (!sampleAt(warp) && !(extractWindow(reference, level, warp) && sampleAt(warp))) {
      return Registration::Status::kDeformed;
    }
    for (float& value : values_) value -= reference.mean();
    const ReferencePatch::Vector projected = reference.project(values_.data());
    // The model is linear in all but the warp: the solution holds their full values, not steps.
    const ReferencePatch::Vector solution =
        reference.inverse() * (projected + priorPull(reference, start, warp, result->gain));
    result->gain = solution(ReferencePatch::kGain);
    if (!(result->gain > 0.0)) return Registration::Status::kNotConverged;
    const Warp last = warp;
    warp = compose(warp, steps.next(solution.head<ReferencePatch::kWarp>() / result->gain));
    if (!warp.pixel.allFinite() || deformed(warp.linear)) return Registration::Status::kDeformed;
    if (!inside(warp, level)) return Registration::Status::kOutside;
    if ((warp.pixel - start.pixel).norm() > kMaxShift) return Registration::Status::kNotConverged;
    if (converged(last, warp, reference.anchor(), tolerance)) {
      result->pixel =
          warp.pixel +
          warp.linear * (reference.anchor() - reference.bendingAtAnchor(solution / result->gain));
      measureResidual(reference, projected, solution, result);
      return Registration::Status::kGood;
    }
  }
  return Registration::Status::kNotConverged;
}

void PatchRegistration::measureResidual(const ReferencePatch& reference,
                                        const ReferencePatch::Vector& projected,
                                        const ReferencePatch::Vector& solution,
                                        Registration* result) const {
  const PatchPoints& points = PatchPoints::get();
  double sum = 0.0;
  for (std::size_t i = 0; i < PatchPoints::kCount; ++i) {
    sum += points.weight[i] * values_[i] * values_[i];
  }
  // |v - J s|^2 = |v|^2 - 2 s^T J^T v + s^T J^T J s
  const double residual =
      sum - 2.0 * solution.dot(projected) + solution.dot(reference.hessian() * solution);
  result->residual = std::max(0.0, residual) / points.weight_sum;
  result->contrast = result->gain * result->gain * reference.contrast();
}

}  // namespace camera_self_calibration
