#include "camera_self_calibration/model_choice/lens_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/queue/agreement.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kMinInterval = 5;  // keyframes between comparisons
constexpr std::int64_t kMaxInterval = 100;
// Share of the image without rays up to which a calibration still is one of the image. Under radtan
// the outermost corners of a strongly distorted lens have none (3 % on one of 100 degrees that it
// fits to 0.1 px elsewhere); on a lens of 125 degrees, which it does not fit, 10 %.
constexpr double kMaxUndescribed = 0.05;
// A richer lens is near its optimum after some ten steps. A third of a sigma that is left to go
// changes the likelihood ratio by 0.1.
constexpr int kMaxIterations = 15;
constexpr double kSettled = 0.3;

double square(double value) { return value * value; }

struct Lens {
  std::string name;
  Camera camera;
};

// Richer lenses, as much like the present one as they can be. Those that cannot describe it over
// the image have nothing to tell.
std::vector<Lens> yardsticksFor(const Camera& present) {
  std::vector<Lens> lenses;
  for (const CameraModel model : {CameraModel::kRadtan, CameraModel::kEquidistant}) {
    if (model == present.model()) {
      Camera with_k3 = present;
      with_k3.setEstimateK3(true);
      if (with_k3.estimatedCount() > present.estimatedCount()) {
        lenses.push_back({"radtan with k3", with_k3});
      }
      continue;
    }
    std::optional<CameraFit> fit = fitCamera(present, model);
    if (!fit || !std::isfinite(fit->error.rms)) continue;
    fit->camera.setEstimateK3(true);
    lenses.push_back({toString(model), fit->camera});
  }
  return lenses;
}

// The queue's segments under one lens. Those that the gate left serve as well as those observed,
// measured on real video: what it removes adds more outliers than evidence.
class Trial {
 public:
  Trial(const std::vector<Candidate>& queue, const Camera& camera) : camera_(camera) {
    for (const Candidate& candidate : queue) segments_.push_back(candidate.segment);
    problem_.camera = &camera_;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      problem_.blocks.push_back(freeBlock(&segments_[i], camera_));
      problem_.blocks.back().sigma_scale = queue[i].sigma_scale;
    }
  }
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;

  bool fit(int threads) {
    SolverOptions options;
    options.max_iterations = kMaxIterations;
    options.step_tolerance = 1e-2;
    options.cost_tolerance = 1e-4;
    options.intrinsics_tolerance = kSettled;
    options.threads = threads;
    return solve(problem_, options).usable && camera_.valid();
  }

  double cost() const {
    double sum = 0.0;
    for (const SegmentBlock& block : problem_.blocks) {
      sum += robustCost(block, camera_, SolverOptions().huber);
    }
    return sum;
  }

  const Problem& problem() const { return problem_; }
  const Camera& camera() const { return camera_; }

 private:
  Camera camera_;
  std::vector<Segment> segments_;
  Problem problem_;
};

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
  if (share <= kMaxUndescribed) return misfit;
  return {
      std::hypot(std::sqrt(1.0 - share) * misfit.rms, std::sqrt(share) * kUnpredictableResidualPx),
      std::max(misfit.max, kUnpredictableResidualPx)};
}

// Of the chi-square distribution: the parameters more where the richer lens contains the present
// one; all of them, to be on the safe side, where it only comes close to it.
int degreesOfFreedom(const Camera& present, const Camera& richer) {
  const bool contained =
      present.model() == CameraModel::kPinhole || present.model() == richer.model();
  return richer.estimatedCount() - (contained ? present.estimatedCount() : 0);
}

struct Comparison {
  double p_value = 1.0;  // of so much better a fit by chance
  PixelError misfit;
  PixelError misfit_observed;
  double undescribed = 0.0;
};

// What richer lenses are held against.
struct Present {
  const QueueSolution& solution;
  const SeenImage& image;
  double cost = 0.0;
};

