#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_field.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/model_choice/lens_trial.h"
#include "camera_self_calibration/queue/queue_solution.h"

namespace camera_self_calibration {

/// Share of the image without rays up to which a calibration still is one of the image. Under
/// radtan the outermost corners of a strongly distorted lens have none (3 % on one of 100 degrees
/// that it fits to 0.1 px elsewhere); on a lens of 125 degrees, which it does not fit, 10 %.
constexpr double kNegligibleRim = 0.05;

/// Whether the model in use describes the lens, by the newest comparison with richer ones.
struct LensFitReport {
  bool compared = false;  ///< Else nothing is known yet.
  std::string model;      ///< The one in use.
  bool refuted = false;   ///< `model` misses the lens, beyond chance.
  std::string better;     ///< Describes the lens where `model` misses it; empty: none does better.
  /// What the lens that does best adds to the expected error of the lens in use, whether it refutes
  /// that one or not, a rotation of the camera removed, over the image [px]: s^2 distance^2 between
  /// the two + s (uncertainty^2 of the other one - uncertainty^2 of the lens in use), with the
  /// share s of their difference that is beyond chance (shareBeyondChance). Pixels without a ray,
  /// unless they are a negligible rim, count like observations that cannot be predicted
  /// (kUnpredictableResidualPx).
  PixelError misfit;
  PixelError misfit_observed;  ///< The same over the part of the image that features covered.
  /// Share of the image that has rays under the other model and none under the one in use, times s.
  double undescribed = 0.0;

  /// Whether `model` has rays for the image but for a negligible rim.
  bool describesImage() const;
  /// In words; empty before the first comparison.
  std::string sentence() const;
};

/// The parts of the image that matter.
struct SeenImage {
  ImageField seeing;    ///< All that is not dark.
  ImageField observed;  ///< Where features were (observedArea).
};

struct LensFitOptions {
  /// Probability of calling a model wrong that is right, in one comparison. A run makes some ten,
  /// of much the same segments: fewer than one true model in a hundred is ever called wrong.
  double significance = 1e-3;
};

/// A lens in use.
struct KnownCamera {
  Camera camera;
  IntrinsicsMatrix covariance;  ///< n_c x n_c; empty where nothing is known.
};

/// Holds the model in use against richer lenses (compareWithRicher) on the queue's segments; and
/// where none of them refutes it, against a lens that no model describes (freeDisplacement).
/// Compares at geometric intervals of keyframes (at most 100), and only when the queue has changed,
/// so that the effort per keyframe stays bounded.
class LensFit {
 public:
  explicit LensFit(const LensFitOptions& options) : options_(options) {}

  /// Compares if it is time to, or if `verdict_due` (the calibration is about to be called good).
  /// `solution` is that of `queue` as it is. The comparison, if there was one.
  std::optional<LensComparison> consider(std::int64_t keyframes, bool verdict_due,
                                         const std::vector<Candidate>& queue,
                                         const QueueSolution& solution, const SeenImage& image,
                                         int threads);

  /// Compares on the startup batch, while there is no queue to do so on, at kSignificanceAlone; the
  /// caller spaces it. A batch in a wrong minimum looks like a wrong model until it has grown out
  /// of it: only what kStartsInARow comparisons find, each of a longer batch, is reported.
  LensComparison compareStart(const Segment& batch, const KnownCamera& present,
                              const ImageField& seeing, int threads);

  const LensFitReport& report() const { return report_; }

 private:
  // Fills the report with the richer lens that refutes the present one most clearly, if its lead is
  // no chance at this level. That probability, 1 where none is ahead.
  double holdAgainstRicher(const LensComparison& comparison, const KnownCamera& present,
                           const SeenImage& image, double significance, int threads);

  static constexpr int kStartsInARow = 3;

  LensFitOptions options_;
  LensFitReport report_;
  std::vector<std::int64_t> compared_;  // sequences of the segments of the newest comparison
  std::int64_t next_ = 0;               // count of keyframes at which to compare
  int starts_refuted_ = 0;              // comparisons of the startup batch in a row
};

}  // namespace camera_self_calibration
