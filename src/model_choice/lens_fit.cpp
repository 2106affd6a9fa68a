#include "camera_self_calibration/model_choice/lens_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/model_choice/free_displacement.h"

namespace camera_self_calibration {
namespace {

// Share of the image where a ray of `lens` has no pixel under `present`.
double undescribedShare(const Camera& lens, const Camera& present, const ImageField& field) {
  int seen = 0;
  int refused = 0;
  for (int row = 0; row < ImageField::kRows; ++row) {
    for (int column = 0; column < ImageField::kColumns; ++column) {
      if (!field.sees(column, row)) continue;
      ++seen;
      const auto ray = lens.unproject(ImageField::pixel(column, row, lens.width(), lens.height()));
      Eigen::Vector2d pixel;
      if (ray && !present.project(*ray, &pixel)) ++refused;
    }
  }
  return seen > 0 ? static_cast<double>(refused) / seen : 0.0;
}

// The lens is the better one give or take its uncertainty, so that the expected square error of the
// present one is that of their distance and of the better one. The stated uncertainty covers a part
// of it, which is not counted twice.
PixelError beyond(const PixelError& stated, const PixelError& distance, const PixelError& better) {
  const auto left = [](double all, double part, double known) {
    return std::sqrt(std::max(0.0, all * all + part * part - known * known));
  };
  return {left(distance.rms, better.rms, stated.rms), left(distance.max, better.max, stated.max)};
}

PixelError withUndescribed(double share, const PixelError& misfit) {
  if (share <= kNegligibleRim) return misfit;
  return {
      std::hypot(std::sqrt(1.0 - share) * misfit.rms, std::sqrt(share) * kUnpredictableResidualPx),
      std::max(misfit.max, kUnpredictableResidualPx)};
}

// What a richer lens that refutes the present one says of it.
LensFitReport misfitBeside(const QueueSolution& solution, const LensTrial& richer,
                           const IntrinsicsMatrix& covariance, const SeenImage& image) {
  const Camera& now = solution.camera;
  const auto misfit = [&](const ImageField& field) {
    return beyond(pixelUncertainty(now, solution.covariance, field),
                  pixelDistance(now, richer.camera, field),
                  pixelUncertainty(richer.camera, covariance, field));
  };
  LensFitReport report;
  report.undescribed = undescribedShare(richer.camera, now, image.seeing);
  report.misfit = withUndescribed(report.undescribed, misfit(image.seeing));
  report.misfit_observed = misfit(image.observed);
  report.better = report.fits() ? "" : richer.name();
  return report;
}

// What a lens beyond all models says of the present one.
LensFitReport misfitBeside(const QueueSolution& solution, const FreeDisplacement& free,
                           const SeenImage& image) {
  const auto misfit = [&](const ImageField& field) {
    return beyond(pixelUncertainty(solution.camera, solution.covariance, field),
                  free.distance(field), free.uncertainty(field));
  };
  LensFitReport report;
  report.misfit = misfit(image.seeing);
  report.misfit_observed = misfit(image.observed);
  return report;
}

}  // namespace

bool LensFitReport::fits() const { return misfit.rms <= 0.0 && misfit_observed.rms <= 0.0; }

bool LensFitReport::describesImage() const { return undescribed <= kNegligibleRim; }

std::string LensFitReport::sentence() const {
  if (!compared) return "";
  if (fits()) return "no richer lens model fits better than " + model;
  std::string text = model;
  text += describesImage() ? formatted(" misses the lens by %.1f px rms, %.1f px at worst",
                                       misfit.rms, misfit.max)
                           : formatted(" has no ray for %.0f %% of the image", 100.0 * undescribed);
  return text + (better.empty() ? ", and no other model was found to fit"
                                : ", but " + better + " fits it");
}

std::optional<LensComparison> LensFit::consider(std::int64_t keyframes, bool verdict_due,
                                                const std::vector<Candidate>& queue,
                                                const QueueSolution& solution,
                                                const SeenImage& image, int threads) {
  if (keyframes < next_ && !(verdict_due && report_.fits())) return std::nullopt;
  std::vector<std::int64_t> sequences;
  sequences.reserve(queue.size());
  for (const Candidate& candidate : queue) sequences.push_back(candidate.segment.sequence);
  if (!solution.usable || sequences == compared_) return std::nullopt;
  compared_ = std::move(sequences);
  next_ = nextComparison(keyframes);
  report_ = LensFitReport();
  LensComparison comparison =
      compareWithRicher(observationsOf(queue, solution.scatter), solution.camera, threads);
  double best = options_.significance;
  bool refuted = false;
  for (const LensTrial& richer : comparison.richer) {
    const LensKnowledge knowledge = knowledgeOf(comparison.observations, richer, threads);
    const double p_value = leadByChance(richer, comparison.present, knowledge);
    refuted = refuted || p_value <= options_.significance;
    if (knowledge.covariance.size() == 0 || !(p_value <= best)) continue;
    best = p_value;
    report_ = misfitBeside(solution, richer, knowledge.covariance, image);
  }
  if (!refuted) {
    const FreeDisplacement free =
        freeDisplacement(comparison.observations, comparison.present, threads);
    if (free.p_value <= options_.significance) report_ = misfitBeside(solution, free, image);
  }
  report_.compared = true;
  report_.model = toString(solution.camera.model());
  return comparison;
}

}  // namespace camera_self_calibration
