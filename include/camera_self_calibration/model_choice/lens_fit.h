#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_field.h"
#include "camera_self_calibration/model_choice/lens_trial.h"
#include "camera_self_calibration/model_choice/model_report.h"
#include "camera_self_calibration/queue/queue_solution.h"

namespace camera_self_calibration {

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
