#include "camera_self_calibration/rig/rig_session.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/rig/rig_audit.h"

namespace camera_self_calibration {
namespace {

// A solution is worth it when there are so many new keyframes, and this share of all. Its cost
// grows with all of them, so that the cost per keyframe is bounded.
constexpr int kMinNewKeyframes = 20;
constexpr int kNewShare = 4;

TimedView viewOf(const FrameResult& result) {
  TimedView timed;
  timed.stamp_ns = result.stamp_ns;
  timed.is_keyframe = result.is_keyframe;
  timed.view.tracks = result.tracks.tracks;
  timed.view.map_id = result.map_id;
  timed.view.image = result.image;
  if (result.state == TrackingState::kTracking) {
    timed.view.world_from_camera = result.world_from_camera;
  }
  return timed;
}

}  // namespace

CalibrationReport withJointIntrinsics(CalibrationReport report, const RigEstimate& estimate,
                                      int camera, double limit_px) {
  const double alone = report.uncertainty.rms;
  report.camera = estimate.rig.cameras[camera];
  report.covariance = estimate.intrinsics_covariance[camera];
  report.uncertainty = estimate.uncertainty[camera];
  report.afresh.reset();
  report.sentence = formatted(
      "Jointly with the other cameras of the rig the calibration is good to %.2g px rms "
      "over the image (alone: %.2g px)",
      report.uncertainty.rms, alone);
  if (report.uncertainty.rms > limit_px) report.state = CalibrationState::kConverging;
  return report;
}

RigEstimate withVerdict(const RigReport& report) {
  RigEstimate estimate = report.estimate;
  if (report.state == CalibrationState::kConverged) return estimate;
  estimate.converged = false;
  estimate.sentence = report.sentence;
  estimate.hint = report.hint;
  return estimate;
}

RigSession::RigSession(const RigOptions& options, int cameras, const FindAcross& across)
    : options_(options),
      across_(across),
      lenses_(static_cast<std::size_t>(cameras)),
      seen_(static_cast<std::size_t>(cameras), false),
      views_(cameras),
      calibrator_(options, cameras, across),
      watch_(options) {}

bool RigSession::lensesKnown() const {
  return std::all_of(lenses_.begin(), lenses_.end(),
                     [](const CalibrationReport& lens) { return lens.handed_over; });
}

void RigSession::restore(const RigEstimate& before) {
  const std::lock_guard<std::mutex> lock(mutex_);
  restored_ = before;
  compared_ = false;
  if (options_.baseline_m) {
    setBaseline(*options_.baseline_m, &*restored_);
  } else if (before.metric && before.places[1].position_known) {
    saved_baseline_m_ = before.rig.rig_from_camera[1].translation.norm();
  }
  report_.estimate = *restored_;
  ++report_.revision;
}

void RigSession::add(int camera, const FrameResult& result) {
  const std::lock_guard<std::mutex> lock(mutex_);
  seen_[camera] = true;
  if (!first_ns_) first_ns_ = result.stamp_ns;
  auto views = views_.add(camera, viewOf(result));
  if (views && lensesKnown()) collect(std::move(*views));
}

void RigSession::collect(std::vector<TimedView> views) {
  RigFrame frame;
  std::vector<bool> calls;
  frame.stamp_ns = views.front().stamp_ns;
  for (TimedView& timed : views) {
    calls.push_back(timed.is_keyframe);
    frame.views.push_back(std::move(timed.view));
  }
  calibrator_.observe(frame);
  if (!keyframes_.add(calls)) return;
  watch_.add(frame);
  calibrator_.add(std::move(frame));
  ++new_keyframes_;
}

// Where the cameras sit stays what was known before. A saved baseline that was not compared with
// the images yet is not believed any more.
void RigSession::beginAnew(const std::string& why) {
  if (restored_) saved_baseline_m_.reset();
  ++report_.epoch;
  new_keyframes_ = 0;
  doubt_.clear();
  certain_ = false;
  report_.estimate.converged = false;
  restored_.reset();
  report_.last_failure.clear();
  report_.anew = asSentence(why + "; calibrating the rig again");
}

void RigSession::update(int camera, const CalibrationReport& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  CalibrationReport& known = lenses_[camera];
  if (known.handed_over && report.epoch != known.epoch) {
    calibrator_ = RigCalibrator(options_, static_cast<int>(lenses_.size()), across_);
    watch_.clear();
    beginAnew(formatted("the lens of %s has changed", nameOf(camera).c_str()));
  }
  known = report;
}

bool RigSession::due() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return new_keyframes_ >= std::max(kMinNewKeyframes, calibrator_.frames() / kNewShare);
}

