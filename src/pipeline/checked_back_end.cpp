#include "camera_self_calibration/pipeline/checked_back_end.h"

#include <utility>

namespace camera_self_calibration {
namespace {

// Keyframes in a row that must say that the lens is another one.
constexpr int kContradictions = 2;

// What the new images show best, after hand-over. The startup batch grows no more then.
const Segment& mostSeen(const BackEndState& fresh) {
  const Segment* most = &fresh.startup.segment();
  for (const Candidate& candidate : fresh.queue.candidates()) {
    if (candidate.segment.keyframes.size() > most->keyframes.size()) most = &candidate.segment;
  }
  return *most;
}

}  // namespace

CheckedBackEnd::CheckedBackEnd(const Options& options, const Beginning& beginning,
                               const Counters& counters)
    : options_(options), main_(options, beginning.camera, counters) {
  if (!beginning.state || !main_.restore(*beginning.state)) return;
  // If it turns out to be another lens, what is learnt from now on is the next epoch. Revision
  // `known + 1` is the restored estimate's.
  const Counters& known = main_.state().counters;
  const Counters next{known.revision + 1, known.epoch + 1};
  fresh_ = std::make_unique<BackEnd>(options, beginning.camera, next);
}

void CheckedBackEnd::beginAgain(const Beginning& beginning) {
  *this = CheckedBackEnd(options_, beginning, {main_.state().counters.revision, 0});
}

BackEndOutput CheckedBackEnd::process(const KeyframeMessage& message, bool frozen) {
  if (frozen) {
    BackEndOutput output = main_.hold(message, "; frozen: the calibration is not updated");
    output.report.frozen = true;
    return output;
  }
  if (!fresh_) return main_.process(message);
  if (first_stamp_ns_ == 0) first_stamp_ns_ = message.candidate.endNs();
  BackEndOutput output = main_.hold(message, "; restored, and being checked against new images");
  check(message, &output);
  return output;
}

void CheckedBackEnd::check(const KeyframeMessage& message, BackEndOutput* output) {
  BackEndOutput fresh = fresh_->process(message);
  const BackEndState& state = fresh_->state();
  if (!state.startup.usable()) return;
  RecheckEvidence evidence;
  evidence.known = main_.state().known.camera;
  evidence.known_error = main_.state().uncertainty();
  evidence.fresh = state.known.camera;
  evidence.fresh_error = state.uncertainty();
  evidence.field = state.field;
  evidence.threshold_px = options_.convergedRms(main_.state().known.camera);
  RecheckOptions recheck_options;
  const Segment* segment = &state.startup.segment();
  if (!isStarting(state.phase)) {  // on a queue, which asks for no more of its segments
    recheck_options.min_keyframes = CandidateOptions().min_keyframes;
    segment = &mostSeen(state);
  }
  const Recheck recheck = recheckCalibration(recheck_options, evidence, *segment);
  contradictions_ = recheck.verdict == RecheckVerdict::kDifferent ? contradictions_ + 1 : 0;
  if (recheck.verdict == RecheckVerdict::kSame) {
    confirm(recheck, output);
  } else if (contradictions_ >= kContradictions) {
    discardRestored(recheck, std::move(fresh), output);
  }
}

void CheckedBackEnd::confirm(const Recheck& recheck, BackEndOutput* output) {
  const std::int64_t stamp_ns = output->report.stamp_ns;
  BackEndOutput confirmed = main_.confirm(fresh_->state().queue.candidates());
  fresh_.reset();
  output->report = confirmed.report;
  output->update = std::move(confirmed.update);
  for (const Event& event : confirmed.events) output->events.push_back(event);
  Event event{EventType::kHandover, stamp_ns, stamp_ns,
              "the restored calibration is confirmed: " + recheck.sentence};
  event.epoch = output->report.epoch;
  output->events.push_back(event);
}

void CheckedBackEnd::discardRestored(const Recheck& recheck, BackEndOutput fresh,
                                     BackEndOutput* output) {
  main_ = std::move(*fresh_);
  fresh_.reset();
  if (!fresh.update) fresh.update = updateOf(main_.state());  // the front end has the discarded one
  *output = std::move(fresh);
  Event event{EventType::kCalibrationChange, output->report.stamp_ns, first_stamp_ns_,
              "the restored calibration does not belong to this lens: " + recheck.sentence +
                  "; it is set aside, and calibration starts again"};
  event.epoch = output->report.epoch;
  event.magnitude_px = recheck.distance_px;
  output->events.insert(output->events.begin(), event);
}

}  // namespace camera_self_calibration
