#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/queue/line_delay.h"
#include "camera_self_calibration/queue/segment_fit.h"
#include "camera_self_calibration/startup/growth.h"
#include "camera_self_calibration/startup/keyframe_choice.h"

namespace camera_self_calibration {

/// What costs a solve waits until this share more keyframes came: a full batch is solved, k3 tried
/// and the line delay asked for again. The uncertainty can then be by half that share smaller.
constexpr double kWorthASolve = 0.1;

struct StartupOptions {
  GrowthOptions growth;          ///< Its prior is replaced by a vague one about the first guess.
  KeyframeChoiceOptions choice;  ///< What to leave out when there are too many keyframes.
  int max_keyframes = 30;        ///< In the batch.
  double retry_cost = 1.3;       ///< Squared residual scale above which other guesses are tried.
  /// Likelihood ratio (chi-square, 1 degree of freedom) above which radtan's k3 is estimated too.
  double k3_likelihood_ratio = 40.0;
  /// The model of the first guess is only where to begin: the other guesses are of the simplest
  /// models, pinhole and fov, which between them come near enough to any lens to start from.
  bool choose_model = false;
  /// rms uncertainty over the image's longer side, above which an estimate tells nothing of the
  /// lens.
  double useless_uncertainty_share = kUselessUncertaintyShare;
  int threads = 1;  ///< For fits that are compared with each other; result independent.
};

/// The batch solution from no knowledge (section II-C): keyframes chosen for information,
/// landmarks and the intrinsics, grown keyframe by keyframe so that each solve starts near. A full
/// batch leaves out the keyframe that tells least, so that it waits at constant cost for motion
/// that informs, and slow motion adds up. Keyframes that no tracks connect to the newest one are
/// left out, and a batch that ran away begins again from the newest keyframes. Where the result
/// does not fit the tracker's sigma, a small grid of other first guesses is tried from the
/// beginning. A vague prior about the last estimate that told something keeps what is not observed
/// from running away. radtan starts with four distortion coefficients; k3 joins them when the
/// observations demand it.
class Startup {
 public:
  Startup(const StartupOptions& options, const Camera& initial);

  /// `history` holds the newest keyframe and some before it; known ones keep their solution. One
  /// that does not hold the batch's newest keyframe begins a new batch.
  void add(const Segment& history);

  /// Starts again from these intrinsics at the next keyframe.
  void reset(const Camera& initial);

  /// The next batch, in another map, begins with this estimate from elsewhere, and vaguely (five
  /// sigmas) keeps to it, instead of going on from the intrinsics of the last one.
  void beginNextFrom(const Camera& camera, const IntrinsicsMatrix& covariance);
  /// That estimate was wrong.
  void forgetNext() { next_.reset(); }

  /// Goes on with these intrinsics, of another model, and with the poses and depths that belong to
  /// them in `solved`, as far as they are the batch's.
  void switchModel(const Camera& camera, const std::vector<Segment>& solved);

  /// Starts again from a solution, such as that after a change of the lens: the next keyframes are
  /// added to it. What its keyframes from before the change tell of the new lens is only as good as
  /// their own was known, `earlier_covariance` (empty: exactly): that is added to the uncertainty
  /// for as long as the batch holds such keyframes.
  void resume(const Camera& camera, const IntrinsicsMatrix& information, const Segment& solved,
              const IntrinsicsMatrix& earlier_covariance);

  /// The rolling shutter's time between rows, which all pixels are freed of from now on, those of
  /// the batch too; the batch is solved again [s].
  void setLineDelay(double line_delay_s);

  /// What the batch tells of the time between rows, about the one it is freed of. Not usable
  /// before it tells something of the lens.
  LineDelayEstimate lineDelay() const;
  int keyframesAdded() const { return added_; }  ///< In all.

  /// The earlier and the later half of what the solved batch holds of the present lens, which share
  /// no keyframe, without outliers. None where it is not usable.
  std::vector<Segment> halves() const;

  /// A solved batch, without outliers and keyframes of an earlier lens.
  struct Solution {
    Segment segment;
    Camera camera;
    double rms = 0.0;  ///< wholeImageUncertainty() [px]
  };
  /// The most certain solution of a batch that has lost half of that information since, as the
  /// oldest keyframes were left out, or that ended: once. It told the lens.
  std::optional<Solution> takeFinished();

