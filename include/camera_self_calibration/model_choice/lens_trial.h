#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/queue/candidate_window.h"
#include "camera_self_calibration/queue/scatter.h"

namespace camera_self_calibration {

/// Probability of so great a lead by chance, below which it counts where there is one segment of
/// video only, which cannot show how far segments disagree.
constexpr double kSignificanceAlone = 1e-4;

/// What lenses are compared on: segments of video that share nothing but the lens.
struct LensObservations {
  std::vector<Segment> segments;     ///< Solved and gated; at least one.
  std::vector<double> sigma_scales;  ///< By which the sigmas of each are multiplied.
  Scatter scatter;                   ///< How far they disagree under the lens in use.
};

/// The queue's segments as they are. Those that the gate left serve as well as those observed,
/// measured on real video: what it removes adds more outliers than evidence.
LensObservations observationsOf(const std::vector<Candidate>& queue, const Scatter& scatter);

/// One lens, with the poses and depths under which it fits the observations best.
struct LensTrial {
  bool usable = false;
  Camera camera;
  std::vector<Segment> segments;
  double cost = 0.0;  ///< Robust [nats of a Gaussian]; infinite where it is not usable.

  /// "pinhole", "fov", "radtan", "radtan with k3", "equidistant".
  std::string name() const;
};

/// All of the observations, as one problem of the lens, with its poses and depths.
Problem problemOf(const LensObservations& observations, std::vector<Segment>* segments,
                  Camera* camera);

/// How far the segments disagree: what they do under a lens that may be richer than the one in use
/// (`own`) counts where it is less, since under a lens that is wrong they disagree for that alone.
Scatter disagreement(const LensObservations& observations, const Scatter& own);

/// Fits lens, poses and depths, starting from `start` and the segments' states.
LensTrial tryLens(const LensObservations& observations, const Camera& start, int threads);

/// How well a fitted lens is known.
struct LensKnowledge {
  /// By how much differences of costs are too large, or, below 1, too small: what the residuals
  /// under this lens make of the sigmas, correlation along tracks (Marginal::designEffect), and the
  /// segments' disagreement.
  ScatterVariance variance;
  IntrinsicsMatrix covariance;  ///< Honest in the same way; empty where it is singular.
};
LensKnowledge knowledgeOf(const LensObservations& observations, const LensTrial& trial,
                          int threads);

/// A lens of a model as much like this one as it can be, as a start. `with_k3`: of radtan. Nothing
/// where the model cannot describe it over the image.
std::optional<Camera> likewise(const Camera& camera, CameraModel model, bool with_k3);

/// Probability that the lead of `ahead` is chance, and the lens that is behind is right: twice the
/// lead in log-likelihood over the variance of `known`, which is of `ahead`, is chi-square
/// distributed then, or, as the disagreement is estimated, follows an F test. Its degrees of
/// freedom are the parameters that `ahead` has more where it contains the other, all of its
/// parameters, to be on the safe side, where it only comes close to it. 1 where it is not ahead.
double leadByChance(const LensTrial& ahead, const LensTrial& behind, const LensKnowledge& known);

/// The share of the difference between the two lenses that counts, where differences are taken for
/// normal with a variance that the observations tell (empirical Bayes: James & Stein 1961, Efron &
/// Morris 1973): 1 - 1 / F, with the likelihood ratio F per degree of freedom in units of what
/// chance makes of it; 0 where that is less than 1.
double shareBeyondChance(const LensTrial& ahead, const LensTrial& behind,
                         const LensKnowledge& known);

/// Count of keyframes at which to compare again: when there are a quarter more, at least 5 and at
/// most 100, so that the effort per keyframe stays bounded.
std::int64_t nextComparison(std::int64_t keyframes);

/// The lens in use beside richer ones, radtan with k3 and equidistant.
struct LensComparison {
  LensObservations observations;
  LensTrial present;
  std::vector<LensTrial> richer;  ///< Those that were worth a fit.
};

/// Each richer lens starts from the present one. What one that contains it can gain is judged to
/// first order, from one linearisation; it is fitted only if it may be ahead by more than chance.
LensComparison compareWithRicher(LensObservations observations, const Camera& present, int threads);

}  // namespace camera_self_calibration
