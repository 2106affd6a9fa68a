#pragma once

#include <memory>

#include "camera_self_calibration/pipeline/back_end_state.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/pipeline/health.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/results.h"

namespace camera_self_calibration {

/// What the state says of the calibration. CONVERGED at or below `converged_rms` [px].
HealthVerdict verdictOn(const BackEndState& state, double converged_rms, CalibrationState before);

/// For everybody: the sentence mentions the choice of the model, its fit and a drift, too.
/// `converged_rms` [px] as above.
CalibrationReport reportOf(const BackEndState& state, double converged_rms);

/// The estimate in use, for the front end. Until a restored queue is confirmed it has not handed
/// over: the front end sends the whole history and ends no tracks for not fitting it.
CalibrationUpdate updateOf(const BackEndState& state);

/// All that was learnt, for the next run; null until the queue has taken over.
std::shared_ptr<const LearntState> learntStateOf(const BackEndState& state);

}  // namespace camera_self_calibration