// Where no rig is known what waits stays, whether there is a solution or not.
bool RigSession::mountsDue() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return known_ ? watch_.due() : watch_.full() && new_keyframes_ >= kMinNewKeyframes;
}

RigReport RigSession::examineMounts() {
  Lock lock(mutex_);
  const std::optional<KnownRig> known = known_;
  if (known) examine(*known, &lock);
  lock.unlock();
  return known ? report() : solve();
}

// Before keyframes are solved together they are asked whether they show one rig; where none is
// known to start from, it is the one that they show together.
RigReport RigSession::solve() {
  Lock lock(mutex_);
  const std::optional<KnownRig> known = known_;
  const bool changed = known && examine(*known, &lock) == MountVerdict::Kind::kChange;
  const std::uint64_t epoch = report_.epoch;
  if (!changed) {
    const RigEstimate estimate = known ? solveJointly(&lock) : solveFirst(&lock);
    if (epoch == report_.epoch) take(estimate);
  }
  lock.unlock();
  return report();
}

// Once more without the segment that is found to be wrong, if there is one.
RigEstimate RigSession::solveFirst(Lock* lock) {
  const std::uint64_t epoch = report_.epoch;
  const RigEstimate estimate = solveJointly(lock);
  if (!estimate.usable || epoch != report_.epoch) return estimate;
  const KnownRig together{estimate.rig, estimate.inverse_depth, estimate.metric};
  const bool wrong = examine(together, lock) == MountVerdict::Kind::kOutlier;
  return wrong ? solveJointly(lock) : estimate;
}

RigEstimate RigSession::solveJointly(Lock* lock) {
  RigCalibrator calibrator = calibrator_;
  std::vector<Camera> cameras;
  for (const CalibrationReport& lens : lenses_) cameras.push_back(lens.camera);
  RigEstimate estimate;
  estimate.sentence = views_.problem();
  new_keyframes_ = 0;
  lock->unlock();
  const auto begin = std::chrono::steady_clock::now();
  if (estimate.sentence.empty()) estimate = calibrator.estimate(std::move(cameras));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  lock->lock();
  if (saved_baseline_m_) setBaseline(saved_baseline_m_, &estimate);
  ++report_.solutions;
  report_.solve_seconds = seconds.count();
  return estimate;
}

// Whether a mount changed. The segments are solved with each camera's own intrinsics: joint ones
// may be from before.
MountVerdict::Kind RigSession::examine(const KnownRig& known, Lock* lock) {
  Rig rig = known.rig;
  for (std::size_t c = 0; c < lenses_.size(); ++c) rig.cameras[c] = lenses_[c].camera;
  const std::uint64_t epoch = report_.epoch;
  const std::deque<RigFrames> waiting = watch_.takeWaiting();
  const RigFrames newest = watch_.newestTells() ? watch_.newest() : RigFrames();
  lock->unlock();
  const auto likelihood = [&](const RigFrames& frames) {
    return MountWatch::likelihood(frames, options_, across_, rig, known.inverse_depth);
  };
  std::vector<RigLikelihood> told;
  for (const RigFrames& frames : waiting) {
    if (auto one = likelihood(frames)) told.push_back(std::move(*one));
  }
  const auto newest_told = newest.empty() ? std::nullopt : likelihood(newest);
  lock->lock();
  if (epoch != report_.epoch || (told.empty() && !newest_told)) return MountVerdict::Kind::kSame;
  for (RigLikelihood& one : told) watch_.learn(std::move(one));
  const MountVerdict verdict = watch_.judge(newest_told, rig);
  conclude(verdict, known);
  return verdict.kind;
}

void RigSession::conclude(const MountVerdict& verdict, const KnownRig& known) {
  using Kind = MountVerdict::Kind;
  doubt_ = verdict.kind == Kind::kDoubt ? doubtText(verdict) : "";
  certain_ = verdict.kind == Kind::kDoubt && verdict.certain;
  if (verdict.kind == Kind::kOutlier) calibrator_.forget(verdict.begin_ns, verdict.end_ns);
  if (verdict.kind != Kind::kChange) return;
  calibrator_.forgetBefore(verdict.begin_ns);
  known_ = {moved(known.rig, verdict.change), known.inverse_depth, known.metric};
  MountChange change = verdict.change;
  beginAnew(textOf(change, known.metric) + forgottenBaseline());
  new_keyframes_ = calibrator_.frames();
  change.epoch = report_.epoch;
  change.sentence = report_.anew;
  remember(change);
}

