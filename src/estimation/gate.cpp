#include "camera_self_calibration/estimation/gate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/estimation/transfer.h"
#include "camera_self_calibration/map/segment_edit.h"

namespace camera_self_calibration {
namespace {

// Squared whitened residual of each observation; infinite where it cannot be predicted.
std::vector<double> squaredResiduals(const SegmentBlock& block, const Camera& camera) {
  const Segment& segment = *block.segment;
  std::vector<double> squares(segment.observations.size(), std::numeric_limits<double>::infinity());
  Transfers transfers;
  predictObservations(segment, camera, &transfers,
                      [&](std::size_t o, const Eigen::Vector2d* pixel) {
                        const Observation& observation = segment.observations[o];
                        const double sigma = observation.sigma * block.sigma_scale;
                        if (pixel != nullptr)
                          squares[o] = ((observation.pixel - *pixel) / sigma).squaredNorm();
                      });
  return squares;
}

// How well the measurements of one landmark fit.
struct TrackFit {
  double sum = 0.0;      // of squared whitened residuals
  double largest = 0.0;  // of them
  int observations = 0;
  int freedom = 1;
};

std::vector<TrackFit> trackFits(const SegmentBlock& block, const Camera& camera) {
  const Segment& segment = *block.segment;
  const std::vector<double> squares = squaredResiduals(block, camera);
  std::vector<TrackFit> fits(segment.landmarks.size());
  for (std::size_t o = 0; o < squares.size(); ++o) {
    TrackFit& fit = fits[segment.observations[o].landmark];
    fit.sum += squares[o];
    fit.largest = std::max(fit.largest, squares[o]);
    ++fit.observations;
  }
  for (std::size_t l = 0; l < fits.size(); ++l) {
    const int parameters = segment.landmarks[l].anchored ? 1 : 3;
    fits[l].freedom = std::max(1, 2 * fits[l].observations - parameters);
  }
  return fits;
}

}  // namespace

std::vector<int> misfits(const SegmentBlock& block, const Camera& camera,
                         double exceed_probability) {
  const std::vector<TrackFit> fits = trackFits(block, camera);
  std::vector<int> result;
  // With two degrees of freedom the exceedance is exp(-x / 2).
  const double single = -2.0 * std::log(0.01 * exceed_probability);
  for (std::size_t l = 0; l < fits.size(); ++l) {
    const TrackFit& fit = fits[l];
    if (fit.observations == 0) continue;
    // Written so that a sum that is not finite is a misfit.
    const bool explained = chiSquareExceedance(0.5 * fit.sum, fit.freedom) >= exceed_probability;
    if (!explained || fit.largest > single) result.push_back(static_cast<int>(l));
  }
  return result;
}

std::vector<int> worstTracks(const SegmentBlock& block, const Camera& camera, int count) {
  const std::vector<TrackFit> fits = trackFits(block, camera);
  std::vector<int> order(fits.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return fits[a].sum * fits[b].freedom > fits[b].sum * fits[a].freedom;
  });
  order.resize(std::min<std::size_t>(order.size(), std::max(0, count)));
  return order;
}

std::vector<int> grossMisfits(const SegmentBlock& block, const Camera& camera, double sigmas,
                              double min_px) {
  const Segment& segment = *block.segment;
  const std::vector<double> squares = squaredResiduals(block, camera);
  std::vector<char> gross(segment.landmarks.size(), 0);
  for (std::size_t o = 0; o < squares.size(); ++o) {
    const Observation& observation = segment.observations[o];
    const double limit = std::max(sigmas, min_px / (observation.sigma * block.sigma_scale));
    if (!(squares[o] <= limit * limit)) gross[observation.landmark] = 1;
  }
  std::vector<int> result;
  for (std::size_t l = 0; l < gross.size(); ++l) {
    if (gross[l] != 0) result.push_back(static_cast<int>(l));
  }
  return result;
}

namespace {

constexpr double kMedianOfChiSquare2 = 1.3862943611198906;  // 2 ln 2

// Share of the residuals that the variables leave free.
double freedomShare(const SegmentBlock& block) {
  const double residuals = 2.0 * static_cast<double>(block.segment->observations.size());
  double variables =
      6.0 * (static_cast<double>(block.segment->keyframes.size()) - block.fixed_keyframes);
  for (const Landmark& landmark : block.segment->landmarks) variables += landmark.anchored ? 1 : 3;
  return std::max(0.1, (residuals - variables) / residuals);
}

}  // namespace

double medianResidualScale(const SegmentBlock& block, const Camera& camera) {
  std::vector<double> squares = squaredResiduals(block, camera);
  if (squares.empty()) return 1.0;
  return std::sqrt(medianInPlace(&squares) / kMedianOfChiSquare2 / freedomShare(block));
}

double provisionalScale(const SegmentBlock& block, const Camera& camera) {
  constexpr double kMaxScale = 1000.0;
  const double scale = medianResidualScale(block, camera);
  return std::isfinite(scale) ? std::clamp(scale, 1.0, kMaxScale) : kMaxScale;
}

double unexplainedSigma(const SegmentBlock& block, const Camera& camera) {
  const std::vector<double> squares = squaredResiduals(block, camera);
  if (squares.empty()) return 0.0;
  const double target = kMedianOfChiSquare2 * freedomShare(block);
  std::vector<double> ratios(squares.size());
  const auto medianWith = [&](double extra) {
    for (std::size_t o = 0; o < squares.size(); ++o) {
      const double sigma = block.segment->observations[o].sigma * block.sigma_scale;
      ratios[o] = squares[o] * sigma * sigma / (sigma * sigma + extra * extra);
    }
    return medianInPlace(&ratios);
  };
  if (!(medianWith(0.0) > target)) return 0.0;
  double low = 0.0;
  double high = kUnpredictableResidualPx;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (medianWith(middle) > target ? low : high) = middle;
  }
  return high;
}

GateResult gateSegment(const SegmentBlock& block, const Camera& camera) {
  GateResult result;
  result.unexplained_sigma = unexplainedSigma(block, camera);
  for (Observation& observation : block.segment->observations) {
    observation.sigma = std::hypot(observation.sigma, result.unexplained_sigma);
  }
  const std::vector<int> outliers = misfits(block, camera);
  for (const int l : outliers) {
    result.removed_tracks.push_back(block.segment->landmarks[l].track_id);
  }
  removeLandmarks(outliers, block.segment);
  return result;
}

}  // namespace camera_self_calibration
