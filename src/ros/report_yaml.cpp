#include "camera_self_calibration/ros/report_yaml.h"

#include <yaml-cpp/yaml.h>

#include <vector>

#include "camera_self_calibration/ros/messages.h"
#include "camera_self_calibration/ros/stamps.h"

namespace camera_self_calibration {
namespace {

constexpr int kDigits = 17;
const std::string kFirstLine = "# Report of camera_self_calibration\n";

void emitCamera(const CalibrationReport& report, YAML::Emitter* out) {
  const Intrinsics& p = report.camera.parameters();
  *out << YAML::Key << "model" << YAML::Value << toString(report.camera.model());
  *out << YAML::Key << "width" << YAML::Value << report.camera.width();
  *out << YAML::Key << "height" << YAML::Value << report.camera.height();
  *out << YAML::Key << "parameter_names" << YAML::Value << YAML::Flow
       << report.camera.parameterNames();
  *out << YAML::Key << "params" << YAML::Value << YAML::Flow
       << std::vector<double>(p.data(), p.data() + p.size());
  *out << YAML::Key << "sigma" << YAML::Value << YAML::Flow << parameterSigmas(report);
  const IntrinsicsMatrix& covariance = report.covariance;
  *out << YAML::Key << "covariance" << YAML::Value << YAML::Flow
       << std::vector<double>(covariance.data(), covariance.data() + covariance.size());
}

void emitLensFit(const LensFitReport& fit, YAML::Emitter* out) {
  *out << YAML::Key << "lens_fit" << YAML::Value << fit.sentence();
  *out << YAML::Key << "better_model" << YAML::Value << fit.better;
  *out << YAML::Key << "misfit_rms_px" << YAML::Value << fit.misfit.rms;
  *out << YAML::Key << "misfit_max_px" << YAML::Value << fit.misfit.max;
}

void emitQueue(const QueueReport& queue, YAML::Emitter* out) {
  *out << YAML::Key << "queue" << YAML::Value << YAML::BeginMap;
  *out << YAML::Key << "swaps" << YAML::Value << queue.swaps;
  *out << YAML::Key << "last_decision" << YAML::Value << queue.last_decision;
  *out << YAML::Key << "segments" << YAML::Value << YAML::BeginSeq;
  for (const SegmentReport& segment : queue.segments) {
    *out << YAML::Flow << YAML::BeginMap;
    *out << YAML::Key << "sequence" << YAML::Value << segment.sequence;
    *out << YAML::Key << "begin_s" << YAML::Value << toSeconds(segment.begin_ns);
    *out << YAML::Key << "end_s" << YAML::Value << toSeconds(segment.end_ns);
    *out << YAML::Key << "entropy_nats" << YAML::Value << segment.entropy;
    *out << YAML::Key << "keyframes" << YAML::Value << segment.keyframes;
    *out << YAML::Key << "landmarks" << YAML::Value << segment.landmarks;
    *out << YAML::Key << "observations" << YAML::Value << segment.observations;
    *out << YAML::EndMap;
  }
  *out << YAML::EndSeq << YAML::EndMap;
}

}  // namespace

std::string toYaml(const CalibrationReport& report, std::int64_t dropped_images) {
  YAML::Emitter out;
  out.SetDoublePrecision(kDigits);
  out << YAML::BeginMap;
  out << YAML::Key << "stamp_s" << YAML::Value << toSeconds(report.stamp_ns);
  out << YAML::Key << "state" << YAML::Value << toString(report.state);
  out << YAML::Key << "sentence" << YAML::Value << report.sentence;
  out << YAML::Key << "hint" << YAML::Value << report.hint;
  emitCamera(report, &out);
  out << YAML::Key << "pixel_uncertainty_rms_px" << YAML::Value << report.uncertainty.rms;
  out << YAML::Key << "pixel_uncertainty_max_px" << YAML::Value << report.uncertainty.max;
  out << YAML::Key << "pixel_uncertainty_observed_rms_px" << YAML::Value
      << report.observed.uncertainty.rms;
  out << YAML::Key << "observed_share" << YAML::Value << report.observed.share;
  out << YAML::Key << "unseen_corners" << YAML::Value << report.observed.unseen_corners;
  if (report.cross_validation.compared) {
    const CrossValidation& halves = report.cross_validation;
    out << YAML::Key << "cross_difference_px" << YAML::Value << halves.difference_px;
    out << YAML::Key << "cross_expected_px" << YAML::Value << halves.expected_px;
    out << YAML::Key << "cross_p_value" << YAML::Value << halves.p_value;
  }
  if (report.lens_fit.compared) emitLensFit(report.lens_fit, &out);
  out << YAML::Key << "entropy_nats" << YAML::Value << report.entropy;
  out << YAML::Key << "rolling_shutter" << YAML::Value << report.shutter.rolls;
  out << YAML::Key << "readout_time_s" << YAML::Value << report.shutter.readout_s;
  out << YAML::Key << "readout_time_sigma_s" << YAML::Value << report.shutter.sigma_s;
  out << YAML::Key << "revision" << YAML::Value << report.revision;
  out << YAML::Key << "epoch" << YAML::Value << report.epoch;
  out << YAML::Key << "handed_over" << YAML::Value << report.handed_over;
  out << YAML::Key << "frozen" << YAML::Value << report.frozen;
  out << YAML::Key << "keyframes" << YAML::Value << report.keyframes;
  out << YAML::Key << "dropped_images" << YAML::Value << dropped_images;
  emitQueue(report.queue, &out);
  out << YAML::EndMap << YAML::Newline;
  return kFirstLine + out.c_str();
}

bool isReportYaml(const std::string& text) {
  return text.compare(0, kFirstLine.size(), kFirstLine) == 0;
}

}  // namespace camera_self_calibration