void RigSession::remember(const MountChange& change) {
  report_.mount_changes.push_back(change);
  if (report_.mount_changes.size() <= RigReport::kMaxMountChanges) return;
  report_.mount_changes.erase(report_.mount_changes.begin());
}

std::string RigSession::nameOf(int camera) const {
  const auto index = static_cast<std::size_t>(camera);
  return "camera " +
         (index < options_.names.size() ? options_.names[index] : formatted("%d", camera));
}

std::string RigSession::doubtText(const MountVerdict& verdict) const {
  std::string text = nameOf(verdict.change.camera) + " may have been moved";
  if (verdict.lens) text += ", or the lens of " + nameOf(*verdict.lens) + " may have changed";
  return text +
         formatted(" (p = %.1e), which the next keyframes will tell", verdict.change.p_value);
}

// Along their baseline the images of two cameras show no shift: a saved length holds only while no
// camera of the rig was moved. One that is given is not doubted. Returns what there is to say of
// it.
std::string RigSession::forgottenBaseline() {
  if (!std::exchange(saved_baseline_m_, std::nullopt)) return "";
  return "; lengths are in metres no longer, give the baseline";
}

// A rotation or shift that may be chance goes unmentioned where the other one is none.
std::string RigSession::amountOf(const MountChange& change, bool metric) const {
  constexpr double kChance = 0.0027;  // beyond 3 sigma
  const bool shifted = change.shiftPValue() < kChance;
  std::string text;
  if (change.rotationPValue() < kChance || !shifted) {
    text += formatted("turned by %.2f +- %.2f degrees", change.angle() / kDegree,
                      change.angleSigma() / kDegree);
    if (shifted) text += " and ";
  }
  if (shifted) {
    text += formatted("moved by %.3f +- %.3f %s", change.shift.norm(), change.shiftSigma(),
                      lengthUnit(metric).c_str());
  }
  return text;
}

std::string RigSession::textOf(const MountChange& change, bool metric) const {
  const std::string others = lenses_.size() == 2 ? nameOf(0) : "the others";
  const double seconds = toSeconds(change.onset_ns - first_ns_.value_or(0));
  return nameOf(change.camera) + " was " + amountOf(change, metric) +
         formatted(" against %s at %.1f s", others.c_str(), seconds);
}

// From the rig as it was saved, whose own sigmas count too.
std::optional<MountChange> RigSession::changeSinceSaved(const RigEstimate& estimate,
                                                        int camera) const {
  AuditOptions options;
  options.tolerance_px = convergedRms(options_.converged_pixel_rms, estimate.rig.cameras[camera]);
  const PlaceMatrix& saved = restored_->places[camera].difference_covariance;
  RigEstimate both = estimate;
  both.places[camera].difference_covariance += saved;
  const PlaceAudit audit = auditPlace(both, restored_->rig, camera, options);
  if (audit.verdict != AuditVerdict::kWrong) return std::nullopt;
  const PlaceMatrix& covariance = both.places[camera].difference_covariance;
  const double unit = estimate.rig.rig_from_camera[1].translation.norm();
  MountChange change;
  change.camera = camera;
  change.onset_ns = first_ns_.value_or(0);
  change.found_ns = estimate.poses.back().stamp_ns;
  change.rotation = audit.difference.head<3>();
  change.rotation_covariance = covariance.topLeftCorner<3, 3>();
  change.shift_known = audit.shift_judged;
  change.shift = unit * audit.difference.tail<3>();
  change.shift_covariance = unit * unit * covariance.bottomRightCorner<3, 3>();
  change.p_value = std::min(audit.turn.p_value, audit.shift.p_value);
  return change;
}

