#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <string>

namespace camera_self_calibration {

/// Adds to what an entry of /diagnostics says: the highest level counts, and all sentences are kept
/// in their order. (mergeSummary() of diagnostic_updater drops what is OK.) An empty text adds
/// nothing.
void addJudgement(unsigned char level, const std::string& text,
                  diagnostic_updater::DiagnosticStatusWrapper* status);

}  // namespace camera_self_calibration
