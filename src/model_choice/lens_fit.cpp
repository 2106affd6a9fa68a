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

// [px rms] As printed.
constexpr double kWorthAWord = 0.05;
// Where this stands beside the uncertainty, nobody is to add them.
constexpr const char* kCounted = " (which the uncertainty includes)";

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

// The lens is so great a share of the way from the present one to the better one, give or take the
// same share of what is less certain of that one (posterior mean and variance): this is what the
// expected square error of the present one has beyond the stated uncertainty.
PixelError beyond(const PixelError& stated, const PixelError& distance, const PixelError& better,
                  double share) {
  const auto left = [share](double all, double part, double known) {
    return std::sqrt(
        std::max(0.0, share * share * all * all + share * (part * part - known * known)));
  };
  return {left(distance.rms, better.rms, stated.rms), left(distance.max, better.max, stated.max)};
}

PixelError withUndescribed(double share, const PixelError& misfit) {
  if (share <= kNegligibleRim) return misfit;
  return {
      std::hypot(std::sqrt(1.0 - share) * misfit.rms, std::sqrt(share) * kUnpredictableResidualPx),
      std::max(misfit.max, kUnpredictableResidualPx)};
}

// What a richer lens says of the present one.
LensFitReport misfitBeside(const KnownCamera& present, const KnownCamera& richer, double share,
                           const SeenImage& image) {
  const auto misfit = [&](const ImageField& field) {
    return beyond(pixelUncertainty(present.camera, present.covariance, field),
                  pixelDistance(present.camera, richer.camera, field),
                  pixelUncertainty(richer.camera, richer.covariance, field), share);
  };
  LensFitReport report;
  report.undescribed = share * undescribedShare(richer.camera, present.camera, image.seeing);
  report.misfit = withUndescribed(report.undescribed, misfit(image.seeing));
  report.misfit_observed = misfit(image.observed);
  return report;
}

// What a lens beyond all models says of the present one.
LensFitReport misfitBeside(const KnownCamera& present, const FreeDisplacement& free,
                           const SeenImage& image) {
  const auto misfit = [&](const ImageField& field) {
    return beyond(pixelUncertainty(present.camera, present.covariance, field), free.distance(field),
                  free.uncertainty(field), 1.0);
  };
  LensFitReport report;
  report.misfit = misfit(image.seeing);
  report.misfit_observed = misfit(image.observed);
  return report;
}

}  // namespace

bool LensFitReport::describesImage() const { return undescribed <= kNegligibleRim; }

std::string LensFitReport::sentence() const {
  if (!compared) return "";
  if (!refuted && misfit.rms < kWorthAWord) return "no richer lens model fits better than " + model;
  if (!refuted) {
    return "the video does not rule out that " + model +
           formatted(" misses the lens by %.1f px rms", misfit.rms) + kCounted;
  }
  std::string text = model;
  if (misfit.rms < kWorthAWord) {
    text += " does not fit the lens";  // its uncertainty is so large that the misfit adds nothing
  } else if (describesImage()) {
    text += formatted(" misses the lens by %.1f px rms, %.1f px at worst", misfit.rms, misfit.max) +
            kCounted;
  } else {
    text += formatted(" has no ray for %.0f %% of the image", 100.0 * undescribed) + kCounted;
  }
  return text + (better.empty() ? ", and no other model was found to fit"
                                : ", but " + better + " fits it");
}

double LensFit::holdAgainstRicher(const LensComparison& comparison, const KnownCamera& present,
                                  const SeenImage& image, double significance, int threads) {
  report_ = LensFitReport();
  double least = 1.0;
  for (const LensTrial& richer : comparison.richer) {
    const LensKnowledge known = knowledgeOf(comparison.observations, richer, threads);
    const double p_value = leadByChance(richer, comparison.present, known);
    if (known.covariance.size() == 0 || !(p_value < least)) continue;
    least = p_value;
    report_ = misfitBeside(present, {richer.camera, known.covariance},
                           shareBeyondChance(richer, comparison.present, known), image);
    if (p_value <= significance) report_.better = richer.name();
  }
  report_.compared = true;
  report_.model = toString(present.camera.model());
  return least;
}

LensComparison LensFit::compareStart(const Segment& batch, const KnownCamera& present,
                                     const ImageField& seeing, int threads) {
  LensComparison comparison = compareWithRicher({{batch}, {1.0}, {}}, present.camera, threads);
  const double least =
      holdAgainstRicher(comparison, present, {seeing, seeing}, kSignificanceAlone, threads);
  starts_refuted_ = least <= kSignificanceAlone ? starts_refuted_ + 1 : 0;
  report_.refuted = starts_refuted_ >= kStartsInARow;
  if (!report_.refuted) report_ = LensFitReport();
  return comparison;
}

std::optional<LensComparison> LensFit::consider(std::int64_t keyframes, bool verdict_due,
                                                const std::vector<Candidate>& queue,
                                                const QueueSolution& solution,
                                                const SeenImage& image, int threads) {
  if (keyframes < next_ && !verdict_due) return std::nullopt;
  std::vector<std::int64_t> sequences;
  sequences.reserve(queue.size());
  for (const Candidate& candidate : queue) sequences.push_back(candidate.segment.sequence);
  if (!solution.usable || sequences == compared_) return std::nullopt;
  compared_ = std::move(sequences);
  next_ = nextComparison(keyframes);
  const KnownCamera present{solution.camera, solution.covariance};
  LensComparison comparison =
      compareWithRicher(observationsOf(queue, solution.scatter), present.camera, threads);
  double least = holdAgainstRicher(comparison, present, image, options_.significance, threads);
  // Two accounts of what lies beyond the model: to be on the safe side, the larger counts.
  if (least > options_.significance) {
    const FreeDisplacement free =
        freeDisplacement(comparison.observations, comparison.present, threads);
    const LensFitReport beyond_models =
        free.p_value < 1.0 ? misfitBeside(present, free, image) : LensFitReport();
    if (report_.misfit.rms < beyond_models.misfit.rms) {
      report_.misfit = beyond_models.misfit;
      report_.misfit_observed = beyond_models.misfit_observed;
      report_.undescribed = beyond_models.undescribed;
    }
    least = std::min(least, free.p_value);
  }
  report_.refuted = least <= options_.significance && report_.misfit.rms > 0.0;
  if (!report_.refuted) report_.better.clear();
  return comparison;
}

}  // namespace camera_self_calibration