// How far segments disagree under a lens that was fitted to all of them, to first order.
Scatter scatterOf(const Marginal& marginal) {
  Scatter scatter;
  for (const BlockShare& share : marginal.shares) {
    scatter.chi_square += squaredDistance(share.gradient, share.information);
  }
  const int others = static_cast<int>(marginal.shares.size()) - 1;
  scatter.freedom = others * static_cast<int>(marginal.information.rows());
  return scatter;
}

// Twice the gain in log-likelihood is chi-square distributed if the present model is right: over
// the design effect of errors that are correlated along tracks, and the variance by which segments
// disagree, that of the richer lens as in an F test, since a model that does not fit makes them
// disagree too.
double pValue(double gain, int freedom, const Marginal& richer, const Scatter& scatter) {
  const double ratio = gain / (std::max(1.0, richer.designEffect()) * square(scatter.inflation()));
  const int scatter_freedom = scatter.inflationFreedom();
  return scatter_freedom > 0 ? fExceedance(ratio / freedom, freedom, scatter_freedom)
                             : chiSquareExceedance(ratio, freedom);
}

Comparison compare(const Present& present, double significance, int threads, Trial* richer) {
  Comparison result;
  if (!richer->fit(threads)) return result;
  const Camera& now = present.solution.camera;
  const int freedom = degreesOfFreedom(now, richer->camera());
  const double gain = 2.0 * (present.cost - richer->cost());
  if (!(gain > chiSquareQuantile(freedom, significance))) return result;
  const Marginal marginal = marginalize(richer->problem(), SolverOptions().huber, threads);
  const auto covariance = marginal.robustCovariance();
  if (!covariance) return result;
  const Scatter scatter = scatterOf(marginal);
  const double variance = square(scatter.inflation());
  result.p_value = pValue(gain, freedom, marginal, scatter);
  const auto misfit = [&](const ImageField& field) {
    return beyond(pixelUncertainty(now, present.solution.covariance, field),
                  pixelDistance(now, richer->camera(), field),
                  pixelUncertainty(richer->camera(), variance * *covariance, field));
  };
  result.undescribed = undescribedShare(richer->camera(), now, present.image.seeing);
  result.misfit = withUndescribed(result.undescribed, misfit(present.image.seeing));
  result.misfit_observed = misfit(present.image.observed);
  return result;
}

}  // namespace

bool LensFitReport::describesImage() const { return undescribed <= kMaxUndescribed; }

std::string LensFitReport::sentence() const {
  if (!compared) return "";
  if (better.empty()) return "the lens is described by " + model;
  std::string text = model;
  text += describesImage()
              ? formatted(" is %.1f px rms off, %.1f px at worst", misfit.rms, misfit.max)
              : formatted(" has no ray for %.0f %% of the image", 100.0 * undescribed);
  return text + ": " + better + " describes it";
}

bool LensFit::consider(std::int64_t keyframes, bool verdict_due,
                       const std::vector<Candidate>& queue, const QueueSolution& solution,
                       const SeenImage& image, int threads) {
  if (keyframes < next_ && !(verdict_due && report_.better.empty())) return false;
  std::vector<std::int64_t> sequences;
  for (const Candidate& candidate : queue) sequences.push_back(candidate.segment.sequence);
  if (!solution.usable || sequences == compared_) return false;
  compared_ = std::move(sequences);
  next_ = keyframes + std::clamp(keyframes / 4, kMinInterval, kMaxInterval);
  report_ = LensFitReport();
  report_.compared = true;
  report_.model = toString(solution.camera.model());
  const Present present{solution, image, Trial(queue, solution.camera).cost()};
  double best = options_.significance;
  for (const Lens& lens : yardsticksFor(solution.camera)) {
    Trial richer(queue, lens.camera);
    const Comparison comparison = compare(present, options_.significance, threads, &richer);
    if (!(comparison.p_value <= best)) continue;
    best = comparison.p_value;
    report_.misfit = comparison.misfit;
    report_.misfit_observed = comparison.misfit_observed;
    report_.undescribed = comparison.undescribed;
    report_.better = comparison.misfit.rms > 0.0 ? lens.name : "";
  }
  return true;
}

}  // namespace camera_self_calibration