// All keyframes are from after the change: none goes.
void RigSession::compareWithSaved(const RigEstimate& estimate) {
  std::vector<MountChange> changes;
  for (int c = 1; c < estimate.rig.size(); ++c) {
    if (auto change = changeSinceSaved(estimate, c)) changes.push_back(*change);
  }
  compared_ = true;
  if (changes.empty()) return;
  report_.estimate.converged = false;
  const std::string forgotten = forgottenBaseline();
  if (!(options_.false_alarms_per_hour > 0.0)) return;
  // Where all others are elsewhere, it is the first that was moved, or they were one by one.
  const bool first =
      changes.size() > 1 && static_cast<int>(changes.size()) + 1 == estimate.rig.size();
  for (MountChange& change : changes) {
    change.epoch = ++report_.epoch;
    change.sentence =
        asSentence(nameOf(change.camera) + " is not where it was when the rig was saved: it was " +
                   amountOf(change, estimate.metric) +
                   (first ? "; so were all others, or else " + nameOf(0) : "") + forgotten);
    remember(change);
  }
}

void RigSession::take(RigEstimate estimate) {
  if (restored_ && estimate.usable && doubt_.empty()) compareWithSaved(estimate);
  const bool unit_known = options_.baseline_m || saved_baseline_m_;
  if (estimate.metric && !unit_known) setBaseline(std::nullopt, &estimate);
  if (!doubt_.empty() && estimate.converged) {
    estimate.converged = false;
    estimate.sentence = withFullStop(estimate.sentence) + " " + asSentence(doubt_);
  }
  const bool better = estimate.usable && (estimate.converged || !report_.estimate.usable ||
                                          !report_.estimate.converged);
  report_.last_failure = better ? "" : estimate.sentence;
  if (!better) return;
  known_ = {estimate.rig, estimate.inverse_depth, estimate.metric};
  restored_.reset();
  if (estimate.converged) report_.anew.clear();
  report_.estimate = std::move(estimate);
  ++report_.revision;
}

RigReport RigSession::report() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  RigReport report = report_;
  report.cameras = lenses_;
  report.keyframes = calibrator_.frames();
  judge(&report);
  return report;
}

// The first that is missing counts.
void RigSession::judge(RigReport* report) const {
  report->state = CalibrationState::kInitializing;
  for (std::size_t c = 0; c < lenses_.size(); ++c) {
    if (lenses_[c].handed_over) continue;
    const std::string who = nameOf(static_cast<int>(c));
    report->sentence = seen_[c] ? who + " does not know its lens yet: " + lenses_[c].sentence
                                : "no image of " + who + " has come yet";
    report->hint = lenses_[c].hint;
    return;
  }
  report->state = CalibrationState::kConverging;
  report->sentence = views_.problem();
  if (!report->sentence.empty()) return;
  const RigEstimate& estimate = report->estimate;
  const std::string anew = report->anew.empty() ? "" : report->anew + " ";
  if (!estimate.usable) {
    report->sentence =
        anew + (report->last_failure.empty()
                    ? formatted("the cameras know their lenses; %d keyframes of the rig so far",
                                report->keyframes)
                    : report->last_failure);
    report->hint = "turn the rig about all axes, where there is much to see";
    return;
  }
  report->sentence = anew +
                     (!restored_  ? ""
                      : compared_ ? "As it was saved, and the images agree: "
                                  : "As it was saved, not compared with the images yet: ") +
                     estimate.sentence;
  report->hint = estimate.hint;
  if (!report->last_failure.empty()) {
    report->sentence = withFullStop(report->sentence) +
                       " The newest joint solution was not used: " + report->last_failure;
  }
  if (!estimate.converged) return;
  if (certain_) {
    report->sentence = asSentence(doubt_) + " Before: " + report->sentence;
    return;
  }
  for (std::size_t c = 0; c < lenses_.size(); ++c) {
    const CalibrationReport& lens = lenses_[c];
    const double limit = convergedRms(options_.converged_pixel_rms, lens.camera);
    const CalibrationReport joint = withJointIntrinsics(lens, estimate, static_cast<int>(c), limit);
    if (joint.state == CalibrationState::kConverged) continue;
    const bool alone = lens.state != CalibrationState::kConverged;
    report->sentence += " " + asSentence(nameOf(static_cast<int>(c)) + " is not CONVERGED: " +
                                         (alone ? lens.sentence : joint.sentence));
    report->hint = alone
                       ? lens.hint
                       : "turn the rig about all axes, and move what is seen over the whole image";
    return;
  }
  report->state = CalibrationState::kConverged;
}

}  // namespace camera_self_calibration