  const Camera& camera() const { return camera_; }
  /// camera(), but with the directions that are not known to the useless uncertainty at their last
  /// trusted values: those of the last estimate that told the lens, or else the first guess.
  Camera heldCamera() const;
  /// Solved; poses and depths of the chosen keyframes.
  const Segment& segment() const { return segment_; }
  bool usable() const { return usable_; }
  /// As segment(), without the tracks that do not fit, with the sigmas that they count with.
  const Segment& solved() const { return gated_; }
  /// Whether solved() is there and long enough to tell models apart.
  bool comparable() const;
  /// Whether it is usable and its uncertainty not useless: before, the motion told nothing.
  bool isInformative() const;
  /// Scaled by the residuals where they exceed the tracker's sigma, and less what is not known of
  /// an earlier lens; n_c x n_c.
  const IntrinsicsMatrix& information() const { return information_; }
  /// Inverse of information(); empty where that is singular.
  const IntrinsicsMatrix& covariance() const { return covariance_; }
  /// Of camera(), over the whole image, what the lens leaves dark too: isInformative() goes by it.
  /// Infinite until it is usable and where the information is singular [px].
  const PixelError& wholeImageUncertainty() const { return whole_image_uncertainty_; }
  /// Robust scale of the residuals against the tracker's own sigma (SegmentFit::residual_scale).
  double residualScale() const { return residual_scale_; }

 private:
  struct FirstGuess {
    Camera camera;
    IntrinsicsPrior prior;
  };
  // Another first guess, and what it costs for each observation.
  struct Guess {
    Camera camera;
    double cost = 0.0;
  };
  // The first keyframes, solved from another guess.
  struct Trial {
    Segment segment;
    std::vector<int> landmark_index;  // in the whole batch
    Camera camera;
    double cost = 0.0;
    bool better = false;  // than the present solution
  };
  // Of the same observations under one of several lenses.
  struct ComparedFit {
    Segment segment;
    Camera camera;
    SegmentFit fit;

    void solve() { fit = fitSegment(comparableFits(), &segment, &camera); }
  };

  void beginBatch(const Segment& history);
  void beginAgain(const Segment& history);
  void extend(const Segment& history);
  void tryOtherGuesses();
  int comparedKeyframes() const;
  // Beginning from two views too takes twice as long where the first keyframes do not fit.
  Trial tryGuess(const Camera& guess, bool two_views) const;
  void adopt(const Trial& trial);
  void adoptSolved(const Segment& solved);
  void goOnWith(const Camera& camera);
  void judge();
  void setInformation(const Marginal& marginal);
  void setInformation(const IntrinsicsMatrix& information);
  void considerK3(Segment* gated);
  bool demandsK3(const ComparedFit& without, const ComparedFit& with) const;
  void noteBest();
  void finishBatch();

  StartupOptions options_;
  Camera initial_;
  Camera camera_;
  std::optional<FirstGuess> next_;
  Camera trusted_;  // of the last keyframe that told the lens; else as initial_
  Segment segment_;
  Segment gated_;                        // as solved last, without outliers
  IntrinsicsMatrix earlier_covariance_;  // of the lens of the segment's earlier keyframes
  IntrinsicsMatrix information_;
  IntrinsicsMatrix covariance_;
  PixelError whole_image_uncertainty_;
  double residual_scale_ = 1.0;
  bool usable_ = false;
  bool told_ = false;           // isInformative() at the last keyframe that could be judged
  bool ran_away_ = false;       // at the last keyframe that could be judged
  int added_ = 0;               // keyframes
  int next_solve_ = 0;          // count of keyframes at which a full batch is solved next
  int next_k3_ = 0;             // and at which k3 is tried again
  int next_retry_ = 0;          // count of keyframes at which other guesses are tried next
  std::size_t next_guess_ = 0;  // of them
  std::optional<Guess> best_guess_;
  std::optional<Solution> best_;      // of this batch
  std::optional<Solution> finished_;  // to be taken
};

/// Standard deviations that say nothing but that it is a camera: the focal length may be anything
/// of the order of the image's longer side, the centre anywhere in its middle, the pixels about
/// square.
IntrinsicsPrior vaguePrior(const Camera& about);

}  // namespace camera_self_calibration
