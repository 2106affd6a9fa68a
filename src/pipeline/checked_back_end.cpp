#include "camera_self_calibration/pipeline/checked_back_end.h"

#include <utility>

namespace camera_self_calibration {
namespace {

// Keyframes in a row that must say that the lens is another one.
constexpr int kContradictions = 2;

}  // namespace

CheckedBackEnd::CheckedBackEnd(const Options& options, const Beginning& beginning)
    : options_(options), main_(options, beginning.camera) {
  if (!beginning.state || !main_.restore(*beginning.state)) return;
  fresh_ = std::make_unique<BackEnd>(options, beginning.camera);
  announced_ = main_.report().state != CalibrationState::kConverged;
}

BackEndOutput CheckedBackEnd::process(const KeyframeMessage& message, bool frozen) {
  if (frozen) {
    BackEndOutput output = main_.hold(message, "; frozen: nothing is learnt");
    output.report.frozen = true;
    return output;
  }
  if (!fresh_) return main_.process(message);
  if (first_stamp_ns_ == 0) first_stamp_ns_ = message.candidate.endNs();
  BackEndOutput output = main_.hold(message, "; restored, being checked against new images");
  if (!announced_) {
    announced_ = true;
    const std::int64_t stamp_ns = output.report.stamp_ns;
    output.events.push_back({EventType::kConverged, stamp_ns, stamp_ns, output.report.sentence});
  }
  // Until the check is over the front end sends the whole history and ends no tracks for not
  // fitting the saved intrinsics.
  if (output.update) output.update->handed_over = false;
  check(message, &output);
  return output;
}

void CheckedBackEnd::check(const KeyframeMessage& message, BackEndOutput* output) {
  BackEndOutput fresh = fresh_->process(message);
  if (!fresh_->startup().usable()) return;
  const CalibrationReport known = main_.report();
  RecheckEvidence evidence;
  evidence.known = known.camera;
  evidence.known_error = known.uncertainty;
  evidence.fresh = fresh.report.camera;
  evidence.fresh_error = fresh.report.uncertainty;
  evidence.threshold_px = options_.convergedRms(known.camera.width());
  const Recheck recheck =
      recheckCalibration(RecheckOptions(), evidence, fresh_->startup().segment());
  contradictions_ = recheck.verdict == RecheckVerdict::kDifferent ? contradictions_ + 1 : 0;
  if (recheck.verdict == RecheckVerdict::kSame) {
    confirm(recheck, output);
  } else if (contradictions_ >= kContradictions) {
    letGo(recheck, std::move(fresh), output);
  }
}

void CheckedBackEnd::confirm(const Recheck& recheck, BackEndOutput* output) {
  const std::int64_t stamp_ns = output->report.stamp_ns;
  BackEndOutput merged = main_.merge(fresh_->candidates());
  fresh_.reset();
  output->report = merged.report;
  output->update = std::move(merged.update);
  for (const Event& event : merged.events) output->events.push_back(event);
  output->events.push_back({EventType::kHandover, stamp_ns, stamp_ns,
                            "the restored calibration is confirmed: " + recheck.sentence});
}

void CheckedBackEnd::letGo(const Recheck& recheck, BackEndOutput fresh, BackEndOutput* output) {
  const CalibrationReport known = main_.report();
  main_ = std::move(*fresh_);
  fresh_.reset();
  main_.continueAfter(known.revision);
  main_.beginEpoch(known.epoch + 1);
  *output = main_.hold(KeyframeMessage(), "");
  output->report.stamp_ns = fresh.report.stamp_ns;
  output->events.push_back({EventType::kCalibrationChange, fresh.report.stamp_ns, first_stamp_ns_,
                            "the restored calibration does not belong to this lens: " +
                                recheck.sentence + "; it is set aside and learning begins anew"});
}

}  // namespace camera_self_calibration
